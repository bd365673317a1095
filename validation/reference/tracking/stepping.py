"""The loop: propose a step, judge it, commit it or cut it; kinks of the loading stepped onto."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters, Event, Outcome, OutcomeKind, Scene, Segment
from validation.reference.tracking import instantaneous, limit_points
from validation.reference.tracking.checkpoint import Place
from validation.reference.tracking.coarsening import thinned
from validation.reference.tracking.law import Law, NoTension
from validation.reference.tracking.node_placement import Marks
from validation.reference.tracking.options import Fineness, Options
from validation.reference.tracking.record import Record
from validation.reference.tracking.rounding import few_digits
from validation.reference.tracking.step_error import Judge, judged
from validation.reference.tracking.step_history import FORCE, PENETRATION, RADIUS, Trail
from validation.reference.tracking.surface import Body, Surface
from validation.reference.tracking.trial import Attempt

Array = NDArray[np.float64]

THIN_EVERY = 12
# What dropping a node may cost: times the square of the deviation allowed in a step, lest it fall more slowly
# than the error of a step, which is of fourth order; at most a share of the deviation itself.
THIN_SQUARED, THIN_SHARE = 100.0, 0.1
FLAT = 0.2  # rise of the closure over a process zone, relative: below it a limit point may be near
IN_VAIN = 400  # steps rejected one after the other
FIRST = 100.0  # times the deviation times the shortest time: the step after a kink, which nothing judges


@dataclass
class Run:
    """A run in progress; ``surface`` and ``record`` change only when a step is committed.

    ``straight``: deviations by which rows may leave a straight line, under a linear and under a curved load.
    ``travel``: how far the edge may go in the next step. ``heading``: where it has been going, but for noise.
    """

    scene: Scene
    body: Body
    law: Law
    options: Options
    fineness: Fineness
    surface: Surface
    largest_travel: float
    radius_scale: float
    force_scale: float
    depth_scale: float
    record: Record
    on_profile: Callable[[float, Surface, float], None]
    straight: tuple[float, float]
    progress: Callable[[float], None] | None = None
    goes_on: Callable[[], bool] = lambda: True
    place: Place = field(default_factory=Place)
    time: float = 0.0
    force: float = 0.0
    counters: Counters = field(default_factory=Counters)
    events: list[Event] = field(default_factory=list)
    outcome: Outcome | None = None
    trail: Trail = field(default_factory=Trail)
    travel: float = 0.0
    heading: float = 0.0
    _steepness: float = 0.0
    _seen_at: float = 0.0
    _rejected: int = 0  # when the last step was committed

    def go(self) -> Outcome:
        """Carry out all steps of the loading, from where the run stands in it."""
        place = self.place
        if place.fresh:
            self.force = self.surface.force(self.body)
            self.travel, self._seen_at = self.largest_travel, self.surface.radius
            self._row()
            if 0.0 in self.options.profile_times:
                self.on_profile(0.0, self.surface, self.force)
        steps = self.scene.loading.steps
        while place.step < len(steps):
            origin = place.enter(self.time, self.surface.penetration, self.force)
            segment = steps[place.step].segment(*origin)
            self._segment(segment, lambda done: (place.step + done) / len(steps))
            if self.outcome is not None:
                return self.outcome
            place.leave()
        return Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", self.time)

    def _segment(self, segment: Segment, share: Callable[[float], float]) -> None:
        place = self.place
        if segment.control == "force" and self.surface.radius == 0.0:
            hanging = instantaneous.hangs_free(self, segment)
            if hanging is None:
                self._end(OutcomeKind.DETACHED, "pulled without contact")
                return
            segment = hanging
        if not place.begun:
            self._set_out(segment)
        if self.outcome is not None:
            return
        kinks = {segment.end, *segment.kinks}
        stops = sorted(
            kinks
            | {
                t
                for t in (*self.options.stop_times, *self.options.profile_times)
                if segment.start < t < segment.end
            }
        )
        step = place.proposed
        for stop in stops[place.stop :]:
            if self.trail.fresh and not place.under_way:
                step = self._first_step(segment, stop - self.time)
            place.under_way = True
            while self.time < stop and self.outcome is None:
                place.proposed = step
                if not self.goes_on():
                    self._end(OutcomeKind.INTERRUPTED, "stopped from outside")
                    return
                step = self._advance(segment, stop, step)
                if self.progress is not None:
                    self.progress(share((self.time - segment.start) / (segment.end - segment.start)))
            if self.outcome is not None:
                return
            if stop in self.options.profile_times:
                self.on_profile(self.time, self.surface, self.force)
            if stop in kinks:
                self.kink()
            place.next_stop()

    def _set_out(self, segment: Segment) -> None:
        """The jump, if any, with which a loading step begins."""
        self.kink()
        present = self.surface.penetration if segment.control == "penetration" else self.force
        if segment.value(segment.start) != present:
            instantaneous.jump(self, segment)
        self.place.begun = True

    def kink(self) -> None:
        """Rates jump at the present row."""
        self.surface = self.surface.creased()
        self.trail.kink()
        self.record.kink()

    def _first_step(self, segment: Segment, length: float) -> float:
        """The step after a kink, which nothing judges: a small part of every time that may matter."""
        part = FIRST * self.fineness.deviation
        quick = min(part * float(self.body.rheology.times.min(initial=math.inf)), 1e-2 * length)
        scale = self.depth_scale if segment.control == "penetration" else self.force_scale
        rate = abs(segment.rate(self.time))
        if rate > 0.0 and scale > 0.0:
            quick = min(quick, part * scale / rate)
        return max(quick, 1e-12 * length)

    def _advance(self, segment: Segment, stop: float, proposed: float) -> float:
        """One step towards ``stop``; returns the next proposal."""
        if self.counters.steps + self.counters.rejected_steps >= self.options.max_steps:
            self._end(OutcomeKind.STEP_BUDGET, f"{self.options.max_steps} steps are used up")
            return proposed
        if self.counters.rejected_steps - self._rejected >= IN_VAIN:
            self._end(OutcomeKind.STEP_UNDERFLOW, f"no step of {IN_VAIN} could be taken")
            return proposed
        a0, slope = self.surface.radius, self.trail.rate_of_radius()
        left, tick = stop - self.time, 4.0 * math.ulp(self.time)
        h = left if proposed >= 0.999 * left else max(min(proposed, 0.5 * left), tick)
        if abs(slope) * h > 0.95 * self.travel:
            h = 0.9 * self.travel / abs(slope)
        h = self.trail.up_to_turn(h, self.fineness.deviation * self.radius_scale)
        if tick < h < left:
            h = max(few_digits(h, segment.end - segment.start), tick)
        guess = self.trail.course(RADIUS).ahead(h)
        if isinstance(self.law, NoTension) and a0 > 0.0:
            if segment.control == "force" and segment.value(self.time + h) <= 0.0:
                return limit_points.let_go(self, segment, h)
            if segment.control == "penetration" and slope < 0.0 and a0 <= self.largest_travel:
                attempt = self.attempt(segment)
                if attempt.residual(left, 0.0) > 0.0:
                    return limit_points.by_distance(self, attempt, 0.0, left)
        attempt = self.attempt(segment, abs(guess - a0))
        reach = self.travel if a0 > 0.0 else self.radius_scale  # a contact that begins runs
        low, high = max(a0 - self.travel, self.law.lowest), min(a0 + reach, self.scene.indenter.edge)
        found = attempt.edge(h, guess, low, high, self._steepness)
        if found.radius != a0 and slope == 0.0:
            departure = attempt.departure(h)
            if departure is not None and departure > tick:
                self.commit(self.time + departure, attempt.surface_at(departure, a0))
                instantaneous.lands_flat(self, segment)
                self.kink()
                return self._first_step(segment, stop - self.time)
        if not found.reached:
            return limit_points.by_distance(self, attempt, found.radius, h)
        surface = attempt.surface_at(h, found.radius)
        force = surface.force(self.body)
        row = (self.time + h, surface.radius, force, surface.penetration)
        judge = self.judge(segment, surface, force)
        deviation, smooth = judge.in_time(row), True
        near_limit = 0.0 < found.steepness * self.law.reach < FLAT
        if deviation > 1.0 and near_limit and self.trail.heads_for(row, RADIUS):
            along = judge.along_edge(row)
            deviation, smooth = min(deviation, along), deviation <= along
        if deviation > 2.0:
            self.counters.rejected_steps += 1
            if h <= tick:  # a jump, as far as time can tell
                self.commit(self.time + h, surface, force)
                self.kink()
                return self._first_step(segment, stop - self.time)
            return h * max(0.2, 0.9 / math.sqrt(deviation))
        between = judge.parts(row, self.straight[0 if segment.linear else 1]) if smooth else 1
        self.commit(self.time + h if h < left else stop, surface, force, segment, between)
        self.travel = min(self.largest_travel, 2.0 * self.travel)
        self._steepness = found.steepness
        if found.radius == 0.0 < a0:
            self.lost()
        return h * min(2.0, 0.95 / max(deviation, 1e-6) ** (1.0 / 3.0))

    def lost(self, reason: str = "no stable contact is left") -> None:
        """Contact ends here; the last row is the free surface."""
        surface = self.surface
        self.events.append(Event("pull-off", self.time, surface.penetration, self.force, surface.radius))
        self._end(OutcomeKind.DETACHED, reason)
        if self.surface.radius > 0.0:
            self.surface, self.force = self.surface.freed(self.body), 0.0
            self.record.add(self.time, self.surface, self.force)

    def _end(self, kind: OutcomeKind, reason: str) -> None:
        self.outcome = Outcome(kind, reason, self.time)

    def attempt(self, segment: Segment, travel: float = 0.0) -> Attempt:
        """A step from the present state; ``travel`` is expected of its edge."""
        shortest = float(self.body.rheology.times.min(initial=math.inf))
        return Attempt(
            self.body,
            self.law,
            self.surface,
            segment,
            self.time,
            self.trail.course(RADIUS),
            self.trail.course(PENETRATION),
            Marks(shortest, travel, self.law.reach, self.fineness.divisions),
            self.counters,
            self.scene.indenter.edge,
            self.largest_travel,
        )

    def judge(self, segment: Segment, surface: Surface, force: float) -> Judge:
        scales = {
            RADIUS: self.radius_scale,
            FORCE: max(self.force_scale, abs(force)),
            PENETRATION: max(self.depth_scale, abs(surface.penetration)),
        }
        return Judge(self.trail, self.fineness.deviation, judged(segment.control), scales)

    def commit(
        self,
        time: float,
        surface: Surface,
        force: float | None = None,
        segment: Segment | None = None,
        parts: int = 1,
    ) -> None:
        """Make a state the present one; rows in ``parts - 1`` places on the way are left to the record."""
        force = surface.force(self.body) if force is None else force
        self.counters.steps += 1
        self._rejected = self.counters.rejected_steps
        self.counters.history_updates += len(surface.inside) + len(surface.outside)
        if self.counters.steps % THIN_EVERY == 0:
            allowed = self.fineness.deviation
            surface = thinned(surface, allowed * min(THIN_SQUARED * allowed, THIN_SHARE))
        before = self.time
        self.time, self.surface, self.force = float(time), surface, float(force)
        self._row()
        if segment is not None:
            self._between(segment, before, parts)

    def _between(self, segment: Segment, before: float, parts: int) -> None:
        """Rows that make the last step straight, and one where the force has turned."""
        wanted = [(1, before + (self.time - before) * part / parts) for part in range(1, parts)]
        turned = self.trail.turned(FORCE)
        if turned is not None:
            wanted.append((-turned[0], turned[1]))
        prescribed = segment.control == "penetration"
        for back, at in wanted:
            self.record.between(at, segment.value(at) if prescribed else None, back)

    def _row(self) -> None:
        surface = self.surface
        if abs(surface.radius - self._seen_at) > limit_points.FOLD * self.largest_travel:
            self.heading, self._seen_at = surface.radius - self._seen_at, surface.radius
        self.force_scale = max(self.force_scale, abs(self.force))
        self.radius_scale = max(self.radius_scale, surface.radius)
        self.depth_scale = max(self.depth_scale, abs(surface.penetration))
        self.record.add(self.time, surface, self.force)
        self.trail.add((float(self.time), surface.radius, float(self.force), float(surface.penetration)))
