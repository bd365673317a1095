"""``crosscontact stability``: the matrix of stiff and extreme cases, and the same within a report."""

from __future__ import annotations

import argparse
from collections.abc import Collection

from crosscontact import arguments
from crosscontact.commands import shared
from crosscontact.commands.shared import value
from validation.runs.progress import Progress
from validation.runs.store import Store
from validation.solvers import SOLVERS
from validation.stability import matrix, page
from validation.stability.cases import AXES, cases
from validation.stability.matrix import StabilityMatrix

OPTIONS = {
    "--out": value("DIR", "write page, Markdown, JSON and heat maps there"),
    **shared.solver("this one only; default: all"),
    "--only": value("AXIS", "this axis only: one of %(choices)s", choices=tuple(AXES)),
    **shared.jobs(),
    **shared.FRESH,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Run the matrix, print where each solver holds; 1 if a cell is wrong, crashed or hung."""
    if not options.solver:
        arguments.usable()  # names those that cannot be loaded
    solvers = (options.solver,) if options.solver else SOLVERS
    with shared.long_work("stability", options, "a stability matrix") as work:
        found = compute(jobs, work.store, solvers, options.only)
        print("\n".join(page.limits(found.cells)))
        work.write(lambda folder, writing: page.write(found, folder))
    return shared.failed([f"failed: {cell.name}: {cell.verdict}" for cell in found.faults])


def compute(
    jobs: int, store: Store | None = None, solvers: Collection[str] = SOLVERS, only: str | None = None
) -> StabilityMatrix:
    """Run the matrix with progress."""
    with Progress("stability", "runs") as progress:
        return matrix.run(cases(only), jobs, solvers, progress, store=store)
