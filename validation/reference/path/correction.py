"""The edge condition solved from a row of the path: at a radius, at a load, or elsewhere at the same load.

The residual of an edge rises with its radius where the edge is stable. At a given radius the load parameter
is sought, which needs one geometry; a limit point of the load is nothing special there. At a given load the
radius is sought, a geometry for each guess. Where an edge may rest its residual jumps: what opening asks for,
and what closing does, have zero between them. So it is first asked where it stands.

While the load stands an edge that is driven the more the farther it gets runs away: to the next radius at
which it is stable, or for good.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.equilibrium import (
    pressed_depth,
    pressed_force,
    pressed_radius,
    touching_radius,
)
from validation.reference.path.numerics import DEGREE, ROUNDING, SMALL_PART, bracketed
from validation.reference.path.path import Leg, Rows
from validation.reference.path.rheology import IndentedBody
from validation.reference.path.state import State
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]

STILL = 1e-6
"""Travel of the edge, in zones, below which it is at rest."""
SOLVED = 100.0
"""Rounding of what is solved for an image, in units of the last place and the ratio of image and surface."""
NARROW = 1e-4
"""Change of a root by a secant, relative to it and in tolerances, with which it is found."""
SECANTS = 12
"""Most secants: they converge in four, or do not."""
SEEN = 1e-5
"""Least difference of two radii, in zones, that tells a slope beside the rounding of the residual."""
NEARBY = 1e-2
"""Part of a zone or of the scale of the radius in which an edge is looked for that no row has foreseen."""
FILLED = 1.0 - 1e-5
"""Zone of fixed stress, in the contact radius, at which the contact ends."""
LARGEST_JUMP = 1e4
"""Radius up to which a stable contact is looked for, in that at which one runs away."""


class Fixed(StrEnum):
    """What a step ends at."""

    RADIUS = "radius"
    LOAD = "load"
    REST = "rest"


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


@dataclass(frozen=True)
class Correction:
    """A step that satisfies the edge condition, its arclength, and what it came to that was not foreseen."""

    arrival: Arrival
    s: float
    ending: Ending = Ending.NONE


@dataclass
class Corrector:
    """What solves the edge condition from the last row of the path, on the leg that leads on from it.

    ``T``, ``L``, ``depth``: scales of load parameter, radius and penetration; ``L_run`` the largest of the
    radius. ``slopes``: of the residual over the load parameter and the radius, as last seen; they save
    evaluations. ``borne``: the largest force.
    """

    body: IndentedBody
    law: EdgeLaw
    state: State
    tolerance: float
    L_run: float
    depth: float
    leg: Leg = None  # type: ignore[assignment]
    rows: Rows = None  # type: ignore[assignment]
    T: float = 1.0
    L: float = 0.0
    slopes: dict[Fixed, float] = field(default_factory=dict)
    borne: float = 0.0
    evaluations: int = 0
    geometries: int = 0

    def trial(self, travel: float, s: float, order: int = DEGREE) -> Trial:
        """The step that goes that far."""
        self.geometries += 1
        segment = self.rows.segment(s, travel, order)
        return Trial(self.body, self.law, self.state, self.leg, segment)

    def arrive(self, trial: Trial, rise: float) -> Arrival:
        """The end of a trial after a rise of the load parameter."""
        self.evaluations += 1
        return trial.arrive(rise)

    def chord(self, p: float, a: float) -> float:
        """Arclength of a point that far from the row."""
        return math.hypot(p / self.T, a / self.L)

    @property
    def noise(self) -> float:
        """Residual below which there is only rounding.

        Without adhesion a load that goes back to nothing rounds like the largest. The image of a thin layer
        is that many times its surface, and as many times what is solved for it rounds.
        """
        noise, depths = 10.0 * ROUNDING, (self.state.depth, self.depth / SMALL_PART)
        load, largest = (self.state.force, self.borne) if self.leg.free else depths
        if self.law.adhesion is None and load:
            noise = max(noise, math.ulp(1.0) * largest / abs(load))
        if self.body.image.is_layer and self.state.radius > 0.0:
            image, surface = np.abs(self.state.depths[1:]).max(), self.body.shape(self.state.radius)
            surface += abs(self.state.depth)
            edge = self.law.strain(self.state.radius, self.body.rheology.glassy) or surface
            noise = max(noise, SOLVED * math.ulp(1.0) * image**2 / (surface * edge))
        return noise

    @property
    def least_scale(self) -> float:
        """Scale of the radius where an edge sets off: that at which what it left was known, or its zone."""
        return self.law.zone or max(NEARBY * self.L_run, self.L)

    @property
    def still(self) -> float:
        """Travel that changes nothing an edge can see."""
        return STILL * (self.law.zone or NEARBY * self.L_run)

    @property
    def least_radius(self) -> float:
        """Radius below which no contact is followed: one zone, at rest if its stress is fixed.

        Without adhesion a plane tip is let go as a whole; other contacts end where the load is lost in the
        rounding of the largest.
        """
        return self.law.zone or self.law.tip or self._vanishing[self.leg.control == "force"]

    @cached_property
    def _vanishing(self) -> tuple[float, float]:
        """Radius of an elastic contact of which the penetration, or the force, is lost in rounding."""
        body, radius = self.body, self.L_run / SMALL_PART
        depth, force = pressed_depth(body, radius), 2.0 * body.rheology.relaxed * pressed_force(body, radius)
        return self.pressed_to(ROUNDING * depth, False), self.pressed_to(ROUNDING * force, True)

    def pressed_to(self, load: float, forced: bool) -> float:
        """Radius of the relaxed contact without adhesion at a penetration or under a force."""
        return (pressed_radius if forced else touching_radius)(self.body, load, self.law.rim)

    def folds(self, way: float) -> bool:
        """Whether an edge that goes that way may run away."""
        return self.law.folds or way > 0.0

    # at a radius ---

    def at_radius(self, p: float, a: float, h: float, to_fold: bool) -> Correction | None:
        """The load parameter at which the edge has gone as far as ``a``; ``p``, ``h``: as predicted.

        ``to_fold``: whether the path was predicted to have a limit point there; none ends beyond another.
        """
        new, ends, s = len(self.rows) == 1, {}, self.chord(p, a)
        trial = self.trial(a, s)

        def function(at: float) -> float:
            ends[at] = self.arrive(trial, at)
            return ends[at].residual

        rise = self._secants(function, max(p, 0.0), 1e-3 * (p if p > 0.0 else h * self.T), Fixed.RADIUS)
        left = self.leg.end - self.state.parameter
        if rise is None or rise > left + ROUNDING * self.leg.end:
            return None
        if not new and abs(rise - p) > 10.0 * h * self.T:
            return None
        if not to_fold and self.folds(a) and ends[rise].pace < 0.0:
            return None
        return Correction(ends[rise], self.chord(rise, a) if new else s)  # at first no load is predicted

    # at a load ---

    def at_load(self, p: float, guess: float, h: float, rested: bool) -> Correction | None:
        """Where the edge is after a rise ``p``: where it was, if it rests there; ``guess``, ``h``: predicted.

        A resting edge (``rested``) that would move departs where its rest ends.
        """
        near = self.L * (10.0 * h if len(self.rows) > 1 else NEARBY)
        size = max(1e-3 * h, SEEN) * min(self.L, self.law.zone or self.L)
        ends: dict[float, Arrival] = {}

        def function(a: float) -> float:
            if a and not self.least_radius <= self.state.radius + a <= self.law.rim:
                return math.nan
            ends[a] = self.arrive(self.trial(a, self.chord(p, a)), p)
            return ends[a].residual

        rests = self.law.rests(self.state.radius)
        bears = self.state.radius > 0.0 or self.leg.control != "force"  # a point bears none
        if bears and (rests or self.law.adhesion is None):
            trial = self.trial(0.0, self.chord(p, 0.0))
            ends[0.0] = self.arrive(trial, p)
            pulled, speed = ends[0.0].pull(-self.noise if rests and not rested else self.noise), 0.0
            if pulled > 0.0 and self.law.rated and self.leg.timed:  # it has a speed, seen or not
                speed = self.law.allowed_speed(ends[0.0].integral)
                pulled = 0.0 if rested and speed * p < 0.1 * self.still else pulled
            if pulled == 0.0:
                stops = Ending.TURN if rests and not rested else Ending.NONE
                return Correction(ends[0.0], self.chord(p, 0.0), stops)
            if rested and not speed and self.arrive(trial, 0.0).pull(self.noise) == 0.0:
                return self._departure(p)
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
        return Correction(ends[root], self.chord(p, root))

    def _departure(self, end: float) -> Correction:
        """The least rise at which a resting edge sets off: by halves, as the pull is zero before."""
        p = end
        for _ in range(2):  # the second is the step that ends there
            trial, low, p = self.trial(0.0, self.chord(p, 0.0)), 0.0, end
            while p - low > max(ROUNDING * self.T, 2.0 * math.ulp(p)):
                middle = 0.5 * (low + p)
                rests = self.arrive(trial, middle).pull(self.noise) == 0.0
                low, p = (middle, p) if rests else (low, middle)
        return Correction(trial.arrive(p), self.chord(p, 0.0), Ending.DEPARTURE)

    def _between(self, function: Callable[[float], float], known: dict[float, float]) -> float | None:
        """A root between two known points, the residual rising; without adhesion it may be a jump."""
        sides = [(b - a, a, b) for a in known for b in known if a < b and known[a] < 0.0 < known[b]]
        if not sides:
            return None
        _, a, b = min(sides)
        root = bracketed(function, a, b, NARROW * self.tolerance * max(abs(a), abs(b)))
        return root if self.law.adhesion is None or abs(function(root)) < 10.0 * self.noise else None

    def _secants(self, function: Callable[[float], float], x: float, size: float, of: Fixed) -> float | None:
        """Root by secants; where rounding stops them, the best point if it is one.

        What rounding leaves of short zones is the same at each end of a step: of a load more is asked for.
        """
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

    # at the same load ---

    def elsewhere(self, travel: float) -> tuple[Arrival, float]:
        """The edge put elsewhere, and its residual: none where its zone fills the contact."""
        trial = self.trial(travel, abs(travel) / self.L, 1)
        end = self.arrive(trial, 0.0)
        filled = self.law.cohesive and trial.zone > FILLED * trial.radius
        return end, math.nan if filled else end.residual

    def runs_away(self, way: float, known: float = 0.0) -> bool:
        """Whether an edge that sets off is driven the more the farther it gets.

        ``known``: how well its place is.
        """
        values = []
        for times in (1.0, 2.0):
            size = times * max(NEARBY * (self.law.zone or self.state.radius), known)
            values.append(self.elsewhere(way * size)[1] * way)
        return not (values[0] >= 0.0 or values[1] >= values[0])  # none where its zone fills the contact

    def next_stable(self, way: float, first: float, value: float) -> Arrival | None:
        """The next stable edge on a way, beyond a travel at which the residual is known."""
        a, before = self.state.radius, (first, value)
        travels = (
            (self.least_radius - a) * np.linspace(0.0, 1.0, 17)[1:] ** 1.5
            if way < 0.0
            else a * (np.geomspace(1.0, LARGEST_JUMP, 129)[1:] - 1.0)
        )
        for travel in travels[way * (travels - first) > 0.0].tolist():
            value = self.elsewhere(travel)[1]
            if before[1] * way < 0.0 <= value * way:
                at = bracketed(lambda there: self.elsewhere(there)[1], before[0], travel)
                return self.elsewhere(at)[0]
            before = travel, value
        return None
