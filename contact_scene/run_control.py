"""How a run is taken through its loading, monitored, stopped and continued. No numerical method.

A solver owns its numerical state. Shared is what has nothing to do with numbers: the position in the loading,
the times a run has to step onto, the step budget, the interruption from outside and the envelope in which a
state is kept. None of it chooses a step size or looks at a solution.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike
from threadpoolctl import ThreadpoolController

from contact_scene.errors import SceneError, number
from contact_scene.loading import Loading
from contact_scene.segment import Segment
from contact_scene.trace import Counters, Outcome, OutcomeKind
from contact_scene.trigger import passed

MAX_STEPS = 200_000
"""Trial steps, accepted and rejected together, that a run may take where its options name no other number."""

_EQUAL_TENSION = 1e-9
"""Difference, relative to the largest tension, below which two tensions are the same."""


class RunMonitor(Protocol):
    """Monitors a run from outside: saves its state, stops it, has it continued.

    It is called between two trial steps, and between the stages of a long set-up, where nothing is half done.
    It never changes a number, and a run continued from a saved state gives the bits it would have given
    without the stop.
    """

    @property
    def start_state(self) -> KeptState | None:
        """State to continue from, of the same scene, options and code; ``None`` to start at the beginning."""
        ...

    def continue_set_up(self) -> bool:
        """Whether the run is to continue, between stages of a set-up, where there is no state to keep."""
        ...

    def continue_run(self, state: Callable[[], KeptState]) -> bool:
        """Whether the run is to continue; if not, it ends as interrupted.

        ``state()`` shares the arrays that the run will change: serialise it, or copy it.
        """
        ...


@dataclass(frozen=True)
class KeptState:
    """Envelope of a serialisable run state.

    Parameters
    ----------
    solver : str
        Name of the solver the state belongs to.
    cursor : LoadingCursor
        Where the run stood in its loading.
    counters : Counters
        Work done so far.
    content : object
        The solver's own state, an explicit object of its own package.
    """

    solver: str
    cursor: LoadingCursor
    counters: Counters
    content: Any


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
    """Position of a run in its loading.

    Attributes
    ----------
    step : int
        Load steps that are done.
    origin : tuple of float or None
        Time, penetration and force where the present load step began; ``None`` before it begins.
    jump_done : bool
        Whether the load jump, if any, with which the present load step begins has been taken.
    stops_reached : int
        Stops of the present load step (see :func:`stops_within`) that are behind.
    trigger_side : float or None
        Side of the level of its trigger, if any, on which the present load step is (see ``trigger.passed``);
        ``None`` before it begins.
    """

    step: int = 0
    origin: tuple[float, float, float] | None = None
    jump_done: bool = False
    stops_reached: int = 0
    trigger_side: float | None = None

    @property
    def at_start(self) -> bool:
        """Whether no load step has begun."""
        return self.step == 0 and self.origin is None

    def segment(self, loading: Loading, time: float, penetration: float, force: float) -> Segment:
        """The present load step on the time axis; it begins at the present state unless it has begun before.

        Parameters
        ----------
        loading : Loading
        time, penetration, force : float
            Present state.

        Returns
        -------
        Segment
        """
        if self.origin is None:
            self.origin = (time, penetration, force)
        return loading.segment(loading.steps[self.step], *self.origin)

    def triggered(self, segment: Segment, penetration: float, force: float, radius: float) -> bool:
        """Whether a state has reached the level that ends the present load step.

        The first state asked about is that from which the load step begins.

        Parameters
        ----------
        segment : Segment
            The present load step.
        penetration, force, radius : float
            Of the state.

        Returns
        -------
        bool
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

    def stop_reached(self) -> None:
        """The next stop is reached."""
        self.stops_reached += 1

    def step_done(self) -> None:
        """The present load step is done."""
        self.step, self.origin, self.jump_done, self.stops_reached = self.step + 1, None, False, 0
        self.trigger_side = None

    def share(self, loading: Loading, segment: Segment, time: float) -> float:
        """Share of the loading that is done.

        Parameters
        ----------
        loading : Loading
        segment : Segment
            Of the present load step.
        time : float
            Within it.

        Returns
        -------
        float
            0 to 1.
        """
        length = segment.end - segment.start
        return (self.step + ((time - segment.start) / length if length > 0.0 else 1.0)) / len(loading.steps)


