"""The loop: propose a step, judge it, commit it or cut it; instabilities located, kinks stepped onto.

A step is judged by how far force and radius leave the straight line from the step before: the trace is read
as straight between rows. An edge that would travel too far has its distance prescribed and its time
sought, so that a limit point (loss of contact, snap) is approached in distance, where nothing is singular.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from scene import Counters, Event, Outcome, OutcomeKind, Scene, Segment
from validation.reference.tracking.attempt import Attempt, Curvature
from validation.reference.tracking.law import Griffith, Law
from validation.reference.tracking.options import Options
from validation.reference.tracking.record import Record
from validation.reference.tracking.surface import Body, Surface
from validation.reference.tracking.thinning import thinned

Array = NDArray[np.float64]

THIN_EVERY = 12
FOLD = 1e-4  # of the largest travel: the limit point counts as reached when no longer step is stable
SHORTEST = 2.0  # process zones: an edge that runs free finds no rest in a contact shorter than that
LAYER = 1e-6  # of the process zone: a boundary layer thinner than this does not matter


@dataclass
class Run:
    """A run in progress; ``surface`` and ``record`` change only when a step is committed."""

    scene: Scene
    body: Body
    law: Law
    options: Options
    surface: Surface
    reach: float
    largest_travel: float
    radius_scale: float
    record: Record
    on_profile: Callable[[float, Surface, float], None]
    progress: Callable[[float], None] | None = None
    time: float = 0.0
    force: float = 0.0
    counters: Counters = field(default_factory=Counters)
    events: list[Event] = field(default_factory=list)
    outcome: Outcome | None = None
    _path: list[tuple[float, float, float, float]] = field(default_factory=list)
    _force_scale: float = 0.0
    _travel: float = 0.0

    def start(self) -> None:
        """Record the start state."""
        self.force = self.surface.force(self.body)
        self._travel = self.largest_travel
        self._commit_row()

    def go(self) -> Outcome:
        """Carry out all steps of the loading."""
        steps = self.scene.loading.steps
        for index, step in enumerate(steps):
            segment = step.segment(self.time, self.surface.penetration, self.force)
            self._segment(segment, index, len(steps))
            if self.outcome is not None:
                return self.outcome
        return Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", self.time)

    def _segment(self, segment: Segment, index: int, count: int) -> None:
        self._path.clear()
        present = self.surface.penetration if segment.control == "penetration" else self.force
        if segment.value(segment.start) != present:
            self._jump(segment)
        stops = sorted(
            {segment.end, *segment.kinks}
            | {t for t in self.options.profile_times if segment.start < t < segment.end}
        )
        kinks = {segment.end, *segment.kinks}
        step = 0.0
        for stop in stops:
            if not self._path:
                step = self._first_step(stop - self.time)
            while self.time < stop and self.outcome is None:
                step = self._advance(segment, stop, step)
                if self.progress is not None:
                    done = (self.time - segment.start) / max(segment.end - segment.start, 1e-300)
                    self.progress((index + done) / count)
            if self.outcome is not None:
                return
            if stop in self.options.profile_times:
                self.on_profile(self.time, self.surface, self.force)
            if stop in kinks:
                self._path.clear()

    def _first_step(self, length: float) -> float:
        times = self.body.rheology.times
        quick = 1e-2 * float(times.min()) if len(times) else length
        return min(max(quick, 1e-10 * length), 1e-2 * length)

    def _advance(self, segment: Segment, stop: float, proposed: float) -> float:
        """One step towards ``stop``; returns the next proposal."""
        if self.counters.steps + self.counters.rejected_steps >= self.options.max_steps:
            self.outcome = Outcome(
                OutcomeKind.STEP_BUDGET, f"{self.options.max_steps} steps are used up", self.time
            )
            return proposed
        left = stop - self.time
        h = left if proposed >= 0.999 * left else min(proposed, 0.5 * left)
        if self.time + h == self.time:
            self.outcome = Outcome(OutcomeKind.STEP_UNDERFLOW, f"step {h:.3g} below round-off", self.time)
            return proposed
        a0 = self.surface.radius
        curvature, slope = self._curvature()
        guess = a0 + slope * h
        attempt = self._attempt(segment, curvature, abs(guess - a0))
        low, high = max(a0 - self._travel, self._lowest()), min(a0 + self._travel, self.scene.indenter.edge)
        found = attempt.edge(h, guess, self.reach, low, high)
        if found.reached:
            surface = attempt.surface_at(h, found.radius)
            force = surface.force(self.body)
            deviation = self._deviation(h, found.radius, force, surface.penetration)
            if deviation > 2.0:
                self.counters.rejected_steps += 1
                return h * max(0.2, 0.9 / math.sqrt(deviation))
            self._commit(self.time + h if h < left else stop, surface, force)
            self._travel = min(self.largest_travel, 2.0 * self._travel)
            return h * min(2.0, 0.95 / math.sqrt(max(deviation, 1e-6)))
        return self._by_distance(attempt, segment, found.radius, h)

    def _by_distance(self, attempt: Attempt, segment: Segment, radius: float, longest: float) -> float:
        """The edge wants to go beyond ``radius`` within ``longest``: find when it passes there."""
        a0 = self.surface.radius
        h = attempt.duration_to(radius, longest, self.reach)
        if h is not None and h > 0.0:
            probe = radius + 1e-2 * (radius - a0)
            onwards = attempt.residual(h, probe, self.reach) if probe > self._lowest() else 0.0
            if onwards * (radius - a0) >= 0.0:
                surface = attempt.surface_at(h, radius)
                self._commit(self.time + h, surface, surface.force(self.body))
                if radius == 0.0:
                    self._lost()
                return 1.5 * h
        self.counters.rejected_steps += 1
        if abs(radius - a0) > FOLD * self.largest_travel:
            self._travel = 0.5 * abs(radius - a0)
        else:
            self._snap(attempt, radius > a0)
        return longest

    def _jump(self, segment: Segment) -> None:
        """The load jumps: glassy answer at fixed time."""
        attempt = self._attempt(segment, Curvature(), 0.0)
        a0 = self.surface.radius
        found = attempt.edge(0.0, a0, self.reach, self._lowest(), self._far(a0))
        if not found.reached:
            self._lost()
            return
        surface = attempt.surface_at(0.0, found.radius)
        self._commit(self.time, surface, surface.force(self.body))
        self._path.clear()

    def _snap(self, attempt: Attempt, outward: bool) -> None:
        """No stable edge nearby: the edge runs at fixed time to the next one, or contact is lost."""
        a0 = self.surface.radius
        kind = "snap-in" if outward else "pull-off"
        self.events.append(Event(kind, self.time, self.surface.penetration, self.force, a0))
        limit = self._far(a0) if outward else min(SHORTEST * self.reach, a0)
        stride = self.largest_travel if outward else -self.largest_travel
        radius, found = a0, None
        before = None
        while found is None and radius != limit:
            radius = min(radius + stride, limit) if outward else max(radius + stride, limit)
            value = attempt.residual(0.0, radius, self.reach)
            stable_side = value >= 0.0 if outward else value <= 0.0
            if before is not None and stable_side:
                found = attempt.between(0.0, before, radius, self.reach)
            before = radius
        if found is None:
            self.events.pop()
            self._lost()
            return
        surface = attempt.surface_at(0.0, found)
        self._commit(self.time, surface, surface.force(self.body))
        self._path.clear()
        self._travel = self.largest_travel

    def _lost(self) -> None:
        """Contact ends here; the last row is the free surface."""
        self.events.append(
            Event("pull-off", self.time, self.surface.penetration, self.force, self.surface.radius)
        )
        self.outcome = Outcome(OutcomeKind.DETACHED, "no stable contact is left", self.time)

    def _attempt(self, segment: Segment, curvature: Curvature, travel: float) -> Attempt:
        times = self.body.rheology.times
        ratio = 1.0 - 6.0 / max(self.options.divisions, 8.0)

        def marks(duration: float) -> Array:
            if not len(times) or duration <= 0.0 or travel == 0.0:
                return np.empty(0)
            smallest = max(0.15 * float(times[0]) / duration, LAYER * self.reach / travel, 1e-9)
            count = int(math.log(min(smallest, 1.0)) / math.log(ratio))
            return np.asarray(1.0 - ratio ** np.arange(1, count + 1), float)

        return Attempt(
            self.body,
            self.law,
            self.surface,
            segment,
            self.time,
            curvature,
            marks,
            self.counters,
            self.scene.indenter.edge,
        )

    def _lowest(self) -> float:
        """Smallest radius the law is defined for."""
        return self.reach * (1.0 + 1e-9) if isinstance(self.law, Griffith) else 0.0

    def _far(self, radius: float) -> float:
        return min(self.scene.indenter.edge, 1e3 * max(radius, self.radius_scale))

    def _curvature(self) -> tuple[Curvature, float]:
        """Second derivatives from the last three rows, and the rate of the radius at the present time."""
        if len(self._path) < 2:
            return Curvature(), 0.0
        (t1, a1, _, d1), (t2, a2, _, d2) = self._path[-2:]
        rate = (a2 - a1) / (t2 - t1)
        if len(self._path) < 3:
            return Curvature(), rate
        t0, a0, _, d0 = self._path[-3]
        second = 2.0 / (t2 - t0)
        bend = second * (rate - (a1 - a0) / (t1 - t0))
        sag = second * ((d2 - d1) / (t2 - t1) - (d1 - d0) / (t1 - t0))
        return Curvature(bend, sag), rate + 0.5 * bend * (t2 - t1)

    def _deviation(self, h: float, radius: float, force: float, depth: float) -> float:
        """Distance of the new row from the straight continuation, over what is allowed."""
        if len(self._path) < 2:
            return 0.0
        (t1, a1, f1, _), (t2, a2, f2, _) = self._path[-2:]
        share = 0.25 * h / (h + t2 - t1)  # of the gap to the extrapolation: the sag within the step
        radius_gap = abs(radius - a2 - (a2 - a1) / (t2 - t1) * h) / self.radius_scale
        force_gap = abs(force - f2 - (f2 - f1) / (t2 - t1) * h) / max(self._force_scale, abs(force))
        return share * max(radius_gap, force_gap) / self.options.deviation

    def _commit(self, time: float, surface: Surface, force: float) -> None:
        self.counters.steps += 1
        self.counters.history_updates += len(surface.inside) + len(surface.outside)
        if self.counters.steps % THIN_EVERY == 0:
            surface = thinned(surface, 0.01 * self.options.deviation)
        self.time, self.surface, self.force = time, surface, force
        self._commit_row()

    def _commit_row(self) -> None:
        self._force_scale = max(self._force_scale, abs(self.force))
        self.radius_scale = max(self.radius_scale, self.surface.radius)
        self.record.add(self.time, self.surface, self.force)
        self._path.append((self.time, self.surface.radius, self.force, self.surface.penetration))
        del self._path[:-3]
