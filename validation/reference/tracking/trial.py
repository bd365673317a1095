"""One trial step: the edge that satisfies the law after a given time, or the time for a given edge."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters, Segment
from validation.reference.tracking.control import balanced, prescribed
from validation.reference.tracking.law import Law
from validation.reference.tracking.node_placement import Marks
from validation.reference.tracking.root import bracketed, rising_root
from validation.reference.tracking.step_history import Course
from validation.reference.tracking.surface import Body, Path, Step, Surface, moved, step

Array = NDArray[np.float64]

MOST = 400  # nodes left by an edge that runs
GROWTH = 1.1  # of the strides in which an edge on the run is looked for
BENT = 0.99  # of the travel: short of turning round within the step
FIRST = np.arange(1, 16) / 16.0  # where a contact that begins has nodes
NARROW = 1e-14  # relative: two radii or two times that are the same


@dataclass(frozen=True)
class Found:
    """Where the search for the edge ended: at a root (``reached``) or at a limit of the search."""

    radius: float
    reached: bool
    steepness: float = 0.0


@dataclass(frozen=True)
class Attempt:
    """A step of any duration from one state, under one loading segment.

    ``marks(duration)`` are the fractions of the step at which nodes are left besides its end; ``cap`` is the
    largest possible radius, ``spacing`` the distance of nodes left behind.
    """

    body: Body
    law: Law
    surface: Surface
    segment: Segment
    time: float
    radii: Course
    depths: Course
    marks: Marks
    counters: Counters
    cap: float
    spacing: float
    _steps: dict[float, Step] = field(default_factory=dict)

    def surface_at(self, duration: float, radius: float, whole: bool = True) -> Surface:
        """The surface when the edge has arrived at ``radius``; if not ``whole``, what the law looks at."""
        start = self.surface
        travel = radius - start.radius
        limit = BENT * abs(travel)
        bend = 0.5 * self.radii.curvature(duration, radius) * duration**2
        bend = min(max(bend, -limit), limit)
        path = Path(start.radius, travel, bend)
        marks = self.marks(duration) if travel != 0.0 else np.empty(0)
        if start.radius == 0.0 < travel:  # a contact is not left to its centre and its edge
            marks = np.union1d(marks, FIRST)
        if abs(travel) > 2.0 * self.spacing:  # an edge that runs leaves nodes on its way, too
            count = min(int(abs(travel) / self.spacing), MOST)
            marks = np.union1d(marks, np.arange(1, count + 1) / (count + 1))
        if self.segment.control == "force":
            target = self.segment.value(self.time + duration)
            return balanced(start, self.body, target, duration, self.depths, path, marks)
        by = self._steps.get(duration)
        if by is None:
            drive = prescribed(self.segment, self.time, duration, start)
            by = self._steps[duration] = step(start, self.body, drive)
        if not whole:
            reach = self.law.reach
            start = start.near(min(radius, start.radius) - reach, max(radius, start.radius) + reach)
        return moved(start, self.body, by, path, marks)

    def residual(self, duration: float, radius: float) -> float:
        """Residual of the law at an edge that moves there."""
        self.counters.closure_evaluations += 1
        return self.law.residual(self.surface_at(duration, radius, False), self.body)

    def tendencies(self, duration: float) -> tuple[float, float]:
        """How much the edge, at rest so far, wants to go inward and outward after ``duration``."""
        self.counters.closure_evaluations += 1
        if self.surface.radius == 0.0 and self.segment.control == "force":
            target = self.segment.value(self.time + duration)
            return -1.0, math.copysign(1.0, target) if target != 0.0 else 0.0
        inward, outward = self.law.tendencies(
            self.surface_at(duration, self.surface.radius, False), self.body
        )
        return inward, -1.0 if self.surface.radius >= self.cap else outward

    def edge(
        self, duration: float, guess: float, lowest: float, highest: float, steepness: float = 0.0
    ) -> Found:
        """Stable edge nearest to the present one after ``duration``, sought between two limits.

        ``guess`` and ``steepness`` (of the residual over the radius, 0 if unknown) only save work.
        """
        a0 = self.surface.radius

        def function(radius: float) -> float:
            return self.residual(duration, radius)

        if guess != a0 and lowest < guess < highest:
            quick = rising_root(
                function, guess, 0.01 * (guess - a0), steepness, (lowest, highest), self.law.closed
            )
            if quick is not None and (quick[0] - a0) * (guess - a0) > 0.0:
                return Found(quick[0], True, quick[1])
        inward, outward = self.tendencies(duration)
        if inward <= self.law.closed and outward <= self.law.closed:
            return Found(a0, True)
        up = outward > inward
        limit = min(highest, self.cap) if up else lowest
        near, at_near = a0, -outward if up else inward
        stride = abs(guess - a0) if (guess > a0) == up and guess != a0 else 1e-3 * abs(limit - a0)
        while near != limit:
            far = min(near + stride, limit) if up else max(near - stride, limit)
            at_far = function(far)
            if (at_far >= 0.0) == up or abs(at_far) <= self.law.closed:
                return Found(
                    bracketed(function, near, at_near, far, at_far, self.law.closed, NARROW * a0), True
                )
            near, at_near, stride = far, at_far, 3.0 * stride
        return Found(limit, up and limit >= self.cap)

    def duration_to(self, radius: float, longest: float) -> float | None:
        """Time at which the edge arrives at ``radius``; ``None`` if it would be there at once."""
        outward = radius > self.surface.radius

        def function(duration: float) -> float:
            return self.residual(duration, radius)

        at_once, late = function(0.0), function(longest)
        if (at_once <= 0.0) if outward else (at_once >= 0.0):
            return None
        if (late >= 0.0) if outward else (late <= 0.0):
            return longest
        return bracketed(function, 0.0, at_once, longest, late, self.law.closed, NARROW * longest)

    def departure(self, longest: float) -> float | None:
        """Time within ``longest`` at which an edge at rest sets off; ``None`` if it stays or is under way."""
        late = self.tendencies(longest)
        for side in (0, 1):
            if late[side] > self.law.closed:
                now = self.tendencies(0.0)[side]
                if now >= -self.law.closed:
                    return None
                return bracketed(
                    lambda t, side=side: self.tendencies(t)[side],  # type: ignore[misc]
                    0.0,
                    now,
                    longest,
                    late[side],
                    self.law.closed,
                    NARROW * longest,
                )
        return None

    def run_to_rest(self, begin: float, stride: float, outward: bool, limit: float) -> float | None:
        """The next stable edge at fixed time for one on the run from ``begin``, up to ``limit``, if any.

        Looked for in strides, outward in growing ones: there the residual ends up positive on any profile.
        """
        radius = begin
        value = -self.law.closed if outward else self.law.closed
        while radius != limit:
            before, at_before = radius, value
            radius = min(radius + stride, limit) if outward else max(radius - stride, limit)
            value = self.residual(0.0, radius)
            if value > self.law.closed if outward else value < -self.law.closed:
                return bracketed(
                    lambda a: self.residual(0.0, a),
                    before,
                    at_before,
                    radius,
                    value,
                    self.law.closed,
                    NARROW * radius,
                )
            stride *= GROWTH if outward else 1.0
        return limit if outward and limit >= self.cap else None
