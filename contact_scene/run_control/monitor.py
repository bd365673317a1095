"""How a run is monitored from outside, stopped and continued: the envelope in which its state is kept.

A solver owns its numerical state; nothing here looks at it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from contact_scene.errors import SceneError
from contact_scene.run_control.loading_cursor import LoadingCursor
from contact_scene.trace import Counters, Outcome, OutcomeKind


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
