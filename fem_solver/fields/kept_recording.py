"""The recorded history of a run, kept and taken up again with the state of the run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from numpy.typing import NDArray

from contact_scene import KeptState, RunMonitor
from fem_solver.condensed import CondensedState
from fem_solver.fields.history import HistoryLog, VolumeContent
from fem_solver.following.state import FollowingState
from fem_solver.quadrature_state import QuadratureState
from fem_solver.recorder import SurfaceState


@dataclass(frozen=True)
class RecordedContent:
    """Serialisable state of a run and what it has recorded.

    Parameters
    ----------
    run : object
        The run's own state.
    log : list of (float, ndarray), VolumeContent or list of FollowingState
        What a log of the run's kind holds (see ``history``).
    surfaces : list of SurfaceState
    states : dict of float to CondensedState, QuadratureState or FollowingState
    rows : dict of float to int
        As of :class:`~fem_solver.fields.recording.Recording`.
    """

    run: Any
    log: list[tuple[float, NDArray[Any]]] | VolumeContent | list[FollowingState]
    surfaces: list[SurfaceState]
    states: dict[float, CondensedState | QuadratureState | FollowingState]
    rows: dict[float, int]


class RecordingMonitor:
    """Passes a run on to its monitor together with what is recorded of it.

    Parameters
    ----------
    monitor : RunMonitor
        Keeps and gives states whose content is a :class:`RecordedContent`.
    log : SurfaceLog, VolumeLog or FollowingLog
    surfaces : list of SurfaceState
    states : dict of float to CondensedState, QuadratureState or FollowingState
    rows : dict of float to int
        Filled with what was recorded before, and recorded to.
    """

    def __init__(
        self,
        monitor: RunMonitor,
        log: HistoryLog,
        surfaces: list[SurfaceState],
        states: dict[float, CondensedState | QuadratureState | FollowingState],
        rows: dict[float, int],
    ) -> None:
        self._monitor, self._log, self._surfaces = monitor, log, surfaces
        self._states, self._rows = states, rows
        self.start_state = self._taken_up(monitor.start_state)

    def _taken_up(self, kept: KeptState | None) -> KeptState | None:
        if kept is None:
            return None
        content: RecordedContent = kept.content
        self._log.restore(content.log)  # type: ignore[arg-type] # a run keeps what its own kind of log holds
        self._surfaces.extend(content.surfaces)
        self._states.update(content.states)
        self._rows.update(content.rows)
        return replace(kept, content=content.run)

    def continue_set_up(self) -> bool:
        """As of the monitor."""
        return self._monitor.continue_set_up()

    def continue_run(self, state: Callable[[], KeptState]) -> bool:
        """As of the monitor."""

        def with_recording() -> KeptState:
            kept = state()
            recorded = self._log.content, self._surfaces, self._states, self._rows
            return replace(kept, content=RecordedContent(kept.content, *recorded))

        return self._monitor.continue_run(with_recording)
