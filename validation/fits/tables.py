"""Curves as tables of text: a header, one row a sample, and comments that state what holds for the curve.

::

    # stiffness = 0.05
    # indenter_radius = 2.5e-6
    time,stage,force
    0.0,-1e-6,2e-12

A table of :mod:`contact_scene.tables`: columns are found by name, and others are ignored. Besides, numbers
may have decimal commas where something else parts the cells, and columns may be named by hand. Units in
brackets are labels of the scene's own units, or are converted to SI; those of an instrument's columns always.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from contact_scene.errors import SceneError
from contact_scene.files import read_text, table_text, write_whole
from contact_scene.tables import TextTable, bracketed, finite, is_number, read_table, spelt
from contact_scene.value_checks import Range
from validation.fits.contact import Array
from validation.fits.record import (
    COLUMNS,
    FEWEST_ROWS,
    HELD,
    INSTRUMENTS,
    NUMBERS,
    Given,
    MeasuredCurve,
    missing,
)

LARGEST_FILE = 200_000_000
"""Bytes; a record of a few million rows, above which a file is no record of one curve."""
_WANTED = "a header: time, penetration or stage, force and, if measured, contact_radius"
_BY_HAND = f"{_WANTED}; or --columns time=1,stage=2:1e-9,force=3:1e-9"
_PREFIXES = {"f": -15, "p": -12, "n": -9, "u": -6, "m": -3, "c": -2, "": 0, "k": 3, "M": 6, "G": 9}
_POWERS = {prefix + base: power for prefix, power in _PREFIXES.items() for base in ("m", "s", "N", "V")}
_OTHER = {"": 1.0, "min": 60.0, "h": 3600.0, "sec": 1.0, "Å": 1e-10, "A": 1e-10, "Angstrom": 1e-10}
_SPRING = r"(?<!\w)(?:spring[ _]?constant|stiffness|k)"
_RADIUS = r"(?<!\w)(?:(?:indenter|tip|bead|sphere)[ _]?radius)"
_NUMBER = r"[-+]?\d+(?:[.,]\d*)?(?:[eE][-+]?\d+)?"


class _OrNone(Range):
    """Numbers as recorded, nan and infinity included: such rows are left out."""

    def __call__(self, value: Any, key: str) -> float:
        return float(value)

    def holds(self, value: Any) -> Any:
        return np.full(np.shape(value), True)


def read_table_curve(path: Path, given: Given, si: bool) -> MeasuredCurve:
    """One curve; ``si``: units in brackets are converted."""
    table = read_table(_plain(_text(path)), str(path), () if given.columns else HELD, _BY_HAND)
    si |= bool(given.columns) or any(kind in INSTRUMENTS for kind in table.kinds)
    columns = _columns_by_hand(table, given) if given.columns else _columns(table, si)
    stated: dict[str, Any] = {key: table.stated(key, finite) for key in (("noise",) if si else NUMBERS)}
    if si:
        head = "\n".join(line.content for line in table.head)
        stated |= {"stiffness": _in_si(head, _SPRING), "indenter_radius": _in_si(head, _RADIUS)}
    stated["stiffness"] = given.spring_constant or stated["stiffness"]
    for instrument, sign in (("piezo", 1.0), ("height", -1.0)):
        if instrument in columns:
            columns.setdefault("stage", sign * columns[instrument])
    if "stage" in columns and "penetration" in columns and si:
        del columns["penetration" if stated["stiffness"] else "stage"]
    if "deflection" in columns and "force" not in columns:
        columns["force"] = _force(columns["deflection"], table, given, stated["stiffness"], path)
    return given.curve(path, path.stem, {key: columns[key] for key in COLUMNS if key in columns}, **stated)


def _columns(table: TextTable, si: bool) -> dict[str, Array]:
    """Columns by the names of the header; of instruments in SI, and without times, if they state none."""
    if not si:
        return {kind: table.column(at) for kind, at in table.places(("time", "force")).items()}
    places = {kind: n for n, kind in reversed(list(enumerate(table.kinds))) if kind}
    if not {"force", "deflection"} & set(places):
        raise table.unknown()
    return {kind: table.column(at, _OrNone("")) * _factor(table, at) for kind, at in places.items()}


def _columns_by_hand(table: TextTable, given: Given) -> dict[str, Array]:
    """Columns that the user names by their number from 1, or their name in the header."""
    names = [name.replace("_", " ") for name in table.names]
    found = {}
    for key, (column, factor) in (given.columns or {}).items():
        place = column - 1 if isinstance(column, int) else names.index(column) if column in names else -1
        if not 0 <= place < table.width:
            listed = ", ".join(f"{n} {name}".strip() for n, name in enumerate(names, 1))
            raise SceneError("columns", f"{key} is to be column {column}", f"one of {listed}", table.file)
        found[key] = factor * table.column(place, _OrNone(""))
    return found


def _force(deflection: Array, table: TextTable, given: Given, spring: Any, path: Path) -> Array:
    """Force of a deflection, in metres or in volts."""
    units = dict(zip(table.kinds, table.units, strict=True))
    slope: Any = given.sensitivity or (None if units.get("deflection", "").endswith("V") else 1.0)
    needed = {"spring constant": spring, "sensitivity": slope}
    absent = [key for key, value in needed.items() if not value]
    if absent:
        raise missing(absent, path)
    return np.asarray(deflection * spring * slope)


def _factor(table: TextTable, place: int) -> float:
    """From the unit of a column to SI."""
    unit = spelt(table.units[place])
    if unit in _POWERS:
        return float(f"1e{_POWERS[unit]}")
    if unit not in _OTHER:
        problem = f"{table.names[place]} in {unit}"
        raise SceneError("columns", problem, "a unit of SI, as nm, s, nN", table.file)
    return _OTHER[unit]


def _in_si(head: str, name: str) -> float | None:
    """The number that the head states: ``k (N/m)  0.05``, ``# spring constant = 50 pN/nm``."""
    found = re.findall(rf"{name}\s*([\[(][^\])]*[\])])?[\"']?\s*[=:\t ]\s*({_NUMBER})[ \t]*([\w/µμ]*)", head)
    if not found:
        return None
    before, value, behind = found[-1]
    parts = spelt(bracketed(before) or behind).split("/")
    power = sum(sign * _POWERS.get(part, 0) for part, sign in zip(parts, (1, -1), strict=False))
    return float(value.replace(",", ".")) * float(f"1e{power}")


