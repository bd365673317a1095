"""The command ``crosscontact stability``, and the same within a report."""

from __future__ import annotations

import sys
import time
from collections.abc import Collection
from pathlib import Path

from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.solvers import SOLVERS
from validation.stability.limits import limits
from validation.stability.matrix import cases
from validation.stability.runner import StabilityMatrix, run
from validation.stability.verdict import Cell

KEPT_EVERY = 2.0  # seconds between two times that the cells so far are written


def stability(out: str | None, jobs: int, solver: str | None, only: str | None, fresh: bool = False) -> int:
    """Run the matrix; exit code 1 if a cell is silently wrong, not finite, crashed or hung."""
    from validation.execution.files import output_folder
    from validation.report.write import write_matrix

    folder = None if out is None else output_folder(out)
    store = Store(folder, fresh)
    matrix = compute(jobs, store, (solver,) if solver else SOLVERS, only, folder)
    for line in limits(matrix.cells):
        print(line)
    if folder is not None:
        write_matrix(matrix, folder)
        store.clear()
        print(f"written to {folder / 'index.html'}")
    for cell in matrix.faults:
        print(f"failed: {cell.name}: {cell.verdict}", file=sys.stderr)
    return 1 if matrix.faults else 0


def compute(
    jobs: int,
    store: Store | None = None,
    solvers: Collection[str] = SOLVERS,
    only: str | None = None,
    folder: Path | None = None,
) -> StabilityMatrix:
    """The matrix, told as it goes on; with a folder the cells so far are always to be found there."""
    from validation.report.write import write_cells

    asked = cases(only)
    progress, due = Progress("stability"), time.monotonic()
    total = len(asked) * len(solvers)

    def tell(cell: Cell, cells: list[Cell]) -> None:
        nonlocal due
        progress(
            len(cells) / total, f"{len(cells)}/{total} {cell.name}: {cell.verdict}, {cell.seconds:.1f} s"
        )
        if folder is not None and time.monotonic() >= due:
            write_cells(StabilityMatrix(tuple(cells), 0.0), folder, complete=False)
            due = time.monotonic() + KEPT_EVERY

    try:
        return run(asked, jobs, solvers, tell, store=store)
    finally:
        progress.close()
