"""``crosscontact solve``: one solver on one scene.

An interrupted run ends with its present step and is written as far as it came; the same command begins anew.
"""

from __future__ import annotations

import argparse

from contact_scene import OutcomeKind
from crosscontact import arguments
from crosscontact.commands import shared
from crosscontact.commands.shared import flag, say, value, warn
from crosscontact.result import SCALES_IN_WORDS, Result, key_numbers
from validation import cases, solvers
from validation.measure.windows import load_steps_begun
from validation.report.texts import aligned
from validation.runs.folder import claim, output_folder, scene_question
from validation.runs.process import GracefulStop
from validation.runs.progress import Progress, StepProgress
from validation.runs.run import Run, write_run
from validation.runs.run import run as run_solver

OPTIONS = {
    **shared.SCENE,
    **shared.solver("default: the reference"),
    **shared.resolution(
        "divisions per process zone (without adhesion: per hundredth of the largest contact radius), N >= 4; "
        "default: the solver's choice"
    ),
    "--out": value("DIR", "write trace.csv, summary.json and scene.toml there"),
    "--estimate": flag(
        "estimate the errors, by a second, coarser run where the solver has no estimate of its own"
    ),
    "--plot": flag("draw force.png and force.svg, into --out or the current folder"),
    **shared.MAX_STEPS,
    **shared.REPLACE,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Run a solver, print the key numbers, write what is asked for; 2 if the solver refuses the scene."""
    name, estimate = options.solver or arguments.REFERENCE, options.estimate
    case, method = cases.load(options.scene), solvers.SOLVERS[name]
    shared.check_taken(options.scene, case.scene, (method,), options.resolution)  # before anything is made
    folder = None if options.out is None else output_folder(options.out)
    if folder is not None:
        claim(folder, "a run", scene_question(("", case.scene), solver=name), fresh=options.fresh)
    drawn = (folder or output_folder(".", "--plot")) if options.plot else None
    said, stop = solvers.scene_warnings(case.scene), GracefulStop()
    warn(said)
    with Progress(f"{case.name} {name}", "set-up") as progress:
        steps = StepProgress(progress, "estimating the errors" if estimate else "measuring")
        how, max_steps = (options.resolution, steps, estimate), options.max_steps
        try:
            with stop.handling_signals():
                result = run_solver(case, name, *how, monitor=stop.monitor, max_steps=max_steps)
        except KeyboardInterrupt:
            say("nothing is kept of the run")
            raise
    if result.refused:
        say(f"error: {result.failure}")
        return 2
    try:
        if folder is not None:
            write_run(folder, case.scene, result)
    finally:  # numbers that a full disk does not take are printed all the same
        _print(case, result, _without_errors(stop, estimate))
    known = solvers.trace_warnings(case.scene, result.trace) if said and result.trace is not None else ()
    warn(one for one in result.warnings if one not in known)
    if drawn is not None and result.trace is not None:
        shared.draw(Result(case.scene, result).figure(), drawn, "force")
    if folder is not None:
        print(f"written to {folder}")
    return _ending(result, stop, estimate)


def _ending(result: Run, stop: GracefulStop, estimate: bool) -> int:
    """Say what is unfinished; the exit code."""
    if stop.requested and not result.finished:
        say("the run ends here; the same command begins it anew")
        raise KeyboardInterrupt
    if not result.finished:
        kind = None if result.trace is None else result.trace.outcome.kind
        say(f"not finished: {result.ending}{shared.step_hint(kind)}")
        return 1
    if stop.requested and estimate and not result.errors:
        say("the run is whole, its errors are not estimated")
        raise KeyboardInterrupt
    return 0


def _without_errors(stop: GracefulStop, estimate: bool) -> str:
    """Why a run that is whole has no error estimate."""
    if not estimate:
        return "add --estimate"
    return "it was interrupted" if stop.requested else "the coarser run ends otherwise"


def _print(case: cases.Case, result: Run, without_errors: str) -> None:
    print(f"{result.scene} by {result.solver}: {result.ending}")
    rows = key_numbers(case.scene, result.measures, result.errors)
    filler = ("",) * (len(rows[0]) - 2)
    steps = result.measures.get("counters.steps")
    rows.append(("steps", "-" if steps is None else format(steps, ".0f"), *filler))
    rows.append(("wall_seconds", f"{result.wall_seconds:.3f}", *filler))
    for line in aligned(rows):
        print(line)
    if result.errors:
        print(f"  errors are relative: {SCALES_IN_WORDS}")
    elif result.finished:
        print(f"  no error estimate ({without_errors})")
    if result.trace is not None and result.trace.outcome.kind is OutcomeKind.DETACHED:
        begun, asked = load_steps_begun(case.scene.loading, result.trace), len(case.scene.loading.steps)
        if begun < asked:
            print(f"  contact is lost in load step {begun} of {asked}: what follows is not carried out")
