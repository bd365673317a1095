"""``crosscontact curve``: what measured curves show of themselves, without a solver."""

from __future__ import annotations

import argparse

from contact_scene.files import write_whole
from contact_scene.value_checks import number, positive
from crosscontact.arguments import option_type
from crosscontact.commands import shared
from crosscontact.commands.shared import value
from crosscontact.fitting import read_all
from validation.fits.curve_page import draw_curve, rows, written
from validation.fits.features import Features, common_wall
from validation.fits.record import MeasuredCurve
from validation.report.texts import aligned
from validation.runs.folder import output_folder

OPTIONS = {
    "files": value("FILE", "files of instruments, tables of text, archives of these", nargs="+"),
    "--radius": value(
        "R", "of a spherical indenter, in m: modulus, and drag near the wall", type=option_type(positive)
    ),
    "--poisson": value("NU", "of the sample; default: %(default)s", type=float, default=0.5),
    **shared.READING,
    "--out": value("DIR", "write features.csv, and a picture of each curve, there"),
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Print a table for each curve: contact point, first guesses, pull-off, background, warnings."""
    number(options.poisson, "--poisson", "from -1 to 0.5", low=-1.0, high=0.5)
    folder = None if options.out is None else output_folder(options.out)
    files = read_all(options.files, options, si=True)
    told = [each for curves in files for each in _shown(curves, options.radius, options.poisson)]
    for curve, seen in told:
        print("\n".join([curve.name, *aligned(rows(curve, seen))]))
        shared.warn(f"{curve.name}: {text}" for text in seen.warnings)
    if folder is not None:
        write_whole(folder / "features.csv", written(told))
        for curve, seen in told:
            shared.draw(draw_curve(curve, seen), folder, curve.name)
        print(f"written to {folder / 'features.csv'}")
    return 0


def _shown(
    curves: list[MeasuredCurve], radius: float | None, poisson: float
) -> list[tuple[MeasuredCurve, Features]]:
    """What the curves of a file show; those of a map with the drag near the wall that they have in common."""
    seen = [curve.features(radius, poisson) for curve in curves]
    wall = common_wall(seen) if len(seen) > 1 else None
    if wall is not None:
        seen = [curve.features(radius, poisson, wall) for curve in curves]
    return list(zip(curves, seen, strict=True))
