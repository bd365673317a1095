"""``crosscontact stability``: the matrix of stiff and extreme cases, and the same within a report."""

from __future__ import annotations

import sys
import time
from collections.abc import Collection
from pathlib import Path

from crosscontact.commands.interruption import telling_what_is_kept
from validation.execution.files import output_folder
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.report.report_folder import STABILITY, check_report_unused
from validation.report.write import write_cells, write_matrix
from validation.solvers import SOLVERS
from validation.stability import runner
from validation.stability.limits import limits
from validation.stability.matrix import cases
from validation.stability.runner import StabilityMatrix
from validation.stability.verdict import Cell

WRITE_INTERVAL = 2.0
"""Seconds between two times that the cells so far are written."""


def run(out: str | None, jobs: int, solver: str | None, only: str | None, fresh: bool = False) -> int:
    """Run the matrix, print where each solver holds.

    Parameters
    ----------
    out : str or None
        Folder of the report, if one is to be written.
    jobs : int
        Processes.
    solver : str or None
        Name; ``None``: all solvers.
    only : str or None
        One of the axes of the matrix; ``None``: all.
    fresh : bool
        Whether runs stored by an earlier, interrupted command are ignored, and what the folder holds is
        replaced.

    Returns
    -------
    int
        1 if a cell is silently wrong, not finite, crashed or hung.

    Raises
    ------
    SceneError
        If the folder holds results of another command or another program.
    """
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        check_report_unused(folder, STABILITY)
    store = Store(folder, fresh)
    with telling_what_is_kept(folder, store):
        matrix = compute(jobs, store, (solver,) if solver else SOLVERS, only, folder)
    for line in limits(matrix.cells):
        print(line)
    if folder is not None:
        with Progress("stability") as writing:
            writing.phase("drawing and writing")
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
    """Run the matrix with progress.

    Parameters
    ----------
    jobs : int
        Processes.
    store : Store or None
        Finished runs that it holds are not repeated.
    solvers : collection of str
        Names.
    only : str or None
        One of the axes of the matrix; ``None``: all.
    folder : Path or None
        Where the cells so far are written every ``WRITE_INTERVAL``, if anywhere.

    Returns
    -------
    StabilityMatrix
    """
    selected = cases(only)
    progress, due = Progress("stability"), time.monotonic()
    progress.phase("runs")
    total = len(selected) * len(solvers)

    def on_cell(cell: Cell, cells: list[Cell]) -> None:
        nonlocal due
        progress(
            len(cells) / total, f"{len(cells)}/{total} {cell.name}: {cell.verdict}, {cell.seconds:.1f} s"
        )
        if folder is not None and time.monotonic() >= due:
            write_cells(StabilityMatrix(tuple(cells), 0.0), folder, complete=False)
            due = time.monotonic() + WRITE_INTERVAL

    try:
        return runner.run(selected, jobs, solvers, on_cell, store=store)
    finally:
        progress.close()
