"""Recorded curves: what each shows, as a table in Markdown and a picture; nothing is fetched.

::

    python -m benchmarks.real_curves docs/data/curves --draw curves.png

``FOLDER`` holds files of instruments. What a file does not state stands in ``curves.toml`` beside it, by its
name: ``["a.csv"] spring_constant = 0.1, speed = 1e-6, radius = 1e-5``.
"""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from crosscontact.fitting import MeasuredCurve
from validation.drawing.figure import drawing, png
from validation.fits.curve_page import draw_over_stage, prefixed
from validation.fits.features import Features
from validation.fits.readers import Given, choose, read_file

COLUMNS = ("file", "contact", "indentation", "modulus", "pull-off", "lost", "noise", "told")
PANELS, DOTS = 5, 90


def main(arguments: list[str] | None = None) -> int:
    """Print the table, and how many files could not be read."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--draw", type=Path, help="a picture of the first ten curves")
    parser.add_argument("--only", nargs="+", help="these files")
    options = parser.parse_args(arguments)
    beside = options.folder / "curves.toml"
    stated = tomllib.loads(beside.read_text("utf-8")) if beside.exists() else {}
    shown, refused, begun = [], 0, process_time()
    print(f"| {' | '.join(COLUMNS)} |\n|{'---|' * len(COLUMNS)}")
    for file in sorted(one for one in options.folder.iterdir() if one.suffix not in (".md", ".toml")):
        if options.only and file.name not in options.only:
            continue
        try:
            curve, told = _read(file, dict(stated.get(file.name, {})))
        except (ValueError, ImportError) as error:
            print(f"| {file.name} | {str(error).removeprefix(f'{file}: ')} |")
            refused += 1
            continue
        shown.append((file.name, curve, told))
        print(_row(file.name, curve, told))
    print(f"\n{len(shown)} read, {refused} not; {process_time() - begun:.0f} s of processor time")
    if options.draw:
        options.draw.write_bytes(_drawn(shown[: 2 * PANELS]))
    return 1 if refused else 0


def _read(file: Path, stated: dict[str, Any]) -> tuple[MeasuredCurve, Features]:
    radius, enum = stated.pop("radius", None), stated.pop("enum", 0)
    curve = choose(read_file(file, Given(**stated), si=True), enum, None, file)[0]
    return curve, curve.features(radius)


def _row(name: str, curve: MeasuredCurve, told: Features) -> str:
    """A line of the table; places are counted from the first row."""

    def shown(value: float | None, unit: str, origin: float = 0.0) -> str:
        return "" if value is None else prefixed(value - origin, unit)

    first = curve.position[0]
    cells = [
        name,
        shown(told.contact, "m", first) or "no contact",
        shown(told.depth, "m"),
        shown(told.modulus, "Pa"),
        shown(told.pull_off, "N"),
        shown(told.lost, "m", first),
        shown(told.rough, "N"),
        "; ".join(told.warnings),
    ]
    return f"| {' | '.join(cells)} |"


def _drawn(shown: list[tuple[str, MeasuredCurve, Features]]) -> bytes:
    """Force over its background, over the stage."""
    figure, grid = drawing((2.9 * PANELS, 5.4), 2, PANELS)
    for axes, (name, curve, told) in zip(grid.flat, shown, strict=False):
        draw_over_stage(axes, curve, told)
        low = min(float(told.force.min()), -6.0 * told.rough)
        axes.set_ylim(1.15 * low, max(float(np.percentile(told.force, 99)), -1.2 * low))
        axes.locator_params(axis="x", nbins=3)
        axes.set_title(name, fontsize="small")
    return png(figure, DOTS)


if __name__ == "__main__":
    raise SystemExit(main())
