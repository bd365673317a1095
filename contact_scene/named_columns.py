"""Plain tables of material data: text to named columns of numbers, each error with its line.

Cells are parted by commas, semicolons, tabs or blanks. Lines without a number before the first row are
headers, and ``#`` (``%``, ``!``, ``//``, ``**``) starts a comment; the first of them with known names names
the columns, all of them. A comment of as many names as there are columns is a header too: unknown names in it
are refused like any other.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from contact_scene.errors import SceneError, cell_shown
from contact_scene.separators import ANY_SIGN, check_row, is_name, is_number, names_in_words
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

_ABSCISSAS = {"time", "relaxation time", "frequency", "angular frequency", "temperature"}

KNOWN_NAMES = "tau, E | t, E | f, E', E'' (f per unit time) | w, E', E'' (angular), with G for shear moduli"

_COMMENT = re.compile(r"\s*(#|%|!|//|\*\*)[#%!/*]*")
_NAME_AND_UNIT = re.compile(r"[^\s\[(]+(?: *[\[(][^\])]*[\])])*|\S+")


@dataclass(frozen=True)
class NamedColumns:
    """A plain table: names of its columns, "" where there are none, and its numbers with their lines."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    lines: tuple[int, ...]
    rows: tuple[tuple[float, ...], ...]


def named_columns(text: str, file: str) -> NamedColumns:
    """The numbers of a plain table and, where a line before them names its columns, these names."""
    headers: list[_Header] = []
    lines: list[int] = []
    rows: list[tuple[float, ...]] = []
    for line, content in enumerate(text.split("\n"), 1):
        mark = _COMMENT.match(content)
        if mark and rows:
            continue
        cells = cells_of_line(content[mark.end() :] if mark else content, line, file, strict=not mark)
        if not cells:
            continue
        if mark or (not rows and not any(is_number(cell) for cell in cells)):
            headers.append(_Header(line, content, bool(mark), cells))
            continue
        rows.append(tuple(number_in_line(cell, line, file) for cell in cells))
        lines.append(line)
        if len(rows[-1]) != len(rows[0]):
            allowed = f"{len(rows[0])}, as in line {lines[0]}"
            raise SceneError(f"line {line}", f"{len(rows[-1])} cells", allowed, file)
    if not rows:
        reason = "no rows of numbers" if headers else "the file is empty"
        raise SceneError("", reason, f"a table of numbers ({ANY_SIGN}): {KNOWN_NAMES}", file)
    width, sign = len(rows[0]), _sign(text.split("\n")[lines[0] - 1])
    names, units = _names_and_units([one for one in headers if len(one.cells) == width], width, sign)
    if not any(names):
        _check_width(headers, width, file)
    return NamedColumns(names, units, tuple(lines), tuple(rows))


@dataclass(frozen=True)
class _Header:
    """A line before the first row of numbers: its number and text, whether it is a comment, and its cells."""

    line: int
    content: str
    comment: bool
    cells: list[str]

    @property
    def kinds(self) -> list[str]:
        """What columns of these names hold; "" where that is not known."""
        return [kind_of(_split(cell)[0]) for cell in self.cells]

    def names_columns(self, sign: str) -> bool:
        """Whether it names columns whose cells ``sign`` parts; parameters and words of a remark do not."""
        if not self.comment:
            return "=" not in self.content
        listed = _sign(self.content) in (",", ";", sign) or not _ABSCISSAS.isdisjoint(self.kinds)
        return listed and all(map(is_name, self.cells)) and (any(self.kinds) or names_in_words(self.cells))


def _sign(content: str) -> str:
    """What parts the cells of a line: a semicolon, else a comma, else blanks."""
    return next((sign for sign in ";," if sign in content), " ")


def _names_and_units(
    headers: Sequence[_Header], width: int, sign: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of ``width`` columns that ``sign`` parts, from headers of as many cells.

    The first line with a known name counts (of a comment all must be known), else the first that names
    columns at all, comments last: unknown names are for the caller to refuse.
    """
    known = (i for i, one in enumerate(headers) if (all if one.comment else any)(one.kinds))
    named = [i for i, one in enumerate(headers) if one.names_columns(sign)]
    index = next(known, min(named, key=lambda i: headers[i].comment, default=None))
    if index is None:
        return ("",) * width, ("",) * width
    names, units = zip(*map(_split, headers[index].cells), strict=True)
    below = headers[index + 1 : index + 2]
    if not any(units) and below and below[0].comment == headers[index].comment:
        units = tuple(cell.strip() for cell in below[0].cells)
    return names, units


def _check_width(headers: Sequence[_Header], width: int, file: str) -> None:
    """Refuse names of columns, as far as they are no prose, that are more or fewer than ``width``."""
    for header in headers:
        kinds = set(header.kinds)
        prose = "" in kinds and (header.comment or not re.search("[;,\t]", header.content))
        if not prose and kinds & _ABSCISSAS and kinds - _ABSCISSAS - {""}:
            problem = f"{len(header.cells)} names, {cell_shown(','.join(header.cells))}, over {width} columns"
            allowed = "a name for each column, points in numbers"
            raise SceneError(f"line {header.line}", problem, allowed, file)


def cells_of_line(content: str, line: int, file: str, strict: bool = True) -> list[str]:
    """Cells of a line, parted by semicolons, else by commas, else by blanks; empty for a blank line.

    Names parted by tabs may hold blanks, and a unit in brackets is part of the name before it.

    Parameters
    ----------
    content : str
    line : int
        Its number, for errors.
    file : str
        Name of the file, for errors.
    strict : bool
        Whether a quotation mark out of place, or a row of numbers with decimal commas, is an error.

    Returns
    -------
    list of str
    """
    if not content.strip():
        return []
    if strict and "," in content:
        check_row(line, content, file, only_commas=False)
    if ";" in content:
        return [cell.strip() for cell in content.strip().rstrip(";").split(";")]
    if "," in content:
        try:
            return [
                cell.strip() for cell in next(csv.reader([content], strict=strict, skipinitialspace=True))
            ]
        except csv.Error as error:
            raise SceneError(f"line {line}", f"not CSV: {error}", "comma-separated cells", file) from None
    words = content.split()
    if any(map(is_number, words)):
        return words
    if "\t" in content.strip():
        return re.split(r"\s*\t\s*", content.strip())
    return _NAME_AND_UNIT.findall(content)


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
    named = any(table.names)
    found = cell_shown(",".join(table.names)) if named else f"{len(table.rows[0])} columns without names"
    return SceneError("columns", f"got {found}", KNOWN_NAMES, file)


def number_in_line(cell: str, line: int, file: str) -> float:
    """The number in a cell.

    Raises
    ------
    SceneError
        One line naming file and line, if there is none.
    """
    if not is_number(cell):
        raise SceneError(f"line {line}", f"got {cell_shown(cell)}", "a number, with a decimal point", file)
    return float(cell)


def checked_in_line(
    check: Callable[[Any, str], float], value: float, name: str, line: int, file: str
) -> float:
    """A number that passes ``check`` of :mod:`contact_scene.value_checks`, or its error with line and file.

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
