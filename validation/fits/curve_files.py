"""Curves as CSV: a header, one row a sample, and comments that state what holds for the whole curve.

::

    # stiffness = 0.05
    # indenter_radius = 2.5e-6
    time,stage,force
    0.0,-1e-6,2e-12

Columns are found by name; a unit in brackets behind a name is a label, other columns are ignored. The header
may be a comment.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from contact_scene.errors import SceneError, cell_shown
from contact_scene.files import read_rows, read_text, write_whole
from contact_scene.separators import check_head
from contact_scene.units import bracketed, check_units
from validation.fits.measured_curve import COLUMNS, Array, MeasuredCurve

LARGEST_FILE = 200_000_000
"""Bytes; a record of a few million rows, above which a file is no record of one curve."""
MOST_REMARKS = 1000
"""Lines before the header, at most."""
REMARKS = ("stiffness", "indenter_radius", "noise")
_HEADER = "a header: time, penetration or stage, force and, if measured, contact_radius"
_REMARK = re.compile(r"#\s*(\w+)\s*[=:]\s*(\S+)")


def read_csv(path: Path) -> MeasuredCurve:
    """One curve.

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong.
    """
    text, file = read_text(path, LARGEST_FILE), str(path)
    head, body = _head_and_body(text)
    (line, header), *first = read_rows(head, file)
    if first:  # the header is a comment, and the first row of numbers ends the head
        body = head.splitlines()[-1] + "\n" + body
    check_head(line, header, COLUMNS, file)
    names = [re.sub(r"[\[(].*", "", cell).strip().lower().replace(" ", "_") for cell in header]
    for needed in ("time", "force"):
        if needed not in names:
            raise SceneError("", f"no column {needed}", _HEADER, file)
    for name in COLUMNS:
        if names.count(name) > 1:
            raise SceneError(name, "stands twice in the header", _HEADER, file)
    check_units(zip(names, map(bracketed, header), strict=True), "header", file)
    places = {name: names.index(name) for name in COLUMNS if name in names}
    columns = _plain_columns(body, places, len(names))
    if columns is None:
        _, *rows = read_rows(text, file)
        columns = {name: _column(rows, place, len(names), name, file) for name, place in places.items()}
    remarks = {found[1]: found[2] for line in head.split("\n") if (found := _REMARK.match(line.strip()))}
    stated = {key: _number(remarks[key], key, file) for key in REMARKS if key in remarks}
    try:
        return MeasuredCurve(**columns, **stated, name=path.stem)  # type: ignore[arg-type]
    except SceneError as error:
        raise SceneError(error.key, error.problem, error.allowed, file) from None


def write_csv(curve: MeasuredCurve, path: Path) -> None:
    """Write a curve with all its digits."""
    lines = [f"# {key} = {getattr(curve, key)!r}" for key in REMARKS if getattr(curve, key) is not None]
    columns = {name: getattr(curve, name) for name in COLUMNS if getattr(curve, name) is not None}
    lines.append(",".join(columns))
    lines += [",".join(map(repr, row)) for row in zip(*(c.tolist() for c in columns.values()), strict=True)]
    write_whole(path, "\n".join(lines) + "\n")


def _head_and_body(text: str) -> tuple[str, str]:
    """Text up to the first line that is no comment: the header, or the first row; and what follows."""
    end = 0
    for line in text.split("\n", MOST_REMARKS):
        end += len(line) + 1
        if line.strip() and not line.lstrip().startswith("#"):
            break
    return text[:end], text[end:]


def _plain_columns(body: str, places: dict[str, int], width: int) -> dict[str, Array] | None:
    """Columns of finite numbers read at once; ``None`` for any other text: its rows tell what is wrong."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a body without rows
            table = np.loadtxt(io.StringIO(body), delimiter=",", comments="#", ndmin=2)
    except ValueError:
        return None
    if table.shape[1] != width or not table.size or not np.isfinite(table).all():
        return None
    return {name: np.ascontiguousarray(table[:, place]) for name, place in places.items()}


def _column(
    rows: Sequence[tuple[int, list[str]]], place: int, width: int, name: str, file: str
) -> np.ndarray:
    """One column of numbers.

    Parameters
    ----------
    rows : sequence of (int, list of str)
        Line numbers and cells.
    place, width : int
        Of the column; columns of the header.
    name, file : str
        For errors.

    Returns
    -------
    ndarray, shape (N,)
    """
    values = np.empty(len(rows))
    for index, (line, cells) in enumerate(rows):
        if len(cells) != width:
            raise SceneError(f"line {line}", f"{len(cells)} cells", f"{width}, as in the header", file)
        values[index] = _number(cells[place], f"line {line}, {name}", file)
    return values


def _number(cell: str, key: str, file: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        raise SceneError(key, f"got {cell_shown(cell)}", "a finite number", file) from None
    if not np.isfinite(value):
        raise SceneError(key, f"got {cell}", "a finite number", file)
    return value
