"""How a run is stopped from outside, between two steps."""

from __future__ import annotations

from collections.abc import Callable

from contact_scene.trace import Outcome, OutcomeKind

RunMonitor = Callable[[], bool]
"""Asked between two trial steps whether the run is to continue; it changes no number."""


def interruption(monitor: RunMonitor | None, time: float) -> Outcome | None:
    """The outcome of a run that is stopped from outside at a time; ``None`` if it goes on."""
    if monitor is None or monitor():
        return None
    return Outcome(OutcomeKind.INTERRUPTED, "stopped from outside", time)
