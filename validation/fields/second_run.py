"""The second run that rows picked from a trace take where the history is in the body: kept, and taken up.

What is kept of it holds the rows, so that it goes on without the first run.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from contact_scene import KeptState, RunMonitor


@dataclass(frozen=True)
class SecondRunContent:
    """Serialisable state of the run.

    Parameters
    ----------
    picked : dict of int to str
        Labels by row.
    run : object
        The run's own state.
    """

    picked: dict[int, str]
    run: Any


class SecondRunMonitor:
    """Passes the run on to its monitor together with the rows that it stores.

    Parameters
    ----------
    monitor : RunMonitor
        Of both runs; what it has kept of the first is not taken up.
    picked : dict of int to str
        Labels by row.
    """

    def __init__(self, monitor: RunMonitor, picked: dict[int, str]) -> None:
        self._monitor, self._picked = monitor, picked
        kept = monitor.start_state
        second = kept is not None and isinstance(kept.content, SecondRunContent)
        self.start_state = replace(kept, content=kept.content.run) if kept is not None and second else None

    def continue_set_up(self) -> bool:
        """As of the monitor."""
        return self._monitor.continue_set_up()

    def continue_run(self, state: Callable[[], KeptState]) -> bool:
        """As of the monitor."""

        def with_rows() -> KeptState:
            kept = state()
            return replace(kept, content=SecondRunContent(self._picked, kept.content))

        return self._monitor.continue_run(with_rows)


def picked_before(monitor: RunMonitor | None) -> dict[int, str]:
    """Rows of a second run that the monitor has kept; none where it has kept the first one, or nothing."""
    kept = None if monitor is None else monitor.start_state
    return kept.content.picked if kept is not None and isinstance(kept.content, SecondRunContent) else {}
