"""Continuation of the edge along its path, step by step, whatever drives it.

A step goes a way ``h`` in the plane of ``p/T`` and ``a/L``, predicted by the polynomial through the rows
since the last kink. Then either the radius is what was predicted, and the load parameter is the root of the
edge condition, which needs one geometry; or, where the edge hardly moves, the other way about; or the edge
rests. At a limit point of the load the radius is fixed, and nothing special happens.

``T`` is half the time since the leg began: a leg may last 1e8 times as long as what happens first in it.
``L`` is half the way since the edge turned. Both start anew at a turn of the edge.

A step ends at an event, seen ahead on the predictor:

- the end of the leg;
- a turn of the edge; the start of one that has rested;
- a fold: the load parameter has a maximum over the radius. It is approached from this side and landed on
  when its place no longer changes; there the contact jumps to another radius, or is lost;
- the smallest contact that is followed, or the rim of the indenter;
- a corner of the path: the edge, or the end of its zone, comes to what was never in contact. No step is
  predicted across it: the rows begin anew.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.equilibrium import (
    pressed_depth,
    pressed_force,
    pressed_radius,
    start_state,
    touching_radius,
)
from validation.reference.path.numerics import DEGREE, NEGLIGIBLE, ROUNDING, bracketed
from validation.reference.path.path import Leg, Predictor, Rows
from validation.reference.path.rheology import IndentedBody
from validation.reference.path.state import State, faded
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]
Level = Callable[[float, float, float], float]
"""How far penetration, force and radius are beyond a level."""

FIRST_STEP = 1e-3
"""First step of a leg, in parts of the shortest time and of the zone."""
STILL = 1e-6
"""Travel of the edge, in zones, below which it is at rest."""
FIRST_RADIUS = 1e-2
"""Least radius of the first step of a new contact, in the scale of the radius."""
SMALL_PART = 0.1
"""Scales of radius and penetration, in the largest of the run."""
SOLVED = 100.0
"""Rounding of what is solved for an image, in units of the last place and the ratio of image and surface."""
REJECTED = 2.5
"""Error, in tolerances, above which a step is repeated."""
LEAST_WEIGHT = 0.3
"""Of what a short step is mispredicted by: it stays in the fields over its way, but the force shows it."""
LEAST_SHARE = 0.1
"""Of what all steps over one scale may add up to: shorter steps are those after a kink, and few."""
RUNG = 2.0**0.25
"""Ratio of neighbouring changes of the step; the lower one is taken, so that rounding chooses none."""
LARGEST_GROWTH = 4
"""Of successive steps, in rungs: beyond, the rows with the least order and not the most would predict."""
LEAST_CUT = -2
"""Of a step that is repeated, in rungs."""
UNSEEN = -8
"""Next step, in rungs, after one that no correction was found for."""
SMALLEST_STEP = 1e-10
"""Below it the edge condition has no root to be found here: see what became of the contact."""
NARROW = 1e-4
"""Change of a root by a secant, relative to it and in tolerances, with which it is found."""
SECANTS = 12
"""Most secants: they converge in four, or do not."""
SEEN = 1e-5
"""Least difference of two radii, in zones, that tells a slope beside the rounding of the residual."""
UNFORESEEN = 1e-2
"""Longest first step after a kink, whichever way the path then goes."""
MOVING = 3e-3
"""Share of the radius in the direction of the path from which on a step ends at a radius."""
AFTER_TURN = 0.1
"""First step after a turn, in the step before: nothing else tells whether it is short enough."""
TOWARDS = 0.75
"""Share of the way to an event that a step goes at most if it does not end there."""
SAME_FOLD = 0.1
"""Change of the place of a fold foreseen, in tolerances, below which it is landed on."""
FILLED = 1.0 - 1e-5
"""Zone of fixed stress, in the contact radius, at which the contact ends."""
LARGEST_JUMP = 1e4
"""Radius up to which a stable contact is looked for, in that at which one runs away."""


class Ending(StrEnum):
    """What a step came to."""

    NONE = ""
    REJECTED = "rejected"
    END = "end of the leg"
    LEVEL = "level"
    TURN = "turn"
    DEPARTURE = "departure"
    FOLD = "fold"
    LEAST = "smallest radius"
    RIM = "rim"
    CORNER = "corner"
    LOST = "lost"


SIGHTS = {
    Ending.END: (0, 0, 1.0),
    Ending.LEAST: (0, 1, -1.0),
    Ending.RIM: (0, 1, 1.0),
    Ending.CORNER: (0, 1, 0.0),
    Ending.TURN: (1, 1, 0.0),
    Ending.FOLD: (1, 0, -1.0),
}
"""Events as functions of the path ahead: derivative, component, and the way it passes a level."""


class Fixed(StrEnum):
    """What a step ends at."""

    RADIUS = "radius"
    LOAD = "load"
    REST = "rest"


@dataclass
class Plan:
    """Where a step is to go: ``z = (p/T, a/L, F, (D, C)/depth)`` after a way ``h``, and its slopes there.

    ``p`` and ``a`` are those since the step began.
    """

    h: float
    z: Array
    tangent: Array
    fixed: Fixed
    event: Ending = Ending.NONE


@dataclass(frozen=True)
class Correction:
    """A step that satisfies the edge condition, and its arclength."""

    arrival: Arrival
    s: float


@dataclass
class Continuation:
    """A run in progress.

    ``T``, ``L``, ``depth``: scales of load parameter, radius and penetration; ``L_run`` the largest of the
    radius. ``lasted``, ``travelled``: since the leg began and the edge set off. ``slopes``: of the residual
    over the load parameter and the radius, as last seen; they save evaluations.
    """

    body: IndentedBody
    law: EdgeLaw
    state: State
    tolerance: float
    L_run: float
    depth: float
    accepted: Callable[[Arrival, State, float], None] = lambda *_: None
    leg: Leg = None  # type: ignore[assignment]
    rows: Rows = None  # type: ignore[assignment]
    T: float = 1.0
    L: float = 1.0
    lasted: float = 0.0
    travelled: float = 0.0
    T_leg: float = 1.0
    T_first: float = 1.0
    h: float = 1.0
    tangent: Array = field(default_factory=lambda: np.array([1.0, 0.0]))
    slopes: dict[Fixed, float] = field(default_factory=dict)
    fails: int = 0
    tried: tuple[float, float] = (math.nan, math.nan)
    evaluations: int = 0
    geometries: int = 0
    steps: int = 0
    rejected: int = 0
    moving: bool = False
    direction: float = -1.0
    vertex: float = math.nan
    stuck_at: int = -1
    level: Level | None = None
    largest_force: float = 0.0
    borne: float = 0.0

    @property
    def noise(self) -> float:
        """Residual below which there is only rounding.

        Where a load is given, that of the largest borne. The image of a thin layer is that many times its
        surface, and as many times what is solved for it rounds.
        """
        force, noise = abs(self.state.force), 10.0 * ROUNDING
        if self.law.adhesion is None and self.leg.free and force > 0.0:
            noise = max(noise, math.ulp(1.0) * self.borne / force)
        if self.body.image.is_layer and self.state.radius > 0.0:
            image, surface = np.abs(self.state.depths[1:]).max(), self.body.shape(self.state.radius)
            surface += abs(self.state.depth)
            edge = self.law.strain(self.state.radius, self.body.rheology.glassy) or surface
            noise = max(noise, SOLVED * math.ulp(1.0) * image**2 / (surface * edge))
        return noise

    @property
    def least_scale(self) -> float:
        """Scale of the radius where the edge sets off."""
        return self.law.zone or 1e-2 * self.L_run

    @property
    def still(self) -> float:
        """Travel that changes nothing an edge can see."""
        return STILL * self.least_scale

    def trial(self, travel: float, s: float, order: int = DEGREE) -> Trial:
        """The step that goes that far."""
        self.geometries += 1
        segment = self.rows.segment(s, travel, order)
        return Trial(self.body, self.law, self.state, self.leg, segment)

    def arrive(self, trial: Trial, rise: float) -> Arrival:
        """The end of a trial after a rise of the load parameter."""
        self.evaluations += 1
        return trial.arrive(rise)

    def begin(self, leg: Leg, T_leg: float) -> None:
        """A new leg: a kink of the path."""
        self.leg, self.T_leg, self.T = leg, T_leg, T_leg
        self.L, self.lasted = min(self.L_run, self.least_scale), 0.0
        self.state = replace(self.state, parameter=leg.start)
        state = self.state
        self.rows = Rows.at(state.force, state.depths)
        if state.radius == 0.0 and state.depth >= 0.0 and leg.presses:
            self._touch()
            return
        self._restart(np.array([1.0, 0.0]))
        self.moving = False
        if leg.timed:
            self.T_first = self.T = T_leg * self.h
            self.h = 1.0

    def _touch(self) -> None:
        """The first step of a new contact, as if it were elastic: to a small part of the largest penetration.

        Until the shortest relaxation time only the load changes with time. A plane tip is in contact as a
        whole.
        """
        if self.law.tip:
            begun = start_state(self.body, self.state.depth, self.law.tip, True)
            self.state = replace(begun, parameter=self.state.parameter, time=self.state.time)
            self._restart()
            return
        leg, deepest = self.leg, NEGLIGIBLE * self.depth / SMALL_PART
        a = min(max(touching_radius(self.body, deepest, self.law.rim), FIRST_RADIUS * self.L_run), self.L_run)
        load = pressed_depth(self.body, a)
        if leg.control == "force":
            load = 2.0 * self.body.rheology.glassy * pressed_force(self.body, a)
        whole, start = leg.end - leg.start, leg.value(leg.start)
        change = leg.value(leg.end) - start
        p = whole * min(load / (abs(change) or load), 1.0)
        if change > load:
            p = bracketed(lambda at: leg.value(leg.start + at) - start - load, 0.0, whole)
        elastic = min(self.T_leg, self.body.rheology.shortest)
        self.T_first, self.L = max(2.0 * p, elastic, 1e-300) if leg.timed else SMALL_PART, a
        self.T, self.lasted = self.T_first, 0.0
        way = np.array([p / self.T, a / self.L])
        self._restart(way / np.hypot(*way), float(np.hypot(*way)))
        self.moving = True

    def _restart(self, tangent: Array | None = None, h: float | None = None) -> None:
        """A kink at the last row."""
        self.rows.restart()
        self.slopes = {}
        self.moving, self.vertex = tangent is not None and self.moving, math.nan
        self.tangent = np.array([1.0, 0.0]) if tangent is None else tangent
        zone = self.law.zone
        if h is None:
            quick = min(1.0, self.body.rheology.shortest / self.T) if self.leg.timed else 1.0
            h = FIRST_STEP * min(1.0, quick, zone / self.L if zone else 1.0)
        self.h, self.travelled = h, 0.0
        self.state = faded(self.state, self.body, zone, self.tolerance)

    def _rescale(self) -> None:
        """Scales grow with the time since the leg began and the way since the edge turned.

        Segments keep their polynomials; only chords change.
        """
        T, L = self.T, self.L_run
        if self.leg.timed:
            T = min(self.T_leg, max(0.5 * self.lasted, self.T_first))
        L = min(L, max(0.5 * abs(self.travelled), self.least_scale))
        if (T, L) == (self.T, self.L):
            return
        ratio = np.array([self.T / T, self.L / L])
        table = self.rows.table
        direction = self.tangent
        if len(table) > 1:
            direction = -table[-2, 1:3] / (self.T, self.L)
            direction = direction / np.hypot(*direction)
        self.h *= math.hypot(*(direction * ratio))
        self.tangent = self.tangent * ratio
        self.tangent = self.tangent / np.hypot(*self.tangent)
        self.T, self.L = T, L
        self.rows.measure(T, L)

    @property
    def let_go(self) -> bool:
        """Whether a contact without adhesion has come to a force that is nothing."""
        forces = self.rows.table[-2:, 3]
        falling = len(forces) > 1 and forces[1] < forces[0]
        return falling and self.law.adhesion is None and forces[1] <= ROUNDING * self.largest_force

    @property
    def least_radius(self) -> float:
        """Radius below which no contact is followed: one zone, at rest if its stress is fixed.

        Without adhesion a plane tip is let go as a whole; other contacts end in a point. A force only tells a
        penetration where it is not lost in rounding.
        """
        end_in_a_point = self._vanishing if self.leg.control == "force" else 0.0
        return self.law.zone or self.law.tip or end_in_a_point

    @cached_property
    def _vanishing(self) -> float:
        """Radius of an elastic contact whose force is lost in the rounding of the largest."""
        body, radius = self.body, self.L_run / SMALL_PART
        least = 2.0 * body.rheology.relaxed * ROUNDING * pressed_force(body, radius)
        return max(pressed_radius(body, least, self.law.rim), STILL * self.L_run)

    # a step ---

    def step(self) -> Ending:
        """One attempt; what it came to."""
        self._rescale()
        plan = self._plan()
        correction = self._correct(plan)
        errors = np.array([math.inf]) if correction is None else self._errors(plan, correction)
        first = len(self.rows) == 1
        error, (order, rung) = errors[min(self.rows.order, len(errors)) - 1], self._longest(errors)
        if correction is None or not error <= REJECTED:
            return self._reject(plan, order, rung, float(np.nanmin(errors)))
        self.fails = 0
        correction = self._to_level(plan, correction)
        self._finish(plan, correction)
        self.rows.order = min(len(self.rows), order)
        if plan.event is Ending.NONE:
            self.h = (correction.s if first else plan.h) * RUNG**rung
        return plan.event

    def _errors(self, plan: Plan, correction: Correction) -> Array:
        """Errors of a step, in tolerances, had the last 1, 2, ... rows predicted it.

        Distances from the path in the plane of load parameter and radius, and what depth and force are off.
        What a step leaves in the fields counts with its way. Where the penetration follows from a force its
        error is one of the whole contact, and counts as it is. Under a load that stands still nothing brings
        the edge back to where it should be at that time: errors of all steps add up, and each may make its
        share.
        """
        arrival, tangent = correction.arrival, plan.tangent
        self.borne = max(self.borne, abs(self.state.force))
        self.largest_force = max(self.largest_force, self.borne)
        row = np.array([arrival.rise, arrival.trial.travel, arrival.force, arrival.depth])
        force = max(abs(self.state.force), SMALL_PART * self.largest_force) or 1.0
        scales = np.array([self.T, self.L, force, self.depth])
        way = correction.s if plan.fixed is Fixed.REST else plan.h
        p, a, F, D = self.rows.mispredicted(way, row, scales).T
        if len(p) == 1:  # nothing to judge by: the first step is small
            return np.where(np.isfinite(F), 0.0, math.inf)
        across, along = p * tangent[1] - a * tangent[0], p * tangent[0] + a * tangent[1]
        depth = D - along * tangent[3] if self.leg.free else 0.0
        load = F - along * tangent[2] / scales[2]
        errors = np.sqrt(across**2 + depth**2 + load**2)
        way, weight = min(plan.h, 1.0), 1.0
        if not self.leg.free:
            weight = max(LEAST_WEIGHT, way)
        elif self.leg.stands:
            weight = 1.0 / max(LEAST_SHARE, way)
        return np.where(np.isfinite(errors), weight * errors / self.tolerance, math.inf)

    def _longest(self, errors: Array) -> tuple[int, int]:
        """How many rows are to predict a step for it to be longest, and how long it is in this one, in rungs.

        The more of them where the step may grow as it likes: turns and folds are seen on the predictor.
        Beyond a bend of the path a parabola goes farther than a polynomial that reaches back over it.
        """
        rows = np.arange(1.0, len(errors) + 1.0)
        rungs = np.floor(np.log(np.maximum(errors, 1e-5)) / (-(rows + 1.0) * math.log(RUNG)))
        rungs = np.clip(rungs, UNSEEN, LARGEST_GROWTH)
        rungs[: len(errors) > 1] = -math.inf  # one row knows no direction
        best = len(errors) - int(rungs[::-1].argmax())
        return best + (best == len(errors)), int(rungs[best - 1])

    def _reject(self, plan: Plan, order: int, rung: int, error: float) -> Ending:
        """Try a shorter step; where none is short enough, look what became of the contact.

        Past a corner of the path the error grows in proportion to the distance past it, whatever the order of
        prediction: the longest step within the tolerance lies on the line through the last two rejected ones.
        """
        self.rejected += 1
        self.fails += 1
        (h, before), self.tried = self.tried, (plan.h, error)
        if self.fails > 1 and error < before < math.inf:
            share = 1.0 - (error - 1.0) / (before - error) * (h - plan.h) / plan.h
            rung = min(rung, math.floor(math.log(share, RUNG)) if share > 0.0 else UNSEEN)
        self.h = plan.h * RUNG ** min(rung, LEAST_CUT)
        self.rows.order, self.slopes = min(len(self.rows), order), {}
        if self.h < SMALLEST_STEP:
            self.fails = 0
            for _ in range(2 if self.moving else 0):  # it may have come back to a corner that it had passed
                if self._runs_away(self.tolerance * self.state.radius):
                    return Ending.FOLD
                self.direction = -self.direction
            return Ending.LOST
        return Ending.REJECTED

    def _correct(self, plan: Plan) -> Correction | None:
        return self._at_radius(plan) if plan.fixed is Fixed.RADIUS else self._at_load(plan)

    def _chord(self, p: float, a: float) -> float:
        """Arclength from the last row of a point that far from it."""
        return math.hypot(p / self.T, a / self.L)

    def _at_radius(self, plan: Plan) -> Correction | None:
        """The load parameter at which the edge is at the predicted radius."""
        p, a, new = plan.z[0] * self.T, plan.z[1] * self.L, len(self.rows) == 1
        s, ends = self._chord(p, a), {}
        trial = self.trial(a, s)

        def function(at: float) -> float:
            ends[at] = self.arrive(trial, at)
            return ends[at].residual

        size = 1e-3 * (p if p > 0.0 else self.h * self.T)
        rise = self._secants(function, max(p, 0.0), size, Fixed.RADIUS)
        if rise is None or rise > self.leg.end - self.state.parameter + ROUNDING * self.leg.end:
            return None
        if not new and abs(rise - p) > 10.0 * plan.h * self.T:
            return None
        if plan.event is not Ending.FOLD and self._folds(a) and ends[rise].pace < 0.0:
            return None  # beyond a fold that was not foreseen
        return Correction(ends[rise], self._chord(rise, a) if new else s)  # at first no load is predicted

    def _at_load(self, plan: Plan) -> Correction | None:
        """The radius at which the edge is at the predicted load: where it was, if it rests there.

        The residual rises with the radius. At an edge that may rest it jumps: what opening asks for, and what
        closing does, have zero between them. A resting edge that would move departs where that ends.
        """
        p, guess = plan.z[0] * self.T, plan.z[1] * self.L
        if plan.event is Ending.END:
            p = self.leg.end - self.state.parameter
        if p <= 0.0:
            return None
        ends: dict[float, Arrival] = {}

        def function(a: float) -> float:
            if not self.least_radius <= self.state.radius + a <= self.law.rim:
                return math.nan
            ends[a] = self.arrive(self.trial(a, self._chord(p, a)), p)
            return ends[a].residual

        # after a kink no direction is known
        near = self.L * (10.0 * plan.h if len(self.rows) > 1 else UNFORESEEN)
        size = max(1e-3 * plan.h, SEEN) * min(self.L, self.law.zone or self.L)
        rests = self.law.rests(self.state.radius)
        if rests or self.law.adhesion is None:
            rested = plan.fixed is Fixed.REST
            trial = self.trial(0.0, self._chord(p, 0.0))
            ends[0.0] = self.arrive(trial, p)
            pulled, speed = ends[0.0].pull(-self.noise if rests and not rested else self.noise), 0.0
            if pulled > 0.0 and self.law.rated and self.leg.timed:  # it has a speed, seen or not
                speed = self.law.allowed_speed(ends[0.0].integral)
                pulled = 0.0 if rested and speed * p < 0.1 * self.still else pulled
            if pulled == 0.0:
                if rests and not rested:
                    plan.event = plan.event or Ending.TURN
                return Correction(ends[0.0], self._chord(p, 0.0))
            if rested and not speed and self.arrive(trial, 0.0).pull(self.noise) == 0.0:
                plan.event = Ending.DEPARTURE
                return self._departure(p)
            plan.fixed = Fixed.LOAD
            if guess * pulled >= 0.0:  # it goes the other way
                guess = -math.copysign(min(speed * p, near) or size, pulled)
                size = 0.5 * abs(guess)
        root = self._secants(function, guess, size, Fixed.LOAD)
        if root is not None and self.slopes.get(Fixed.LOAD, 0.0) < 0.0:
            return None  # not stable: the way back to a fold that was passed unseen
        if root is None:
            root = self._between(function, {a: end.residual for a, end in ends.items()})
        if root is None or abs(root - guess) > near:
            return None
        return Correction(ends[root], self._chord(p, root))

    def _departure(self, end: float) -> Correction:
        """The least rise at which a resting edge sets off: by halves, as the pull is zero before."""
        p = end
        for _ in range(2):  # the second is the step that ends there
            trial, low, p = self.trial(0.0, self._chord(p, 0.0)), 0.0, end
            while p - low > max(ROUNDING * self.T, 2.0 * math.ulp(p)):
                middle = 0.5 * (low + p)
                rests = self.arrive(trial, middle).pull(self.noise) == 0.0
                low, p = (middle, p) if rests else (low, middle)
        return Correction(trial.arrive(p), self._chord(p, 0.0))

    def _between(self, function: Callable[[float], float], known: dict[float, float]) -> float | None:
        """A root between two known points, the residual rising; without adhesion it may be a jump."""
        sides = [(b - a, a, b) for a in known for b in known if a < b and known[a] < 0.0 < known[b]]
        if not sides:
            return None
        _, a, b = min(sides)
        root = bracketed(function, a, b, NARROW * self.tolerance * max(abs(a), abs(b)))
        return root if self.law.adhesion is None or abs(function(root)) < 10.0 * self.noise else None

    def _secants(self, function: Callable[[float], float], x: float, size: float, of: Fixed) -> float | None:
        """Root by secants; where rounding stops them, the best point if it is one."""
        f, of_load = function(x), of is Fixed.RADIUS
        enough = ROUNDING if of_load else self.noise
        if abs(f) < enough:
            return x
        slope, best = self.slopes.get(of), (abs(f), x)
        after = x - f / slope if slope else (x + size if of_load else x - math.copysign(size, f))
        for _ in range(SECANTS):
            if after == x:  # no number lies closer
                return x
            after = max(after, 0.0) if of_load else after
            if after == x:  # the root lies before the step
                break
            value = function(after)
            if not math.isfinite(value) or value == f:
                break
            slope, best = (value - f) / (after - x), min(best, (abs(value), after))
            x, f = after, value
            after = x - f / slope
            if abs(f) < enough or abs(after - x) < NARROW * self.tolerance * abs(x):
                self.slopes[of] = slope
                return x
        return best[1] if best[0] < 10.0 * self.noise else None

    # events ---

    def _to_level(self, plan: Plan, correction: Correction) -> Correction:
        """The step cut where the path comes to the level, or its zone fills the contact."""
        level = self.level if self.leg.timed else None

        def excess(arrival: Arrival) -> tuple[float, Ending]:
            found, trial = [(-math.inf, Ending.NONE)], arrival.trial
            if level is not None:
                found.append((level(arrival.depth, arrival.force, trial.radius), Ending.LEVEL))
            if self.law.cohesive:
                zone = trial.zone_at_stress(arrival.motion)
                found.append((zone / trial.radius - FILLED, Ending.LEAST))
            return max(found)

        def along(u: float) -> float:
            return excess(correction.arrival.part(u))[0]

        if excess(correction.arrival)[0] < 0.0:
            return correction
        at = bracketed(along, NEGLIGIBLE, 1.0, ROUNDING) if along(NEGLIGIBLE) < 0.0 < along(1.0) else 1.0
        end = correction.arrival.part(at)
        plan.event = excess(end)[1]
        return replace(correction, arrival=end, s=at * correction.s)

    def _plan(self) -> Plan:
        """The next step: to the first event on its way, or not close to it.

        The way left after a row next to an event would be lost in what rounding leaves of the row. Other rows
        are aimed at in single precision: doubled steps amplify the rounding of those before a thousandfold.
        """
        path = self.rows.predictor(self.T, self.L, self.depth, self.tangent)
        levels = [(Ending.END, (self.leg.end - self.state.parameter) / self.T)]
        rests = self.law.rests(self.state.radius) and not self.moving
        if not rests:
            ends = (Ending.LEAST, self.least_radius), (Ending.RIM, self.law.rim)
            levels += [(kind, (radius - self.state.radius) / self.L) for kind, radius in ends]
            levels += [(Ending.CORNER, way / self.L) for way in self._corners]
            levels += [(Ending.TURN, 0.0), (Ending.FOLD, 0.0)]
        at, kind, level = self._first(path, levels, self.h / TOWARDS)
        if kind is Ending.NONE:
            at = self.h
        elif at > self.h or (kind is Ending.FOLD and not self._settled(path, at)):
            at, kind = TOWARDS * at, Ending.NONE
        there, tangent = path.place(at), path.slope(at)
        tangent = tangent / np.hypot(*tangent[:2])
        if kind is Ending.NONE:
            there[:2] = there[:2].astype(np.float32)
        elif kind is Ending.END:
            there[0] = level
        elif kind in (Ending.LEAST, Ending.RIM, Ending.CORNER):
            there[1] = level
        moves = abs(tangent[1]) > MOVING and abs(there[1]) * self.L > self.still
        fixed = Fixed.RADIUS if moves and kind not in (Ending.END, Ending.TURN) else Fixed.LOAD
        return Plan(at, there, tangent, Fixed.REST if rests else fixed, kind)

    @property
    def _corners(self) -> list[float]:
        """Ways to where the edge, or the end of its zone, comes to what was never in contact.

        Without adhesion an edge may stand there that creeps on by less than a row can tell.
        """
        edges = self.state.surface.edges
        if not len(edges) or self.law.adhesion is None:
            return []
        ways = float(edges[-1]) - self.still, float(edges[-1]) - self.law.zone
        return [way for way in ways if abs(way) > self.still]

    def _first(
        self, path: Predictor, levels: list[tuple[Ending, float]], reach: float
    ) -> tuple[float, Ending, float]:
        """The first event within reach, where it is, and its level."""
        found, slope = [(math.inf, Ending.NONE, 0.0)], float(path.slope(0.0)[1])
        runs = abs(slope) * reach * self.L > self.still
        for kind, level in levels:
            if kind is Ending.END or (runs and (kind is not Ending.FOLD or self._folds(slope))):
                found.append((path.passage(*SIGHTS[kind], level, reach), kind, level))
        return min(found)

    def _folds(self, way: float) -> bool:
        """Whether an edge that goes that way may run away."""
        return self.law.folds or way > 0.0

    def _settled(self, path: Predictor, at: float) -> bool:
        """Whether the place of a fold foreseen no longer changes."""
        vertex = float(path.place(at)[1]) * self.L
        change, self.vertex = abs(vertex - self.vertex), vertex
        return change < SAME_FOLD * self.tolerance * self.L

    def _finish(self, plan: Plan, correction: Correction) -> None:
        """Take a step, and what its event asks for next."""
        self._accept(correction.arrival, correction.s)
        if self.state.parameter >= self.leg.end and plan.event is not Ending.LEVEL:
            plan.event = Ending.END  # an event that rounds onto it
        match plan.event:
            case Ending.TURN:  # the scales grow anew from there
                self._restart(h=AFTER_TURN * plan.h)
                if self.leg.timed:
                    self.lasted, self.T_first = 0.0, self.h * self.T
            case Ending.DEPARTURE if self.state.radius == 0.0:
                self._touch()
            case Ending.DEPARTURE:
                self.direction = -1.0 if correction.arrival.pull() >= 0.0 else 1.0
                if self.direction < 0.0 and self.state.radius <= self.least_radius:
                    plan.event = Ending.LEAST
                    return
                if self.law.rated and self.direction > 0.0:  # its drive may be lost in rounding
                    self._restart()
                else:
                    way = np.array([0.0, self.direction])
                    self._restart(way, FIRST_STEP * self.least_scale / self.L)
                self.moving = True
                if self._runs_away():
                    plan.event = Ending.FOLD
            case Ending.CORNER:
                self._restart(plan.tangent[:2], FIRST_STEP * self.least_scale / self.L)
            case Ending.RIM:
                self._restart()

    def _accept(self, arrival: Arrival, s: float) -> None:
        """Commit a step."""
        state, rise, trial = arrival.after(), arrival.rise, arrival.trial
        self.accepted(arrival, state, s)
        self.rows.append(s, rise, trial.travel, state.force, state.depths)
        self.state = state
        self.lasted, self.travelled = self.lasted + rise, self.travelled + trial.travel
        self.vertex -= trial.travel
        self.depth = max(self.depth, SMALL_PART * abs(state.depth))
        self.steps += 1
        if trial.direction:
            self.moving, self.direction = True, trial.direction

    def _runs_away(self, known: float = 0.0) -> bool:
        """Whether an edge that sets off, or has come to a kink, is driven the more the farther it gets.

        ``known``: how well its place is.
        """
        values = []
        for share in (0.01, 0.02):
            size = max(share * (self.law.zone or self.state.radius), 100.0 * share * known)
            values.append(self._at_same_load(self.direction * size)[1] * self.direction)
        return not (values[0] >= 0.0 or values[1] >= values[0])  # none where its zone fills the contact

    def _at_same_load(self, travel: float) -> tuple[Arrival, float]:
        """An edge put elsewhere, and its residual: none where its zone fills the contact."""
        trial = self.trial(travel, abs(travel) / self.L, 1)
        end = self.arrive(trial, 0.0)
        filled = self.law.cohesive and trial.zone > FILLED * trial.radius
        return end, math.nan if filled else end.residual

    def unstable(self) -> bool:
        """Whether a contact that another control held runs away under this one, where the load drives it."""
        radius = self.state.radius
        if radius == 0.0 or self.law.adhesion is None or self.law.rests(radius):
            return False
        here = self.trial(0.0, self.h, 1)
        start, soon = (self.arrive(here, rise).residual for rise in (0.0, self.h * self.T))
        self.direction = 1.0 if soon < start else -1.0
        return self._runs_away()

    def lost(self, at_fold: bool) -> bool:
        """Whether there is no other stable edge at the same load; if there is, the contact goes there."""
        self._restart()
        zone, a, way, least = self.law.zone, self.state.radius, self.direction, self.least_radius
        ends = {}

        def residual(travel: float) -> float:
            ends[travel], value = self._at_same_load(travel)
            return value

        if at_fold:
            first = way * max(0.05 * zone, 1e-3 * a)
        else:  # what a row has left of the residual may drive the edge either way
            sides = way * self.still, -way * self.still
            first = next(
                (side for side in sides if a + side > least and residual(side) * side < 0.0), sides[0]
            )
            way = math.copysign(1.0, first)
        before = first, residual(first) if a + first > least else math.nan
        if before[1] * way > 0.0:
            if self.stuck_at == self.steps:
                return True
            self.stuck_at = self.steps
            return False
        travels = (
            (least - a) * np.linspace(0.0, 1.0, 17)[1:] ** 1.5
            if way < 0.0
            else a * (np.geomspace(1.0, LARGEST_JUMP, 129)[1:] - 1.0)
        )
        for travel in travels[way * (travels - first) > 0.0].tolist():
            value = residual(travel)
            if before[1] * way < 0.0 <= value * way:
                at = bracketed(residual, before[0], travel)
                residual(at)
                self._accept(ends[at], abs(at) / self.L)
                self._restart()
                return False
            before = travel, value
        return True
