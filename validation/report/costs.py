"""Where the processor time of a report went: by solver, and the runs that took longest."""

from __future__ import annotations

from collections.abc import Sequence

from validation.execution.runs import Run
from validation.report.text import number

HEAD = ("", "runs", "processor seconds", "of these for error estimates")
LONGEST = 10


def spent(run: Run) -> float:
    """Processor seconds of a run and of the coarser one that judges it."""
    return run.cpu_seconds + run.estimate_seconds


def rows(runs: Sequence[Run]) -> list[tuple[str, ...]]:
    """A line for each solver, one for all, and one for each of the longest runs."""
    solvers = list(dict.fromkeys(run.solver for run in runs))
    found = [_row(solver, [run for run in runs if run.solver == solver]) for solver in solvers]
    found.append(_row("all", runs))
    longest = sorted(runs, key=spent, reverse=True)[:LONGEST]
    return found + [_row(f"{run.scene} by {run.solver}", [run]) for run in longest]


def _row(name: str, runs: Sequence[Run]) -> tuple[str, ...]:
    whole, extra = sum(map(spent, runs)), sum(run.estimate_seconds for run in runs)
    return name, str(len(runs)), number(float(whole), 3), number(float(extra), 3)
