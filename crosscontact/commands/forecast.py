"""What a run is expected to cost, where that is much, and what makes its answer doubtful; said on stderr."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator

from contact_scene import Scene, SceneError
from validation.cases import Case
from validation.execution.files import in_words
from validation.execution.progress import duration
from validation.solvers import SOLVERS, Cost, Solver
from validation.solvers.cost import relative_time

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


def cost_within(max_steps: int | None, cost: Cost | None) -> Cost | None:
    """What of a forecast the user's step budget lets happen; where that is not all, it is said on stderr."""
    if cost is None or max_steps is None or max_steps >= cost.steps:
        return cost
    expected = f"{_about(cost.steps)} steps are expected: the run may end before its loading"
    print(f"crosscontact: --max-steps {max_steps}: {expected}", file=sys.stderr)
    return cost.within(max_steps)


def forecasts(pairs: Iterable[tuple[Case, str]]) -> Iterator[tuple[str, Cost | None]]:
    """What scenes are expected to cost by solvers at their own resolution, with the name of each run."""
    for case, name in pairs:
        yield f"{case.name} by {name}", expected_cost(case.scene, SOLVERS[name], None)


def say_short_runs(max_steps: int | None, runs: Iterable[tuple[str, Cost | None]]) -> None:
    """Say on stderr how many runs, named and with their forecasts, are expected to exceed the user's step
    budget; forecasts are asked for only if there is one."""
    if max_steps is None:
        return
    costs = [(cost.steps, name) for name, cost in runs if cost is not None]
    over = [one for one in costs if one[0] > max_steps]
    if over:
        steps, longest = max(over)
        problem = f"{len(over)} of {len(costs)} runs are expected to take more, up to {_about(steps)} steps"
        words = f"{problem} ({longest}): they may end before their loading"
        print(f"crosscontact: --max-steps {max_steps}: {words}", file=sys.stderr)


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
    seconds = cost.seconds * relative_time(estimate) + more_seconds
    if seconds <= LONG and cost.bytes <= LARGE:
        return
    parts = [f"{_about(cost.steps)} steps", duration(seconds), f"{in_words(cost.bytes)} of memory"]
    print(f"crosscontact: expected: {', '.join([*parts, more] if more else parts)}", file=sys.stderr)


def _about(count: float) -> str:
    """A count to two digits."""
    return f"about {count:.2g}".replace("e+0", "e")


def warn(warnings: Iterable[str]) -> None:
    """Say what makes an answer doubtful, one line each."""
    for warning in warnings:
        print(f"crosscontact: warning: {warning}", file=sys.stderr)
