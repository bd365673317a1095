"""``crosscontact fit``: numbers of a scene from measured curves."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from contact_scene import SceneError
from crosscontact.arguments import COUNT, option_type
from crosscontact.commands import shared
from crosscontact.commands.shared import say, value
from crosscontact.fitting import Fit, FitWork, read_all
from validation import cases
from validation.fits.fit import EachFit
from validation.fits.page import each_table
from validation.fits.parameters import FitSettings
from validation.fits.result import InterruptedFit
from validation.report.texts import aligned
from validation.runs.folder import output_folder
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.solvers import REFERENCE


def _names(metavar: str, help: str) -> dict[str, Any]:
    return value(metavar, help, nargs="+", default=[])


def _share(text: str) -> float:
    """A share as 0.01 or 1%."""
    return float(text.removesuffix("%")) * (0.01 if text.endswith("%") else 1.0)


OPTIONS: shared.Options = {
    "data": value("DATA", "files of instruments, tables of text, archives of these", nargs="+"),
    "scene": value("SCENE", "the first guess: a TOML file or a built-in name"),
    "--vary": _names(
        "PATH[=LOW:HIGH]", "numbers of the scene, as adhesion.work or material.branches[0].time=0.1:10"
    ),
    "--per-curve": _names("PATH", "the same, another value for each curve"),
    "--tie": _names("PATH=OTHER", "PATH keeps its ratio to OTHER"),
    "--free": _names(
        "NAME",
        "of each curve: contact_point, baseline, drift, background (level, tilt, drag, wave), time_offset",
    ),
    "--profile": _names("NAME", "profile likelihood of these, or all"),
    "--prony": value("TIME", "moduli on these relaxation times", nargs="+", type=float, default=[]),
    "--starts": value("N", "default: 3, with --each 1", type=option_type(COUNT)),
    "--seed": value("N", "of the starts that are drawn", type=int, default=0),
    "--within": value("SHARE", "of the range that the model may miss, as 1%%", type=_share, default=None),
    "--posterior": shared.flag("sample it: intervals of walkers beside those of the least squares"),
    **shared.resolution("default: by the noise"),
    **shared.MAX_STEPS,
    "--regularisation": value("X", "weight of the bending of these moduli; default: 0.1", type=float),
    **shared.READING,
    **shared.solver("default: the reference"),
    "--check-solver": value("NAME", "or none; default: bem, with --each none"),
    "--each": shared.flag("every curve by itself, from the answer before it: table.csv, map.nc and a page"),
    "--out": value("DIR", "write page, fit.json, scene.toml and figure there"),
    **shared.jobs(),
    **shared.FRESH,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Print every parameter with its error; 1 if the search did not converge or the model does not explain
    the data. The best of an interrupted search is printed and written too."""
    settings = _settings(options)
    scene = cases.load(options.scene).scene
    curves = [curve for found in read_all(options.data, options, si=False) for curve in found]
    folder = None if options.out is None else output_folder(options.out)
    try:
        with Progress("fit", "searching") as progress, processes(jobs) as executor:
            how: Any = folder, executor, lambda text: progress(0.0, text), "--out", options.fresh
            work = FitWork(curves, scene, settings, *how)
            if options.each:
                return _of_each(work.each(), folder)
            result = work.fit()
    except InterruptedFit as interrupted:
        if interrupted.result is not None:
            print(Fit(interrupted.result))
        kept = "the same command goes on" if folder is not None else "without --out DIR nothing is kept"
        say(f"interrupted: {kept}")
        raise
    print(Fit(result))
    shared.warn(result.warnings)
    if folder is not None:
        print(f"written to {folder / 'index.html'}")
    if not result.converged:
        say(f"not finished: {result.ended}")
        return 1
    return 0 if result.goodness.explained else 1


def _of_each(found: list[EachFit], folder: Path | None) -> int:
    """Print a line for each curve; 1 if one of them is not explained."""
    for line in aligned(each_table(found).texts):
        print(line)
    if folder is not None:
        print(f"written to {folder / 'index.html'}")
    return 0 if all(one.explained for one in found) else 1


def _settings(options: argparse.Namespace) -> FitSettings:
    """What to fit and how."""
    chosen = {name: getattr(options, name) for name in FitSettings.__dataclass_fields__}
    chosen["solver"] = options.solver or REFERENCE
    chosen["starts"] = options.starts or (1 if options.each else 3)
    check = options.check_solver or ("none" if options.each else "bem")
    chosen["check_solver"] = None if check == "none" else check
    try:
        return FitSettings(**chosen)
    except SceneError as error:
        raise SceneError(f"--{error.key.replace('_', '-')}", error.problem, error.allowed) from None