def _text(path: Path) -> str:
    """The text of a file in UTF-8, or in the code of western Windows, as instruments write it."""
    try:
        return read_text(path, LARGEST_FILE)
    except SceneError as error:
        if "UTF-8" not in error.problem:
            raise
    data = path.read_bytes()
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    if not wide and b"\0" in data[:1000]:
        raise SceneError("", "is no text", "a table of text", str(path))
    return data.decode("utf-16" if wide else "cp1252", errors="replace")


def _plain(text: str) -> str:
    """A record as a table: decimal commas as points, and lines that state numbers above its rows as comments;
    rows are the lines of numbers alone, as many in each as in most."""
    lines = re.split(r"\r\n|\r|\n", text)
    for decimal in (True, False):
        parted = r";|\s" if decimal else r"[;,\s]"
        widths = [_numbers(re.split(parted, line.strip(" ;\t")), decimal) for line in lines]
        [(width, rows)] = Counter(one for one in widths if one > 1).most_common(1) or [(0, 0)]
        if rows >= FEWEST_ROWS:
            first = widths.index(width)
            stating = [bool(re.search(r"\d", line)) and line[0] not in "#%" for line in lines[:first]]
            head = [f"# {line}" if told else line for line, told in zip(lines, stating, strict=False)]
            body = [line.replace(",", ".") for line in lines[first:]] if decimal else lines[first:]
            return "\n".join([*head, *body])
    return "\n".join(lines)


def _numbers(cells: list[str], decimal: bool) -> int:
    """How many cells there are, if all are numbers; else 0."""
    filled = [cell.strip('"') for cell in cells if cell]
    points = (cell.replace(",", ".") if decimal and not cell.endswith(",") else cell for cell in filled)
    return len(filled) if all(map(is_number, points)) else 0


def write_csv(curve: MeasuredCurve, path: Path) -> None:
    """Write a curve with all its digits."""
    head = [f"# {key} = {getattr(curve, key)!r}" for key in NUMBERS if getattr(curve, key) is not None]
    write_whole(path, table_text(curve.columns(), head))
