"""What a run is expected to cost, where that is much, and what makes its answer doubtful; said on stderr."""

from __future__ import annotations

import sys
from collections.abc import Iterable

from contact_scene import Scene, SceneError
from validation.execution.files import in_words
from validation.execution.progress import duration
from validation.solvers import Cost, Solver
from validation.solvers.cost import ESTIMATE_SHARE

LONG = 10.0
"""Seconds of processor time from which an expected cost is said: what a user waits for without a word."""
LARGE = 1e9
"""Bytes of memory from which it is said however short the run: what other programs of a machine may lack."""


def expected_cost(scene: Scene, method: Solver, resolution: int | None) -> Cost | None:
    """The solver's forecast; ``None`` for a scene that it refuses, as its run will say."""
    try:
        return method.expected_cost(scene, resolution)
    except SceneError:
        return None


def announce(cost: Cost | None, estimate: bool = False, more_seconds: float = 0.0, more: str = "") -> None:
    """Say on stderr what a run is expected to cost, if it is long or takes much memory.

    Parameters
    ----------
    cost : Cost or None
        Of the run.
    estimate : bool
        Whether a coarser run follows.
    more_seconds : float
        Of work after the run (s).
    more : str
        What that work makes, in words.
    """
    if cost is None:
        return
    seconds = cost.seconds * (1.0 + ESTIMATE_SHARE * estimate) + more_seconds
    if seconds <= LONG and cost.bytes <= LARGE:
        return
    parts = [f"about {cost.steps:.2g} steps", duration(seconds), f"{in_words(cost.bytes)} of memory"]
    words = ", ".join([*parts, more] if more else parts).replace("e+0", "e")
    print(f"crosscontact: expected: {words}", file=sys.stderr)


def warn(warnings: Iterable[str]) -> None:
    """Say what makes an answer doubtful, one line each."""
    for warning in warnings:
        print(f"crosscontact: warning: {warning}", file=sys.stderr)
