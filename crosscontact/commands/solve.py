"""``crosscontact solve``: one solver on one scene."""

from __future__ import annotations

import sys
from pathlib import Path

from contact_scene import OutcomeKind
from crosscontact.commands.failures import warn
from crosscontact.commands.interruption import drop_former
from crosscontact.commands.refusals import check_taken
from crosscontact.key_numbers import SCALES_IN_WORDS, key_numbers, table
from crosscontact.result import Result
from crosscontact.tables import aligned
from validation import cases, solvers
from validation.drawing.export import png, svg_file
from validation.execution.files import output_folder, write_whole
from validation.execution.progress import Progress, StepProgress
from validation.execution.run_folder import check_unused, write_run
from validation.execution.runs import Run
from validation.execution.runs import run as run_solver
from validation.execution.signals import GracefulStop
from validation.measure.windows import load_steps_begun

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
    max_steps: int | None = None,
) -> int:
    """Run a solver, print the key numbers, write what is asked for.

    An interrupted run ends with its present step and is written as far as it came; the same command begins
    anew.

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
        Whether results of another scene or solver found there are replaced.
    estimate : bool
        Whether the errors are estimated.
    plot : bool
        Whether ``force.png`` and ``force.svg`` are drawn, into ``out`` or the current folder.
    max_steps : int or None
        Largest number of steps, accepted and rejected together; ``None``: the solver's own bound.

    Returns
    -------
    int
        2 if the solver refuses the scene, 1 if the run does not finish, else 0.

    Raises
    ------
    SceneError
        If the folder holds the results of another scene or solver, or the solver cannot take this scene.
    KeyboardInterrupt
        If the run was interrupted; what there is, is written and said before.
    """
    case, method = cases.load(name), solvers.solver(solver)
    check_taken(name, case.scene, (method,), resolution)  # one line of a refusal, before anything is made
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        check_unused(folder, case.scene, solver=solver)
    drop_former(folder)
    drawn = (output_folder(".", "--plot") if folder is None else folder) if plot else None
    said = solvers.scene_warnings(case.scene)
    warn(said)
    with Progress(f"{case.name} {solver}") as progress:
        progress.phase("set-up")
        after = "estimating the errors" if estimate else "measuring"
        steps = StepProgress(progress, after)
        stop = GracefulStop()
        try:
            with stop.handling_signals():
                result = run_solver(
                    case, solver, resolution, steps, estimate, monitor=stop.monitor, max_steps=max_steps
                )
        except KeyboardInterrupt:
            print("crosscontact: nothing is kept of the run", file=sys.stderr)
            raise
    if result.refused:
        print(f"crosscontact: error: {result.failure}", file=sys.stderr)
        return 2
    try:
        if folder is not None:
            write_run(folder, case.scene, result)
    finally:  # numbers that a full disk does not take are printed all the same
        _print(case, result, _without_errors(stop, estimate))
    known = solvers.trace_warnings(case.scene, result.trace) if said and result.trace is not None else ()
    warn([one for one in result.warnings if one not in known])
    if drawn is not None and result.trace is not None:
        _draw(Result(case.scene, result), drawn)
    if folder is not None:
        print(f"written to {folder}")
    return _ending(result, stop, estimate)


def _ending(result: Run, stop: GracefulStop, estimate: bool) -> int:
    """Say what is unfinished; the exit code."""
    if stop.requested and not result.finished:
        print("crosscontact: the run ends here; the same command begins it anew", file=sys.stderr)
        raise KeyboardInterrupt
    if not result.finished:
        out_of_steps = result.trace is not None and result.trace.outcome.kind is OutcomeKind.STEP_BUDGET
        hint = "; --max-steps N allows more" if out_of_steps else ""
        print(f"crosscontact: not finished: {result.ending}{hint}", file=sys.stderr)
        return 1
    if stop.requested and estimate and not result.errors:
        print("crosscontact: the run is whole, its errors are not estimated", file=sys.stderr)
        raise KeyboardInterrupt
    return 0


def _without_errors(stop: GracefulStop, estimate: bool) -> str:
    """Why a run that is whole has no error estimate."""
    if not estimate:
        return "add --estimate"
    return "it was interrupted" if stop.requested else "the coarser run ends otherwise"


def _print(case: cases.Case, result: Run, without_errors: str) -> None:
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
        print(f"  no error estimate ({without_errors})")
    if result.trace is not None and result.trace.outcome.kind is OutcomeKind.DETACHED:
        begun, asked = load_steps_begun(case.scene.loading, result.trace), len(case.scene.loading.steps)
        if begun < asked:
            print(f"  contact is lost in load step {begun} of {asked}: what follows is not carried out")


def _draw(result: Result, folder: Path) -> None:
    """``force.png`` and ``force.svg``."""
    figure = result.figure()
    write_whole(folder / "force.png", png(figure, DOTS_PER_INCH))
    write_whole(folder / "force.svg", svg_file(figure))
    print(f"drawn in {folder / 'force.png'} and {folder / 'force.svg'}")
