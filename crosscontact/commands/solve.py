"""``crosscontact solve``: one solver on one scene."""

from __future__ import annotations

import sys
from pathlib import Path

from crosscontact.key_numbers import aligned, key_numbers, table
from crosscontact.result import Result
from validation import cases
from validation.drawing.export import png, svg_file
from validation.execution.checkpoints import run_with_checkpoints
from validation.execution.files import output_folder, write_whole
from validation.execution.progress import Progress
from validation.execution.run_folder import write_run
from validation.execution.runs import Run
from validation.execution.runs import run as run_solver
from validation.measure.scaling import SCALES_IN_WORDS

DOTS_PER_INCH = 110
"""Resolution of ``force.png``."""


def run(
    name: str,
    solver: str,
    resolution: int | None,
    out: str | None,
    *,
    fresh: bool = False,
    estimate: bool = False,
    plot: bool = False,
) -> int:
    """Run a solver, print the key numbers, write what is asked for.

    With a folder to write to, an interrupted run is saved there and continued by the same command.

    Parameters
    ----------
    name : str
        Scene file or name of a built-in scene.
    solver : str
    resolution : int or None
        Divisions per process zone; ``None``: the solver's choice.
    out : str or None
        Folder of the run, if it is to be written.
    fresh : bool
        Whether an interrupted run found there is ignored.
    estimate : bool
        Whether the errors are estimated.
    plot : bool
        Whether ``force.png`` and ``force.svg`` are drawn, into ``out`` or the current folder.

    Returns
    -------
    int
        2 if the solver refuses the scene, 1 if the run does not finish, else 0.
    """
    case = cases.load(name)
    folder = None if out is None else output_folder(out)
    drawn = (output_folder(".", "--plot") if folder is None else folder) if plot else None
    progress = Progress(f"{case.name} {solver}")
    try:
        if folder is None:
            result, writer = run_solver(case, solver, resolution, progress, estimate), None
        else:
            result, writer = run_with_checkpoints(case, solver, resolution, progress, folder, fresh, estimate)
    finally:
        progress.close()
    if result.refused:
        print(f"crosscontact: error: {result.failure}", file=sys.stderr)
        return 2
    if folder is not None:
        write_run(folder, case.scene, result)
    _print(case, result, estimate)
    if drawn is not None and result.trace is not None:
        _draw(Result(case.scene, result), drawn)
    if folder is not None:
        print(f"written to {folder}")
    if writer is not None and writer.stopped:
        print(f"crosscontact: saved in {writer.path}: the same command continues it", file=sys.stderr)
        raise KeyboardInterrupt
    if writer is not None and result.trace is not None:  # a breakdown may come of the machine: go on later
        writer.remove()
    if not result.finished:
        print(f"crosscontact: not finished: {result.ending}", file=sys.stderr)
        return 1
    return 0


def _print(case: cases.Case, result: Run, estimate: bool) -> None:
    print(f"{result.scene} by {result.solver}: {result.ending}")
    steps = result.measures.get("counters.steps")
    rows = table(key_numbers(case.scene, result.measures, result.errors))
    more = [
        ("steps", "-" if steps is None else format(steps, ".0f")),
        ("wall_seconds", f"{result.wall_seconds:.3f}"),
    ]
    filler = ("",) * (len(rows[0]) - 2)
    for line in aligned([*rows, *((*entry, *filler) for entry in more)]):
        print(line)
    if result.errors:
        print(f"  errors are relative: {SCALES_IN_WORDS}")
    elif result.finished:
        print(f"  no error estimate ({'the coarser run ends otherwise' if estimate else 'add --estimate'})")


def _draw(result: Result, folder: Path) -> None:
    """``force.png`` and ``force.svg``."""
    figure = result.figure()
    write_whole(folder / "force.png", png(figure, DOTS_PER_INCH))
    write_whole(folder / "force.svg", svg_file(figure))
    print(f"drawn in {folder / 'force.png'} and {folder / 'force.svg'}")
