"""How a run is controlled, alike for all solvers: where in its loading it is, how it is watched, how it ends.

No numerical method: which step to take, and what a step does, is the solver's own.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import ThreadpoolController

from contact_scene.loading import Loading, Segment, Trigger, passed
from contact_scene.scene import THINNEST, Layer
from contact_scene.trace import Counters, Outcome, OutcomeKind
from contact_scene.value_checks import number, whole_from

MAX_STEPS = 200_000
"""Trial steps, accepted and rejected together, that a run may take where its options name no other number."""
_SURFACE = 16.0 * np.finfo(float).eps
"""Penetration, relative to the largest of a run, up to which an indenter only touches."""
_EQUAL_TENSION = 1e-9
"""Difference, relative to the largest tension, below which two tensions are the same."""

RunMonitor = Callable[[], bool]
"""Asked between two trial steps whether the run is to continue; it changes no number."""


def whole_number(value: int, key: str, least: int) -> int:
    """An option that counts something, ``least`` or more."""
    return whole_from(least)(value, key)


def moments(times: Collection[float], key: str) -> tuple[float, ...]:
    """An option of requested times."""
    return tuple(number(time, key, "finite times") for time in times)


def installed_memory() -> int | None:
    """Bytes of memory of the machine; ``None`` where the system does not say."""
    if not hasattr(os, "sysconf") or "SC_PHYS_PAGES" not in os.sysconf_names:
        return None
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


# Where a run is in its loading


@dataclass(frozen=True)
class Stop:
    """A time inside or at the end of a load step that the run steps onto exactly.

    ``kink``: the rate of the load jumps there, or the load step ends. ``requested``: a time of
    ``stop_times`` or ``profile_times``.
    """

    time: float
    kink: bool
    requested: bool


def stops_within(segment: Segment, requested: Collection[float]) -> tuple[Stop, ...]:
    """Kinks of a load step, requested times strictly inside it, and its end, merged and ascending."""
    kinks = {*segment.kinks, segment.end}
    inside = {time for time in requested if segment.start < time < segment.end}
    return tuple(Stop(time, time in kinks, time in requested) for time in sorted(kinks | inside))


@dataclass
class LoadingCursor:
    """Position of a run in its loading: ``step`` load steps are done.

    ``trigger_side`` is the side of the level of its trigger, if any, on which the present load step is (see
    :func:`contact_scene.loading.passed`); ``None`` before it begins.
    """

    step: int = 0
    trigger_side: float | None = None

    def segment(self, loading: Loading, time: float, penetration: float, force: float) -> Segment:
        """The present load step on the time axis; it begins at the given state."""
        return loading.segment(loading.steps[self.step], time, penetration, force)

    def triggered(self, segment: Segment, penetration: float, force: float, radius: float) -> bool:
        """Whether a state has reached the level that ends the present load step.

        The first state asked about is that from which the load step begins.
        """
        if segment.trigger is None:
            return False
        excess = segment.trigger.excess(penetration, force, radius)
        if self.trigger_side is None:
            self.trigger_side = segment.trigger.side(excess)
        return passed(self.trigger_side, excess)

    def done(self, loading: Loading) -> bool:
        """Whether all load steps are done."""
        return self.step >= len(loading.steps)

    def level_reached(self) -> None:
        """The level that ends the present load step is reached, whatever rounding says."""
        self.trigger_side = 0.0

    def step_done(self) -> None:
        """The present load step is done."""
        self.step, self.trigger_side = self.step + 1, None

    def share(self, loading: Loading, segment: Segment, time: float) -> float:
        """Share of the loading that is done, 0 to 1, at a time within the present load step."""
        length = segment.end - segment.start
        return (self.step + ((time - segment.start) / length if length > 0.0 else 1.0)) / len(loading.steps)


# The walk over the loading

_ENDS_OF_CONTACT = (OutcomeKind.DETACHED, OutcomeKind.BELOW_ZONE)


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


def intervals(
    segment: Segment, penetration: float, force: float, requested: Collection[float]
) -> Iterator[LoadingInterval]:
    """The intervals of a load step that begins at a penetration and a force, its load jump first."""
    before, after = segment.present(penetration, force), segment.value(segment.start)
    made = partial(LoadingInterval, segment.control, rate=segment.rate, trigger=segment.trigger)
    if after != before:
        jump = segment.start, segment.start, lambda share: before + share * (after - before)
        yield made(*jump, jump=True, after_kink=True)
    start, kink = segment.start, True
    for stop in stops_within(segment, requested):
        if stop.time > start:
            yield made(start, stop.time, segment.value, jump=False, after_kink=kink)
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
    """Take a run through the loading."""
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


# How a run ends before its loading does


def interruption(monitor: RunMonitor | None, time: float) -> Outcome | None:
    """The outcome of a run that is stopped from outside at a time; ``None`` if it goes on."""
    if monitor is None or monitor():
        return None
    return Outcome(OutcomeKind.INTERRUPTED, "stopped from outside", time)


def budget_outcome(counters: Counters, max_steps: int, time: float) -> Outcome | None:
    """The outcome of a run whose budget of trial steps is used up; ``None`` while there is some left."""
    if counters.steps + counters.rejected_steps < max_steps:
        return None
    return Outcome(OutcomeKind.STEP_BUDGET, f"{max_steps} steps were not enough", time)


def outgrown_outcome(body: Layer | None, radius: float, time: float) -> Outcome | None:
    """The outcome of a run whose contact has become too large for its layer; ``None`` while it is not."""
    if body is None or radius <= body.largest_contact:
        return None
    reason = f"the contact has become wider than {THINNEST:g} thicknesses of the layer: no more is computed"
    return Outcome(OutcomeKind.OUT_OF_RANGE, reason, time)


def below_zone_outcome(force: ArrayLike, time: float) -> Outcome:
    """The outcome of a run whose contact has shrunk to the length of its process zone, where the model ends.

    ``past_extremum`` where the largest tension lies before the last row; that with which a run begins and
    which only falls is no extremum.
    """
    tension = -np.asarray(force, float)
    rises = np.flatnonzero(np.diff(tension) > 0.0)
    largest = float(tension[rises[0] :].max(initial=0.0)) if rises.size else 0.0
    past = largest > 0.0 and float(tension[-1]) < largest * (1.0 - _EQUAL_TENSION)
    remark = "after" if past else "before"
    reason = f"the contact has shrunk to its process zone, {remark} the largest tension"
    return Outcome(OutcomeKind.BELOW_ZONE, reason, time, past)


def outcome_of_loss(
    outcome: Outcome, is_adhesive: bool, penetration: ArrayLike, contact_radius: ArrayLike
) -> Outcome:
    """The outcome of a run; a breakdown if it lost a contact that, without adhesion, cannot have been lost.

    Contact may be lost at a positive penetration, for a surface recovers more slowly than an indenter leaves
    it. But where the indenter is as deep as it has ever been, ``D(s) <= D(t) = w``, the point below it bears

        q = E(t) w + int_0^t [-E'(t - s)] (w - D(s)) ds > 0

    with any relaxation modulus, and a load that bears is not lost. Rows after the loss have no radius.
    """
    depth, touching = np.asarray(penetration, float), np.flatnonzero(np.asarray(contact_radius, float) > 0.0)
    if is_adhesive or outcome.kind is not OutcomeKind.DETACHED or not touching.size:
        return outcome
    last = int(touching[-1])
    lost = float(depth[last:].min())
    if lost < float(depth[: last + 1].max()) or lost <= _SURFACE * float(np.abs(depth).max()):
        return outcome
    reason = f"without adhesion, contact was lost at the largest penetration so far, {lost:.6g}"
    return Outcome(OutcomeKind.BREAKDOWN, reason, outcome.time)


# One thread of the linear algebra


class _Threads:
    """The limit on the threads of BLAS that the runs under way in this process share."""

    lock = threading.Lock()
    runs = 0
    limit: Any = None
    modules, libraries = 0, None

    @classmethod
    def limited(cls) -> Any:
        """One thread; to look libraries up takes milliseconds: again only if a module was imported."""
        if cls.libraries is None or cls.modules != len(sys.modules):
            cls.modules, cls.libraries = len(sys.modules), ThreadpoolController()
        return cls.libraries.limit(limits=1, user_api="blas")


@contextmanager
def single_threaded() -> Iterator[None]:
    """Limit BLAS to one thread during a run; also a decorator: ``@single_threaded()``.

    The dense systems of a run are small: further threads wait for each other, at several times the processor
    time, and the last bits of a result would depend on their number. The first of several simultaneous runs
    sets the limit, the last one restores what was there.
    """
    with _Threads.lock:
        _Threads.limit = _Threads.limit or _Threads.limited()
        _Threads.runs += 1
    try:
        yield
    finally:
        with _Threads.lock:
            _Threads.runs -= 1
            if _Threads.runs == 0:
                _Threads.limit.restore_original_limits()
                _Threads.limit = None