def budget_outcome(counters: Counters, max_steps: int, time: float) -> Outcome | None:
    """The outcome of a run whose budget of trial steps is used up; ``None`` while there is some left.

    Parameters
    ----------
    counters : Counters
        Accepted and rejected steps count.
    max_steps : int
    time : float
        Which the run has come to.

    Returns
    -------
    Outcome or None
    """
    if counters.steps + counters.rejected_steps < max_steps:
        return None
    return Outcome(OutcomeKind.STEP_BUDGET, f"{max_steps} steps were not enough", time)


def below_zone_outcome(force: ArrayLike, time: float) -> Outcome:
    """The outcome of a run whose contact has shrunk to the length of its process zone, where the model ends.

    Parameters
    ----------
    force : array_like, shape (n,)
        Force of all rows, positive in compression.
    time : float
        Where the run ends.

    Returns
    -------
    Outcome
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


def interruption(monitor: RunMonitor | None, state: Callable[[], KeptState], time: float) -> Outcome | None:
    """The outcome of a run that is stopped from outside; ``None`` if it is to go on.

    Parameters
    ----------
    monitor : RunMonitor or None
    state : callable() -> KeptState
        From which the run can be continued.
    time : float
        Which the run has come to.

    Returns
    -------
    Outcome or None
    """
    if monitor is None or monitor.continue_run(state):
        return None
    return Outcome(OutcomeKind.INTERRUPTED, "stopped from outside", time)


def kept_state(monitor: RunMonitor | None, solver: str) -> KeptState | None:
    """The state to continue from, if there is one.

    Raises
    ------
    SceneError
        If it belongs to another solver.
    """
    kept = None if monitor is None else monitor.start_state
    if kept is not None and kept.solver != solver:
        raise SceneError("checkpoint", f"it was kept by {kept.solver}", f"a state of {solver}")
    return kept


def whole_number(value: int, key: str, least: int) -> int:
    """An option that counts something.

    Parameters
    ----------
    value : int
    key : str
        Of the option, for the message.
    least : int
        Smallest number allowed.

    Returns
    -------
    int

    Raises
    ------
    SceneError
        If it is not a whole number, or less than ``least``.
    """
    allowed = f"a whole number >= {least}"
    number(value, key, allowed, low=least)
    if value != int(value):
        raise SceneError(key, f"got {value!r:.40}", allowed)
    return int(value)


def moments(times: Collection[float]) -> tuple[float, ...]:
    """An option of requested times, as floats."""
    return tuple(float(time) for time in times)


class _LinearAlgebraThreads:
    """Runs that are under way in this process, and the limit they share on the threads of BLAS."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.runs = 0
        self.restore: Callable[[], None] | None = None
        self._libraries: tuple[int, ThreadpoolController] | None = None

    def libraries(self) -> ThreadpoolController:
        """Those that are loaded; to look them up takes milliseconds: again only if a module was imported."""
        modules = len(sys.modules)
        if self._libraries is None or self._libraries[0] != modules:
            self._libraries = (modules, ThreadpoolController())
        return self._libraries[1]


_THREADS = _LinearAlgebraThreads()


@contextmanager
def single_threaded() -> Iterator[None]:
    """Limit BLAS to one thread during a run; also a decorator: ``@single_threaded()``.

    The dense systems of a run are small: further threads wait for each other, at several times the processor
    time, and the last bits of a result would depend on their number. The first of several simultaneous runs
    sets the limit, the last one restores what was there.
    """
    with _THREADS.lock:
        if _THREADS.runs == 0:
            _THREADS.restore = _THREADS.libraries().limit(limits=1, user_api="blas").restore_original_limits
        _THREADS.runs += 1
    try:
        yield
    finally:
        with _THREADS.lock:
            _THREADS.runs -= 1
            if _THREADS.runs == 0 and _THREADS.restore is not None:
                _THREADS.restore()
                _THREADS.restore = None
