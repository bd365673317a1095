"""Curves as CSV: a header, one row a sample, and comments that state what holds for the whole curve.

::

    # stiffness = 0.05
    # indenter_radius = 2.5e-6
    time,stage,force
    0.0,-1e-6,2e-12

A table of :mod:`contact_scene.tables`: columns are found by name, and others are ignored.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError
from contact_scene.files import read_text, write_whole
from contact_scene.tables import read_table
from contact_scene.value_checks import finite
from validation.fits.record import COLUMNS, MeasuredCurve

LARGEST_FILE = 200_000_000
"""Bytes; a record of a few million rows, above which a file is no record of one curve."""
REMARKS = ("stiffness", "indenter_radius", "noise")
_WANTED = "a header: time, penetration or stage, force and, if measured, contact_radius"


def read_csv(path: Path) -> MeasuredCurve:
    """One curve.

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong.
    """
    file = str(path)
    table = read_table(read_text(path, LARGEST_FILE), file, COLUMNS, _WANTED)
    given: dict[str, Any] = {name: table.column(at) for name, at in table.places(("time", "force")).items()}
    given |= {key: table.stated(key, finite) for key in REMARKS}
    try:
        return MeasuredCurve(**given, name=path.stem)
    except SceneError as error:
        raise SceneError(error.key, error.problem, error.allowed, file) from None


def write_csv(curve: MeasuredCurve, path: Path) -> None:
    """Write a curve with all its digits."""
    lines = [f"# {key} = {getattr(curve, key)!r}" for key in REMARKS if getattr(curve, key) is not None]
    columns = {name: getattr(curve, name) for name in COLUMNS if getattr(curve, name) is not None}
    lines.append(",".join(columns))
    lines += [",".join(map(repr, row)) for row in zip(*(c.tolist() for c in columns.values()), strict=True)]
    write_whole(path, "\n".join(lines) + "\n")
