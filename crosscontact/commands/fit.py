"""``crosscontact fit``: numbers of a scene from measured curves."""

from __future__ import annotations

import argparse

from contact_scene import SceneError
from contact_scene.errors import shown
from crosscontact import arguments
from crosscontact.commands import shared
from crosscontact.commands.shared import say
from crosscontact.fitting import Fit, read_curves
from validation import cases
from validation.fits.fit import fit_curves, question
from validation.fits.fit_result import InterruptedFit
from validation.fits.fit_settings import FitSettings
from validation.fits.page import write_fit
from validation.runs.folder import claim, output_folder
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.runs.store import Store

SETTINGS = (
    "vary", "tie", "per_curve", "free", "prony", "starts", "seed", "profile", "resolution", "max_steps",
)  # fmt: skip
"""Options that are settings of a fit as they are."""


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Curves, first guess, what is fitted and how."""
    command.add_argument("data", metavar="DATA", nargs="+", help="CSV files, or files that afmformats reads")
    command.add_argument("scene", metavar="SCENE", help="the first guess: a TOML file or a built-in name")
    for name, metavar, words in (
        (
            "--vary",
            "PATH[=LOW:HIGH]",
            "numbers of the scene, as adhesion.work or material.branches[0].time=0.1:10",
        ),
        ("--per-curve", "PATH", "the same, another value for each curve"),
        ("--tie", "PATH=OTHER", "PATH keeps its ratio to OTHER"),
        ("--free", "NAME", "of each curve: contact_point, baseline, drift, time_offset"),
        ("--profile", "NAME", "profile likelihood of these, or all"),
    ):
        command.add_argument(name, nargs="+", default=[], metavar=metavar, help=words)
    command.add_argument(
        "--prony", nargs="+", type=float, default=[], metavar="TIME", help="moduli on these relaxation times"
    )
    command.add_argument(
        "--regularisation",
        type=float,
        metavar="X",
        help="weight of the bending of these moduli; default: 0.1",
    )
    command.add_argument("--starts", type=shared.count, default=3, metavar="N", help="default: %(default)s")
    command.add_argument("--seed", type=int, default=0, metavar="N", help="of the starts that are drawn")
    shared.solver_option(command, "default: the reference")
    command.add_argument("--check-solver", default="bem", metavar="NAME", help="or none; default: bem")
    command.add_argument("--resolution", type=shared.resolution, metavar="N", help="default: by the noise")
    command.add_argument("--out", metavar="DIR", help="write page, fit.json, scene.toml and figure there")
    shared.run_options(command, max_steps=True)


def run(options: argparse.Namespace, jobs: int) -> int:
    """Print every parameter with its error; 1 if the search did not converge or the model does not explain
    the data. The best of an interrupted search is printed and written too."""
    settings = _settings(options)
    scene = cases.load(options.scene).scene
    try:
        curves = [curve for file in options.data for curve in read_curves(file)]
    except ImportError as error:
        raise SceneError("", str(error), "a CSV file, or the extra") from None
    folder = None if options.out is None else output_folder(options.out)
    if folder is not None:
        claim(folder, "a fit", question(curves, scene, settings), fresh=options.fresh)
    store = Store(folder, options.fresh)
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
        say(f"interrupted: {kept}")
        raise
    print(Fit(result))
    shared.warn(result.warnings)
    if folder is not None:
        write_fit(result, folder)
        store.clear()
        print(f"written to {folder / 'index.html'}")
    if not result.converged:
        say(f"not finished: {result.ended}")
        return 1
    return 0 if result.goodness.explained else 1


def _settings(options: argparse.Namespace) -> FitSettings:
    """What to fit and how."""
    chosen = {name: getattr(options, name) for name in SETTINGS}
    if options.regularisation is not None:
        chosen["regularisation"] = options.regularisation
    solver = options.solver or arguments.REFERENCE
    arguments.check(solver, "--solver", arguments.names())
    check = None if options.check_solver == "none" else options.check_solver
    if check is not None and check not in arguments.names():
        raise SceneError("--check-solver", f"got {shown(check)}", f"none, {', '.join(arguments.names())}")
    return FitSettings(**chosen, solver=solver, check_solver=check)
