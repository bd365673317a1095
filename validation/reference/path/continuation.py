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

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.correction import FILLED, Correction, Corrector, Ending, Fixed
from validation.reference.path.equilibrium import pressed_depth, pressed_force, start_state
from validation.reference.path.numerics import NEGLIGIBLE, ROUNDING, SMALL_PART, bracketed
from validation.reference.path.path import Leg, Predictor, Rows
from validation.reference.path.state import State, faded
from validation.reference.path.trial import Arrival

Array = NDArray[np.float64]
Level = Callable[[float, float, float], float]
"""How far penetration, force and radius are beyond a level."""

FIRST_STEP = 1e-3
"""First step of a leg, in parts of the shortest time and of the zone."""
FIRST_RADIUS = 1e-2
"""Least radius of the first step of a new contact, in the scale of the radius."""
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
MOVING = 3e-3
"""Share of the radius in the direction of the path from which on a step ends at a radius."""
AFTER_TURN = 0.1
"""First step after a turn, in the step before: nothing else tells whether it is short enough."""
TOWARDS = 0.75
"""Share of the way to an event that a step goes at most if it does not end there."""
SAME_FOLD = 0.1
"""Change of the place of a fold foreseen, in tolerances, below which it is landed on."""


SIGHTS = {
    Ending.END: (0, 0, 1.0),
    Ending.LEAST: (0, 1, -1.0),
    Ending.RIM: (0, 1, 1.0),
    Ending.CORNER: (0, 1, 0.0),
    Ending.TURN: (1, 1, 0.0),
    Ending.FOLD: (1, 0, -1.0),
}
"""Events as functions of the path ahead: derivative, component, and the way it passes a level."""


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


@dataclass
class Continuation(Corrector):
    """A run in progress; ``lasted``, ``travelled``: since the leg began and the edge set off."""

    accepted: Callable[[Arrival, State, float], None] = lambda *_: None
    lasted: float = 0.0
    travelled: float = 0.0
    T_leg: float = 1.0
    T_first: float = 1.0
    h: float = 1.0
    tangent: Array = field(default_factory=lambda: np.array([1.0, 0.0]))
    fails: int = 0
    tried: tuple[float, float] = (math.nan, math.nan)
    steps: int = 0
    rejected: int = 0
    moving: bool = False
    direction: float = -1.0
    vertex: float = math.nan
    stuck_at: int = -1
    level: Level | None = None
    largest_force: float = 0.0

    def begin(self, leg: Leg, T_leg: float) -> None:
        """A new leg: a kink of the path."""
        self.leg, self.T_leg, self.T = leg, T_leg, T_leg
        self.L, self.lasted = min(self.L_run, self.least_scale), 0.0
        state = self.state = replace(self.state, parameter=leg.start)
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
        leg, body, rheology, begin = self.leg, self.body, self.body.rheology, self.state.parameter
        whole, start, forced = leg.end - begin, leg.value(begin), leg.control == "force"
        change, soft = leg.value(leg.end) - start, rheology.relaxed / rheology.glassy if forced else 1.0
        a = max(self.pressed_to(NEGLIGIBLE * self.depth / SMALL_PART, False), FIRST_RADIUS * self.L_run)
        if change > 0.0:  # the leg may end at less
            a = min(a, self.pressed_to(SMALL_PART * soft * change, forced))
        load = 2.0 * rheology.glassy * pressed_force(body, a) if forced else pressed_depth(body, a)
        p = whole * min(load / (abs(change) or load), 1.0)
        if change > load:
            p = bracketed(lambda at: leg.value(begin + at) - start - load, 0.0, whole)
        self.T_first = max(2.0 * p, min(self.T_leg, rheology.shortest), 1e-300) if leg.timed else SMALL_PART
        self.T, self.L, self.lasted = self.T_first, a, 0.0
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
        """Whether a contact without adhesion has come to a force that is nothing beside what it has borne."""
        forces = self.rows.table[-2:, 3]
        falling = len(forces) > 1 and forces[1] < forces[0]
        return falling and self.law.adhesion is None and forces[1] <= ROUNDING * self.borne

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
        if correction.ending is Ending.DEPARTURE or not plan.event:
            plan.event = correction.ending
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
        rests = plan.fixed is Fixed.REST and not arrival.trial.direction
        way = correction.s if rests else plan.h
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
        rungs = np.floor(np.log(np.maximum(errors, NEGLIGIBLE)) / (-(rows + 1.0) * math.log(RUNG)))
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
                if self.runs_away(self.direction, self.tolerance * self.state.radius):
                    return Ending.FOLD
                self.direction = -self.direction
            return Ending.LOST
        return Ending.REJECTED

    def _correct(self, plan: Plan) -> Correction | None:
        p, a = plan.z[0] * self.T, plan.z[1] * self.L
        if plan.fixed is Fixed.RADIUS:
            return self.at_radius(p, a, plan.h, plan.event is Ending.FOLD)
        if plan.event is Ending.END:
            p = self.leg.end - self.state.parameter
        return self.at_load(p, a, plan.h, plan.fixed is Fixed.REST) if p > 0.0 else None

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
            if kind is Ending.END or (runs and (kind is not Ending.FOLD or self.folds(slope))):
                found.append((path.passage(*SIGHTS[kind], level, reach), kind, level))
        return min(found)

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
                if self.runs_away(self.direction):
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

    def unstable(self) -> bool:
        """Whether a contact that another control held runs away under this one, where the load drives it."""
        radius = self.state.radius
        if radius == 0.0 or self.law.adhesion is None or self.law.rests(radius):
            return False
        here = self.trial(0.0, self.h, 1)
        start, soon = (self.arrive(here, rise).residual for rise in (0.0, self.h * self.T))
        self.direction = 1.0 if soon < start else -1.0
        return self.runs_away(self.direction)

    def lost(self, at_fold: bool) -> bool:
        """Whether there is no other stable edge at the same load; if there is, the contact goes there."""
        self._restart()
        a, way = self.state.radius, self.direction

        def residual(travel: float) -> float:
            return self.elsewhere(travel)[1] if a + travel > self.least_radius else math.nan

        if at_fold:
            first = way * max(0.05 * self.law.zone, 1e-3 * a)
        else:  # what a row has left of the residual may drive the edge either way
            sides = way * self.still, -way * self.still
            first = next((side for side in sides if residual(side) * side < 0.0), sides[0])
            way = math.copysign(1.0, first)
        value = residual(first)
        if value * way > 0.0:
            stuck, self.stuck_at = self.stuck_at == self.steps, self.steps
            return stuck
        there = self.next_stable(way, first, value)
        if there is not None:
            self._accept(there, abs(there.trial.travel) / self.L)
            self._restart()
        return there is None
