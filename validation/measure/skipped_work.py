"""What a solver left out because the scene did not need it: counters of work that remained at zero."""

from __future__ import annotations

from collections.abc import Mapping

from validation.solvers import SOLVERS
from validation.solvers.base import SKIPPED_WORK


def left_out(scheme: str, counters: Mapping[str, float | None]) -> list[str]:
    """The parts of its work that a solver or scheme left out, in words; none if a counter is not known."""
    meanings = SOLVERS[scheme].skipped_work if scheme in SOLVERS else SKIPPED_WORK
    return [text for name, text in meanings.items() if counters.get(name) == 0]


def in_words(work: Mapping[str, Mapping[str, float | None]]) -> str:
    """A sentence on all solvers of a scene, ``work`` being their counters by name."""
    skipped = [f"{name}: {', '.join(parts)}" for name, c in work.items() if (parts := left_out(name, c))]
    if not skipped:
        return "Nothing was left out: by its counters every solver did all kinds of its work."
    return f"Left out because the scene did not need it, by the counters: {'; '.join(skipped)}."
