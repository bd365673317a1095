"""The smooth intervals of a load step, and the walk through all of them.

Intervals end at kinks, at requested times and with the load step; a load jump is an interval of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Protocol

from contact_scene import Outcome, OutcomeKind, Segment, Trigger
from contact_scene.loading import Loading
from contact_scene.run_control import LoadingCursor, stops_within

_ENDS_OF_CONTACT = (OutcomeKind.DETACHED, OutcomeKind.BELOW_ZONE)
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
_ROUNDINGS = 4.0
"""Last places by which a prescribed value may miss its chord by rounding: as many operations make it."""


@dataclass(frozen=True)
class LoadingInterval:
    """A smooth part of a load step, followed with a parameter from 0 to ``length``.

    Usually the parameter is time since ``start``; for a load jump it is the share of the jump, and time
    stands still. ``after_kink``: rates from before ``start`` say nothing about those after it. ``trigger``
    may end the load step within it.
    """

    control: str
    start: float
    end: float
    value: Callable[[float], float]
    rate: Callable[[float], float]
    jump: bool
    after_kink: bool
    trigger: Trigger | None = None

    @property
    def length(self) -> float:
        """Extent of the parameter."""
        return 1.0 if self.jump else self.end - self.start

    def time(self, parameter: float) -> float:
        """Time at a parameter; the end exactly."""
        if self.jump or parameter >= self.length:
            return self.end
        return self.start + parameter

    def prescribed(self, parameter: float) -> float:
        """Penetration, force or stage at a parameter."""
        return self.value(parameter if self.jump else self.time(parameter))

    @cached_property
    def span(self) -> float:
        """By how much the prescribed quantity varies over the interval."""
        values = [self.prescribed(self.length * (k * _GOLDEN % 1.0)) for k in range(32)]
        values.append(self.prescribed(self.length))
        return max(values) - min(values)

    def departure_from_chord(self, parameter: float, step: float) -> float:
        """Largest departure of the prescribed quantity from its chord over a step, in spans.

        Sampled at irrational shares of the step, where an oscillation has no equal phases: whole periods are
        not stepped over. What rounding makes is no departure: a load jump may be no more than that.
        """
        if self.span == 0.0:
            return 0.0
        first, last = self.prescribed(parameter), self.prescribed(parameter + step)
        departure = max(
            abs(self.prescribed(parameter + share * step) - first - share * (last - first))
            for share in (math.sqrt(2.0) - 1.0, _GOLDEN, math.e - 2.0)
        )
        rounding = _ROUNDINGS * math.ulp(max(abs(first), abs(last)))
        return max(departure - rounding, 0.0) / self.span


def intervals(
    segment: Segment, penetration: float, force: float, requested: Collection[float]
) -> Iterator[LoadingInterval]:
    """The intervals of a load step that begins at a penetration and a force, its load jump first."""
    before, after = segment.present(penetration, force), segment.value(segment.start)
    if after != before:
        yield LoadingInterval(
            segment.control,
            segment.start,
            segment.start,
            lambda share: before + share * (after - before),
            segment.rate,
            jump=True,
            after_kink=True,
            trigger=segment.trigger,
        )
    start, kink = segment.start, True
    for stop in stops_within(segment, requested):
        if stop.time > start:
            yield LoadingInterval(
                segment.control,
                start,
                stop.time,
                segment.value,
                segment.rate,
                jump=False,
                after_kink=kink,
                trigger=segment.trigger,
            )
        start, kink = stop.time, stop.kink


class IntervalFollower(Protocol):
    """A run that can be taken through one interval of the loading after the other."""

    def reached(self) -> tuple[float, float, float]:
        """Time, penetration and force of the committed state."""
        ...

    def reached_radius(self) -> float:
        """Contact radius of the committed state."""
        ...

    def follow(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """Go through an interval, reporting times reached; an outcome if the run ends within it."""
        ...

    def record_profile(self) -> None:
        """Record the surface in the committed state."""
        ...


def follow_loading(
    run: IntervalFollower,
    loading: Loading,
    cursor: LoadingCursor,
    stop_times: Collection[float],
    profile_times: Collection[float],
    progress: Callable[[float], None] | None,
) -> Outcome:
    """Take a run through the loading.

    Parameters
    ----------
    run : IntervalFollower
    loading : Loading
    cursor : LoadingCursor
        Advanced with the run.
    stop_times, profile_times : collection of float
        Times stepped onto exactly; at the latter the surface is recorded.
    progress : callable or None
        Called with the share of the loading that is done, 0 to 1.

    Returns
    -------
    Outcome
    """
    requested = {*stop_times, *profile_times}
    if 0.0 in profile_times:
        run.record_profile()
    while not cursor.done(loading):
        time, penetration, force = run.reached()
        segment = cursor.segment(loading, time, penetration, force)
        report = partial(_report, progress, cursor, loading, segment)
        for interval in intervals(segment, penetration, force, requested):
            if _level_reached(run, cursor, segment):
                break
            outcome = run.follow(interval, report)
            if run.reached()[0] in profile_times and (outcome is None or outcome.kind in _ENDS_OF_CONTACT):
                run.record_profile()
            if outcome is not None:
                return outcome
        if segment.trigger is not None and not _level_reached(run, cursor, segment):
            return segment.trigger.not_reached(run.reached()[0])
        cursor.step_done()
    return Outcome(OutcomeKind.COMPLETED, "all loading steps done", run.reached()[0])


def _level_reached(run: IntervalFollower, cursor: LoadingCursor, segment: Segment) -> bool:
    """Whether the run has reached the level that ends the load step."""
    _, penetration, force = run.reached()
    return cursor.triggered(segment, penetration, force, run.reached_radius())


def _report(
    progress: Callable[[float], None] | None,
    cursor: LoadingCursor,
    loading: Loading,
    segment: Segment,
    time: float,
) -> None:
    if progress is not None:
        progress(cursor.share(loading, segment, time))
