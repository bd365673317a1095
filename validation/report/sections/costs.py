"""Where the processor time of a report went: by solver, and the runs that took longest."""

from __future__ import annotations

from collections.abc import Sequence

from validation.execution.run import Run
from validation.report.document import DataTable, Section, number

LONGEST = 10  # runs listed one by one, those that took longest


def section(runs: Sequence[Run]) -> Section:
    """A line for each solver, one for all, and one for each of the longest runs."""
    solvers = dict.fromkeys(run.solver for run in runs)
    rows = [_row(solver, [run for run in runs if run.solver == solver]) for solver in solvers]
    rows.append(_row("all", runs))
    longest = sorted(runs, key=spent, reverse=True)[:LONGEST]
    rows += [_row(f"{run.scene} by {run.solver}", [run]) for run in longest]
    return Section("Where the time went", (DataTable.of(rows),))


def spent(run: Run) -> float:
    """Processor seconds of a run and of the coarser one that estimates its error."""
    return run.cpu_seconds + run.estimate_seconds


def _row(name: str, runs: Sequence[Run]) -> dict[str, str]:
    return {
        "": name,
        "runs": str(len(runs)),
        "processor seconds": number(float(sum(map(spent, runs))), 3),
        "of these for error estimates": number(float(sum(run.estimate_seconds for run in runs)), 3),
    }
