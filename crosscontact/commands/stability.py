"""``crosscontact stability``: the matrix of stiff and extreme cases, and the same within a report."""

from __future__ import annotations

import argparse
import time
from collections.abc import Collection
from pathlib import Path

from crosscontact import arguments
from crosscontact.commands import shared
from validation.runs.folder import claim, output_folder
from validation.runs.progress import Progress
from validation.runs.store import Store
from validation.solvers import SOLVERS
from validation.stability import page, runner
from validation.stability.limits import limits
from validation.stability.matrix import AXES, cases
from validation.stability.runner import StabilityMatrix
from validation.stability.verdict import Cell

WRITE_INTERVAL = 2.0
"""Seconds between two times that the cells so far are written."""


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Solver and axis, if not all."""
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and heat maps there")
    shared.solver_option(command, "this one only; default: all")
    command.add_argument(
        "--only", choices=tuple(AXES), metavar="AXIS", help="this axis only: one of %(choices)s"
    )
    shared.run_options(command)


def run(options: argparse.Namespace, jobs: int) -> int:
    """Run the matrix, print where each solver holds; 1 if a cell is wrong, not finite, crashed or hung."""
    if not options.solver:
        arguments.usable()  # names those that cannot be loaded
    folder = None if options.out is None else output_folder(options.out)
    if folder is not None:
        claim(folder, "a stability matrix", {}, fresh=options.fresh)
    store = Store(folder, options.fresh)
    with shared.telling_what_is_kept(folder, store):
        matrix = compute(jobs, store, (options.solver,) if options.solver else SOLVERS, options.only, folder)
    for line in limits(matrix.cells):
        print(line)
    if folder is not None:
        with Progress("stability") as writing:
            writing.phase("drawing and writing")
            page.write(matrix, folder)
        store.clear()
        print(f"written to {folder / 'index.html'}")
    return shared.failed([f"failed: {cell.name}: {cell.verdict}" for cell in matrix.faults])


def compute(
    jobs: int,
    store: Store | None = None,
    solvers: Collection[str] = SOLVERS,
    only: str | None = None,
    folder: Path | None = None,
) -> StabilityMatrix:
    """Run the matrix with progress; the cells so far are written to ``folder``, if there is one."""
    selected, due = cases(only), time.monotonic()
    total = len(selected) * len(solvers)

    def on_cell(cell: Cell, cells: list[Cell]) -> None:
        nonlocal due
        progress(
            len(cells) / total, f"{len(cells)}/{total} {cell.name}: {cell.verdict}, {cell.seconds:.1f} s"
        )
        if folder is not None and time.monotonic() >= due:
            page.write_cells(cells, folder)
            due = time.monotonic() + WRITE_INTERVAL

    with Progress("stability") as progress:
        progress.phase("runs")
        return runner.run(selected, jobs, solvers, on_cell, store=store)
