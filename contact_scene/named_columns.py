"""Plain tables of material data: text to named columns of numbers, each error with its line.

Cells are parted by commas, semicolons or blanks. Lines without a number before the first row are headers,
and ``#`` starts a comment; the first of them with known names names the columns.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from contact_scene.errors import SceneError, shown
from contact_scene.files import is_number
from contact_scene.units import bracketed, without_unit

KINDS = {
    "time": ("t", "time"),
    "relaxation time": ("tau", "tau_i", "relaxation_time"),
    "frequency": ("f", "freq", "frequency"),
    "angular frequency": ("w", "omega", "ω", "angular_frequency"),
    "modulus": ("E", "E_i", "E_t", "E_relax", "modulus", "relaxation_modulus"),
    "storage modulus": ("E'", "E_stor", "E_storage", "storage", "storage_modulus"),
    "loss modulus": ("E''", 'E"', "E_loss", "loss", "loss_modulus"),
    "temperature": ("T", "temperature"),
    "shift factor": ("at", "a_t", "shift_factor"),
    "log shift factor": ("log_at", "log_a_t", "log10_at", "log10_a_t"),
}
"""Names of columns by what they hold, as :func:`kind_of` compares them: E stands for G too."""

KNOWN_NAMES = "tau, E | t, E | f, E', E'' (f per unit time) | w, E', E'' (angular), with G for shear moduli"


@dataclass(frozen=True)
class NamedColumns:
    """A plain table: names of its columns, "" where there are none, and its numbers with their lines."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    lines: tuple[int, ...]
    rows: tuple[tuple[float, ...], ...]


def named_columns(text: str, file: str) -> NamedColumns:
    """The numbers of a plain table and, where a line before them names its columns, these names."""
    headers: list[tuple[bool, list[str]]] = []
    lines: list[int] = []
    rows: list[tuple[float, ...]] = []
    for line, content in enumerate(text.split("\n"), 1):
        comment = content.lstrip().startswith("#")
        if comment and rows:
            continue
        cells = cells_of_line(
            content.lstrip().lstrip("#") if comment else content, line, file, strict=not comment
        )
        if not cells:
            continue
        if comment or (not rows and not any(is_number(cell) for cell in cells)):
            headers.append((comment, cells))
            continue
        rows.append(tuple(number_in_line(cell, line, file) for cell in cells))
        lines.append(line)
        if len(rows[-1]) != len(rows[0]):
            allowed = f"{len(rows[0])}, as in line {lines[0]}"
            raise SceneError(f"line {line}", f"{len(rows[-1])} cells", allowed, file)
    if not rows:
        reason = "no rows of numbers" if headers else "the file is empty"
        raise SceneError("", reason, f"a table of numbers: {KNOWN_NAMES}", file)
    names, units = _header([header for header in headers if len(header[1]) == len(rows[0])], len(rows[0]))
    return NamedColumns(names, units, tuple(lines), tuple(rows))


def _header(headers: Sequence[tuple[bool, list[str]]], width: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of ``width`` columns; a header is whether it is a comment, and as many cells.

    The first line with a known name counts (of a comment all must be known), else the first that is neither a
    comment nor a list of parameters (``Mw = 1000; T = 20``): unknown names are for the caller to refuse.
    """
    known = (
        i
        for i, (comment, cells) in enumerate(headers)
        if (all if comment else any)(kind_of(_split(cell)[0]) for cell in cells)
    )
    plain = (i for i, (comment, cells) in enumerate(headers) if not comment and "=" not in "".join(cells))
    index = next(known, next(plain, None))
    if index is None:
        return ("",) * width, ("",) * width
    names, units = zip(*map(_split, headers[index][1]), strict=True)
    if not any(units) and index + 1 < len(headers) and not headers[index + 1][0]:
        units = tuple(cell.strip() for cell in headers[index + 1][1])
    return names, units


def cells_of_line(content: str, line: int, file: str, strict: bool = True) -> list[str]:
    """Cells of a line, parted by semicolons, else by commas, else by blanks; empty for a blank line.

    Parameters
    ----------
    content : str
    line : int
        Its number, for errors.
    file : str
        Name of the file, for errors.
    strict : bool
        Whether a quotation mark out of place is an error.

    Returns
    -------
    list of str
    """
    if not content.strip():
        return []
    if ";" in content:
        return [cell.strip() for cell in content.strip().rstrip(";").split(";")]
    if "," in content:
        try:
            return [
                cell.strip() for cell in next(csv.reader([content], strict=strict, skipinitialspace=True))
            ]
        except csv.Error as error:
            raise SceneError(f"line {line}", f"not CSV: {error}", "comma-separated cells", file) from None
    return content.split()


def _split(cell: str) -> tuple[str, str]:
    """Name and unit of a column: ``E' [MPa]``, ``omega (rad/s)``; the argument of ``E(t)`` is no unit."""
    unit = bracketed(cell)
    return without_unit(cell).replace(" ", "_"), "" if unit in ("t", "w", "f", "omega", "ω") else unit


def kind_of(name: str) -> str:
    """What a column of this name holds; "" if that is not known. ``t`` is a time, ``T`` a temperature."""
    if modulus_letter(name):
        name = "E" + name[1:].lower()
    elif len(name) > 1:
        name = name.lower()
    return next((kind for kind, names in KINDS.items() if name in names), "")


def modulus_letter(name: str) -> str:
    """E or G, where the name of a column is that of a modulus."""
    return name[0] if re.fullmatch(r"[EG]('|\"|''|_\w+)?", name) else ""


def unknown_columns(table: NamedColumns, file: str) -> SceneError:
    """The error of a table whose columns tell no known kind of data, with what is allowed."""
    names = ",".join(table.names) if any(table.names) else f"{len(table.rows[0])} columns without names"
    return SceneError("columns", f"got {shown(names)}", KNOWN_NAMES, file)


def number_in_line(cell: str, line: int, file: str) -> float:
    """The number in a cell.

    Raises
    ------
    SceneError
        One line naming file and line, if there is none.
    """
    if not is_number(cell):
        raise SceneError(f"line {line}", f"got {shown(cell)}", "a number, with a decimal point", file)
    return float(cell)


def checked_in_line(
    check: Callable[[Any, str], float], value: float, name: str, line: int, file: str
) -> float:
    """A number that passes ``check`` of :mod:`contact_scene.errors`, or its error with line and file.

    Parameters
    ----------
    check : callable(value, key)
        Returns the number or raises a ``SceneError``.
    value : float
    name : str
        What the number is.
    line : int
    file : str

    Returns
    -------
    float
    """
    try:
        return float(check(value, f"{name}, line {line}"))
    except SceneError as error:
        raise error.in_file(file) from None
