"""``crosscontact fit``: numbers of a scene from measured curves."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from contact_scene import SceneError
from contact_scene.errors import shown
from crosscontact import registry
from crosscontact.commands.failures import warn
from crosscontact.fitting import Fit, read_curves
from validation import cases
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.fits.fit import fit_curves
from validation.fits.fit_question import RESULT, check_folder, question
from validation.fits.fit_result import InterruptedFit
from validation.fits.fit_settings import FitSettings
from validation.report.report_folder import check_kind
from validation.report.write_fit import write_fit

OPTIONS = (
    "vary",
    "tie",
    "per_curve",
    "free",
    "prony",
    "starts",
    "seed",
    "profile",
    "resolution",
    "max_steps",
)


def settings_of(options: argparse.Namespace) -> FitSettings:
    """What to fit and how, from the command line."""
    chosen = {name: getattr(options, name) for name in OPTIONS}
    if options.regularisation is not None:
        chosen["regularisation"] = options.regularisation
    solver = options.solver or registry.REFERENCE
    if solver not in registry.names():
        raise SceneError("--solver", f"got {shown(solver)}", f"one of {', '.join(registry.names())}")
    check = None if options.check_solver == "none" else options.check_solver
    if check is not None and check not in registry.names():
        raise SceneError("--check-solver", f"got {shown(check)}", f"none, {', '.join(registry.names())}")
    return FitSettings(**chosen, solver=solver, check_solver=check)


def run(
    data: list[str], name: str, settings: FitSettings, out: str | None, jobs: int, fresh: bool = False
) -> int:
    """Fit, print every parameter with its error, write what is asked for.

    Parameters
    ----------
    data : list of str
        Files of curves.
    name : str
        Scene file or name of a built-in scene: the first guess.
    settings : FitSettings
    out : str or None
        Folder of the results; an interrupted fit goes on from there.
    jobs : int
        Processes.
    fresh : bool
        Whether runs of an interrupted fit are ignored, and foreign results replaced.

    Returns
    -------
    int
        1 if the search did not converge, or the model does not explain the data, else 0.

    Raises
    ------
    SceneError
        If data, scene or settings are no good.
    KeyboardInterrupt
        If interrupted; the best so far is written and printed before.
    """
    scene = cases.load(name).scene
    try:
        curves = [curve for file in data for curve in read_curves(file)]
    except ImportError as error:
        raise SceneError("", str(error), "a CSV file, or the extra") from None
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        check_kind(folder, RESULT)
        check_folder(folder, question(curves, scene, settings), scene)
    store = Store(folder, fresh)
    try:
        with Progress("fit") as progress, processes(jobs) as executor:
            progress.phase("searching")
            result = fit_curves(curves, scene, settings, executor, store, lambda text: progress(0.0, text))
    except InterruptedFit as interrupted:
        if interrupted.result is not None:
            print(Fit(interrupted.result))
            if folder is not None:
                write_fit(interrupted.result, folder)
        kept = "the same command goes on" if folder is not None else "without --out DIR nothing is kept"
        print(f"crosscontact: interrupted: {kept}", file=sys.stderr)
        raise
    print(Fit(result))
    warn(result.warnings)
    if folder is not None:
        write_fit(result, folder)
        store.clear()
        print(f"written to {Path(folder) / 'index.html'}")
    if not result.converged:
        print(f"crosscontact: not finished: {result.ended}", file=sys.stderr)
        return 1
    return 0 if result.goodness.explained else 1
