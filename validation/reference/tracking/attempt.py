"""One trial step: the edge that satisfies the law at the end of a given time, or the time for a given edge.

Under force control the penetration at the end of the step is a further unknown. For a given edge every field
is affine in it, so that two values of it give the surface for any.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scene import Counters, Segment
from validation.reference.tracking.drive import Drive, cubic, straight
from validation.reference.tracking.law import Law
from validation.reference.tracking.root import bracketed
from validation.reference.tracking.surface import Body, Path, Surface, moved

Array = NDArray[np.float64]

CLOSED = 1e-10  # residual of the law at an accepted edge
NARROW = 1e-14  # of the radius: two edges that are the same


@dataclass(frozen=True)
class Curvature:
    """Second derivatives in time carried over from the steps before; zero after a kink."""

    radius: float = 0.0
    penetration: float = 0.0


@dataclass(frozen=True)
class Found:
    """Where the search for the edge ended: at a root (``reached``) or at a limit of the search."""

    radius: float
    reached: bool


@dataclass(frozen=True)
class Attempt:
    """A step of any duration from one state, under one loading segment.

    ``marks(duration)`` are the fractions of the step at which nodes are left besides its end.
    """

    body: Body
    law: Law
    surface: Surface
    segment: Segment
    time: float
    curvature: Curvature
    marks: Callable[[float], Array]
    counters: Counters
    cap: float

    def surface_at(self, duration: float, radius: float, reach: float = math.inf) -> Surface:
        """The surface when the edge arrives at ``radius``; only its part within ``reach`` of the edge if that
        is all that is needed (never under force control, which needs the whole)."""
        start = self.surface
        travel = radius - start.radius
        limit = 0.5 * abs(travel)
        bend = min(max(0.5 * self.curvature.radius * duration**2, -limit), limit)
        path = Path(start.radius, travel, bend)
        marks = self.marks(duration) if travel != 0.0 else np.empty(0)
        if self.segment.control == "penetration":
            if math.isfinite(reach):
                start = start.near(min(radius, start.radius) - reach, max(radius, start.radius) + reach)
            return moved(start, self.body, self._prescribed(duration), path, marks)
        return self._balanced(duration, path, marks)

    def residual(self, duration: float, radius: float, reach: float) -> float:
        """Residual of the law at that edge."""
        self.counters.closure_evaluations += 1
        surface = self.surface_at(duration, radius, reach)
        if radius == self.surface.radius:
            return self.law.at_rest(surface, self.body)
        return self.law.residual(surface, self.body)

    def edge(self, duration: float, guess: float, reach: float, lowest: float, highest: float) -> Found:
        """Stable edge nearest to the present one after ``duration``, sought between the limits.

        The indenter's own edge is an answer where the law wants to go further.
        """
        a0 = self.surface.radius

        def function(radius: float) -> float:
            return self.residual(duration, radius, reach)

        f0 = function(a0)
        up = f0 < 0.0
        if abs(f0) <= CLOSED or (up and a0 >= self.cap):
            return Found(a0, True)
        limit = highest if up else lowest
        if (limit <= a0) if up else (limit >= a0):
            return Found(a0, False)
        stride = abs(guess - a0) if (guess > a0) == up and guess != a0 else 1e-3 * abs(limit - a0)
        near, at_near = a0, f0
        while True:
            far = min(near + stride, limit) if up else max(near - stride, limit)
            at_far = function(far)
            if abs(at_far) <= CLOSED:
                return Found(far, True)
            if (at_far > 0.0) == up:
                root = bracketed(function, near, at_near, far, at_far, CLOSED, NARROW * a0)
                return Found(root, True)
            if far == limit:
                return Found(limit, up and limit >= self.cap)
            near, at_near, stride = far, at_far, 3.0 * stride

    def duration_to(self, radius: float, longest: float, reach: float) -> float | None:
        """Time at which the edge arrives at ``radius``; ``None`` if it would be there at once."""
        outward = radius > self.surface.radius

        def function(duration: float) -> float:
            return self.residual(duration, radius, reach)

        at_once, late = function(0.0), function(longest)
        if (at_once <= 0.0) if outward else (at_once >= 0.0):
            return None
        if (late >= 0.0) if outward else (late <= 0.0):
            return longest
        return bracketed(function, 0.0, at_once, longest, late, CLOSED, 1e-14 * longest)

    def between(self, duration: float, first: float, second: float, reach: float) -> float:
        """The edge between two radii at which the residuals differ in sign."""

        def function(radius: float) -> float:
            return self.residual(duration, radius, reach)

        one, two = function(first), function(second)
        return bracketed(function, first, one, second, two, CLOSED, NARROW * max(first, second))

    def _prescribed(self, duration: float) -> Drive:
        begin, end = self.time, self.time + duration
        value = self.segment.value
        first = value(begin)
        jump = first - self.surface.penetration
        if self.segment.linear or duration == 0.0:
            return straight(duration, self.surface.penetration, jump, value(end) if duration > 0.0 else first)
        shape = cubic(duration, first, value(end), self.segment.rate(begin), self.segment.rate(end))
        return replace(shape, start=self.surface.penetration, jump=jump)

    def _balanced(self, duration: float, path: Path, marks: Array) -> Surface:
        target = self.segment.value(self.time + duration)
        start, rheology = self.surface.penetration, self.body.rheology
        y = duration / rheology.times
        shared = -np.expm1(-y) / np.where(y > 0.0, y, 1.0) + (y == 0.0)
        stiffness = 2.0 * path.start * (rheology.relaxed + float((rheology.moduli * shared).sum()))
        one = moved(self.surface, self.body, self._free(duration, start), path, marks)
        force = one.force(self.body)
        if force == target:
            return one
        two = moved(
            self.surface, self.body, self._free(duration, start + (target - force) / stiffness), path, marks
        )
        share = (target - force) / (two.force(self.body) - force)
        return Surface(
            one.penetration + share * (two.penetration - one.penetration),
            one.inside,
            one.branches + share * (two.branches - one.branches),
            one.outside,
            one.units + share * (two.units - one.units),
        )

    def _free(self, duration: float, end: float) -> Drive:
        start = self.surface.penetration
        if duration == 0.0:
            return straight(0.0, start, end - start, end)
        drive = straight(duration, start, 0.0, end)
        c2 = 0.5 * self.curvature.penetration
        return replace(drive, rates=(drive.rates[0] - c2 * duration, c2, 0.0))
