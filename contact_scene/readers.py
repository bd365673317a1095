"""Files of material data: Prony series, measured moduli and shift factors, each with one clear error.

Series, which a scene takes as they are:

- ``pyvisco``: a coefficient table, see :mod:`contact_scene.pyvisco`;
- ``reptate``: a mode file of RepTate ("Save Modes"): the number of modes, then number, relaxation time and
  **shear** modulus of each. It has no relaxed modulus;
- ``branches``: a plain table of relaxation time and branch modulus, ``tau, E`` (or ``G``).

Measured data, which :mod:`contact_scene.prony` turns into a series:

- ``relaxation``: time and relaxation modulus, ``t, E`` (pyvisco: ``t, E_relax``; RepTate: ``.gt``);
- ``dynamic``: frequency, storage and loss modulus, ``w, E', E''`` (pyvisco: ``f, E_stor, E_loss``; RepTate:
  ``.tts``).

Plain tables are text with cells parted by commas, semicolons or blanks. Lines without a number before the
first row are headers, and ``#`` starts a comment; the first of them with known names names the columns.
Names tell ``f`` (cycles per unit time) from ``w`` or ``omega`` (radians per unit time), and ``E`` from ``G``.
Without names two columns are time and modulus, three are angular frequency, storage and loss modulus, and the
moduli are Young's (in RepTate's data files shear moduli).
"""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import LARGEST, SMALLEST, SceneError, finite, not_negative, positive, shown
from contact_scene.files import read_text
from contact_scene.material import Branch
from contact_scene.temperature_shift import ShiftTable

FORMATS = ("pyvisco", "reptate", "branches", "relaxation", "dynamic")
"""Kinds of material files."""

MEASURED = ("relaxation", "dynamic")
"""Those that hold measured data, not a series."""

SHEAR_FILES = (".tts", ".gt")
"""Ends of RepTate's data files, whose moduli are shear moduli."""

_KINDS = {
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
"""Names of columns by what they hold, as :func:`_kind` compares them: E stands for G too."""

_TABLES = {
    "branches": (("relaxation time", "modulus"),),
    "relaxation": (("time", "modulus"),),
    "dynamic": (
        ("frequency", "storage modulus", "loss modulus"),
        ("angular frequency", "storage modulus", "loss modulus"),
    ),
}
"""Columns of each plain format."""

_NAMES = "tau, E | t, E | f, E', E'' (f per unit time) | w, E', E'' (angular), with G for shear moduli"


@dataclass(frozen=True)
class RelaxationData:
    """Measured relaxation modulus.

    Parameters
    ----------
    times : ndarray, shape (n,)
        > 0, ascending; the moment of the strain step is 0.
    moduli : ndarray, shape (n,)
        Relaxation modulus at these, > 0.
    shear : bool
        Whether they are shear moduli.
    units : pair of str
        Of time and stress, for labels; "" where the file names none.
    """

    times: NDArray[np.float64]
    moduli: NDArray[np.float64]
    shear: bool = False
    units: tuple[str, str] = ("", "")

    def __post_init__(self) -> None:
        _set_columns(self, ("times", "moduli"))


@dataclass(frozen=True)
class DynamicData:
    """Measured storage and loss modulus.

    Parameters
    ----------
    angular_frequencies : ndarray, shape (n,)
        > 0, ascending, radians per unit time.
    storage, loss : ndarray, shape (n,)
        > 0.
    shear : bool
        Whether they are shear moduli.
    units : pair of str
        Of time and stress, for labels; "" where the file names none.
    """

    angular_frequencies: NDArray[np.float64]
    storage: NDArray[np.float64]
    loss: NDArray[np.float64]
    shear: bool = False
    units: tuple[str, str] = ("", "")

    def __post_init__(self) -> None:
        _set_columns(self, ("angular_frequencies", "storage", "loss"))


@dataclass(frozen=True)
class BranchTable:
    """Branches as a file lists them.

    Parameters
    ----------
    branches : tuple of Branch
        In the order of the file.
    shear : bool
        Whether the moduli are shear moduli.
    """

    branches: tuple[Branch, ...]
    shear: bool = False


@dataclass(frozen=True)
class _Table:
    """A plain table: names of its columns, "" where there are none, and its numbers with their lines."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    lines: tuple[int, ...]
    rows: tuple[tuple[float, ...], ...]


def read_measured(path: str | os.PathLike[str], format: str | None = None) -> RelaxationData | DynamicData:
    """Measured moduli from a file, in whichever of the formats above; ``None``: told by its columns.

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong, what is allowed.
    """
    text, file = read_text(Path(path)), str(path)
    kind = format_of(text, file) if format is None else format
    if kind not in MEASURED:
        allowed = "measured data: time, modulus or frequency, storage, loss"
        raise SceneError("", f"holds a Prony series ({kind}), not measured data", allowed, file)
    return measured_data(text, file, kind)


def format_of(text: str, file: str) -> str:
    """Which of ``FORMATS`` a text is in, by its header or the number of its columns."""
    head = text[:4000].lower()
    if "alpha_i" in head or ("tau_i" in head and re.search(r"\b[eg]_0\b", head)):
        return "pyvisco"
    first = next((row for row in head.split("\n") if row.strip() and not row.lstrip().startswith("#")), "")
    if re.search(r"#\s*(maxwell modes|number of modes)", head) or first.strip().isdecimal():
        return "reptate"
    table = _table(text, file)
    for kind, alternatives in _TABLES.items():
        if any(set(wanted) <= set(map(_kind, table.names)) for wanted in alternatives):
            return kind
    if any(table.names):
        raise _unknown_columns(table, file)
    by_width = {2: "relaxation", 3: "dynamic"}
    if len(table.rows[0]) not in by_width:
        raise SceneError(f"line {table.lines[0]}", f"{len(table.rows[0])} columns", _NAMES, file)
    return by_width[len(table.rows[0])]


def measured_data(text: str, file: str, format: str) -> RelaxationData | DynamicData:
    """Measured moduli from the text of a file in the format "relaxation" or "dynamic".

    Frequencies in Hz become angular. Rows may come in any order, repeated ones included.
    """
    columns, letter, units = _columns(text, file, format)
    shear = letter == "G" or (letter == "" and file.endswith(SHEAR_FILES))
    order = np.argsort(next(iter(columns.values())), kind="stable")
    sorted_columns = {name: values[order] for name, values in columns.items()}
    if format == "relaxation":
        stress = units["modulus"]
        return RelaxationData(
            sorted_columns["time"], sorted_columns["modulus"], shear, (units["time"], stress)
        )
    omega, stress = sorted_columns.get("angular frequency"), units["storage modulus"]
    if omega is None:
        omega = 2.0 * math.pi * sorted_columns["frequency"]
    inverse = {"hz": "s", "rad/s": "s", "1/s": "s"}
    time = inverse.get(units.get("frequency", units.get("angular frequency", "")).lower(), "")
    storage, loss = sorted_columns["storage modulus"], sorted_columns["loss modulus"]
    return DynamicData(omega, storage, loss, shear, (time, stress))


def branch_table(text: str, file: str, format: str) -> BranchTable:
    """Branches from the text of a file in the format "reptate" or "branches"."""
    if format == "reptate":
        return BranchTable(_reptate_modes(text, file), shear=True)
    columns, letter, _ = _columns(text, file, format)
    pairs = zip(columns["modulus"], columns["relaxation time"], strict=True)
    return BranchTable(tuple(Branch(float(modulus), float(time)) for modulus, time in pairs), letter == "G")


def read_shift_factors(path: str | os.PathLike[str]) -> ShiftTable:
    """Shift factors from a table with the columns ``T`` and ``a_T`` or ``log_aT`` (decadic)."""
    text, file = read_text(Path(path)), str(path)
    table = _table(text, file)
    kinds = [_kind(name) for name in table.names]
    logarithmic = "log shift factor" in kinds
    wanted = "log shift factor" if logarithmic else "shift factor"
    if "temperature" not in kinds or wanted not in kinds:
        raise SceneError("columns", f"got {shown(','.join(table.names))}", "T, a_T | T, log_aT", file)
    at, of = kinds.index("temperature"), kinds.index(wanted)
    temperatures, factors = [], []
    for line, row in zip(table.lines, table.rows, strict=True):
        temperatures.append(_checked(finite, row[at], "T", line, file))
        check = finite if logarithmic else positive
        factor = _checked(check, row[of], table.names[of], line, file)
        factors.append(factor if logarithmic else math.log10(factor))
    try:
        return ShiftTable(tuple(temperatures), tuple(factors))
    except SceneError as error:
        raise error.in_file(file) from None


def _reptate_modes(text: str, file: str) -> tuple[Branch, ...]:
    """Rows of number, time and modulus after their count, which files written by hand may leave out."""
    rows = [
        (line, cells)
        for line, content in enumerate(text.split("\n"), 1)
        if (cells := _cells(content.partition("#")[0], line, file))
    ]
    if not rows:
        raise SceneError("", "the file is empty", "a mode file: number of modes, then i, tau_i, G_i", file)
    announced = None
    if len(rows[0][1]) == 1:
        line, (cell,) = rows.pop(0)
        if not cell.isdecimal() or len(cell) > 6:
            raise SceneError(f"line {line}", f"got {shown(cell)}", "the number of modes", file)
        announced = int(cell)
    branches = []
    for line, cells in rows:
        if len(cells) != 3:
            raise SceneError(f"line {line}", f"{len(cells)} cells", "three: i, tau_i, G_i", file)
        time, modulus = (_number(cell, line, file) for cell in cells[1:])
        branches.append(
            Branch(
                _checked(not_negative, modulus, "G_i", line, file),
                _checked(positive, time, "tau_i", line, file),
            )
        )
    if not branches:
        raise SceneError("tau_i", "no rows of numbers", "a row i, tau_i, G_i for each mode", file)
    if announced not in (None, len(branches)):
        raise SceneError(
            "number of modes", f"is {announced}, but there are {len(branches)} rows", "as many rows", file
        )
    return tuple(branches)


def _columns(text: str, file: str, format: str) -> tuple[dict[str, NDArray[np.float64]], str, dict[str, str]]:
    """Columns of a plain table by what they hold, checked; the letter of their moduli, if any; units."""
    table = _table(text, file)
    kinds = [_kind(name) for name in table.names]
    if any(kinds):
        wanted = next((w for w in _TABLES[format] if set(w) <= set(kinds)), None)
        if wanted is None or "" in kinds or any(kinds.count(kind) > 1 for kind in wanted):
            raise _unknown_columns(table, file)
    else:
        wanted = _TABLES[format][-1]
        if any(table.names) or len(table.rows[0]) != len(wanted):
            raise _unknown_columns(table, file)
        kinds = list(wanted)
    at = {kind: kinds.index(kind) for kind in wanted}
    letters = {letter for kind in wanted for letter in _letter(table.names[at[kind]])}
    if len(letters) > 1:
        raise SceneError("columns", f"got {shown(','.join(table.names))}", "either E or G", file)
    for kind, contradiction in (("frequency", r"rad\W.*"), ("angular frequency", "hz")):
        unit = table.units[at[kind]] if kind in at else ""
        if re.fullmatch(contradiction, unit.lower()):
            raise SceneError("columns", f"{kind} in {unit}", "f in Hz, or w in rad/s", file)
    columns: dict[str, NDArray[np.float64]] = {}
    for kind, index in at.items():
        zero = kind == "modulus" and format == "branches"
        name = table.names[index] or kind
        checked = [
            _checked(not_negative if zero else positive, row[index], name, line, file)
            for line, row in zip(table.lines, table.rows, strict=True)
        ]
        columns[kind] = np.array(checked)
    return columns, "".join(letters), {kind: table.units[index] for kind, index in at.items()}


def _table(text: str, file: str) -> _Table:
    """The numbers of a plain table and, where a line before them names its columns, these names."""
    headers: list[tuple[bool, list[str]]] = []
    lines: list[int] = []
    rows: list[tuple[float, ...]] = []
    for line, content in enumerate(text.split("\n"), 1):
        comment = content.lstrip().startswith("#")
        if comment and rows:
            continue
        cells = _cells(content.lstrip().lstrip("#") if comment else content, line, file, strict=not comment)
        if not cells:
            continue
        if comment or (not rows and not any(_is_number(cell) for cell in cells)):
            headers.append((comment, cells))
            continue
        rows.append(tuple(_number(cell, line, file) for cell in cells))
        lines.append(line)
        if len(rows[-1]) != len(rows[0]):
            allowed = f"{len(rows[0])}, as in line {lines[0]}"
            raise SceneError(f"line {line}", f"{len(rows[-1])} cells", allowed, file)
    if not rows:
        reason = "no rows of numbers" if headers else "the file is empty"
        raise SceneError("", reason, f"a table of numbers: {_NAMES}", file)
    names, units = _header([header for header in headers if len(header[1]) == len(rows[0])], len(rows[0]))
    return _Table(names, units, tuple(lines), tuple(rows))


def _header(headers: Sequence[tuple[bool, list[str]]], width: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names and units of ``width`` columns; a header is whether it is a comment, and as many cells.

    The first line with a known name counts (of a comment all must be known), else the first that is neither a
    comment nor a list of parameters (``Mw = 1000; T = 20``): unknown names are for the caller to refuse.
    """
    known = (
        i
        for i, (comment, cells) in enumerate(headers)
        if (all if comment else any)(_kind(_split(cell)[0]) for cell in cells)
    )
    plain = (i for i, (comment, cells) in enumerate(headers) if not comment and "=" not in "".join(cells))
    index = next(known, next(plain, None))
    if index is None:
        return ("",) * width, ("",) * width
    names, units = zip(*map(_split, headers[index][1]), strict=True)
    if not any(units) and index + 1 < len(headers) and not headers[index + 1][0]:
        units = tuple(cell.strip() for cell in headers[index + 1][1])
    return names, units


def _cells(content: str, line: int, file: str, strict: bool = True) -> list[str]:
    """Cells of a line, parted by semicolons, else by commas, else by blanks; empty for a blank line."""
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
    bracketed = re.search(r"[\[(]([^\])]*)[\])]", cell)
    unit = bracketed.group(1).strip() if bracketed else ""
    name = re.sub(r"[\[(][^\])]*[\])]", "", cell).strip().replace(" ", "_")
    return name, "" if unit in ("t", "w", "f", "omega", "ω") else unit


def _kind(name: str) -> str:
    """What a column of this name holds; "" if that is not known. ``t`` is a time, ``T`` a temperature."""
    if _letter(name):
        name = "E" + name[1:].lower()
    elif len(name) > 1:
        name = name.lower()
    return next((kind for kind, names in _KINDS.items() if name in names), "")


def _letter(name: str) -> str:
    """E or G, where the name of a column is that of a modulus."""
    return name[0] if re.fullmatch(r"[EG]('|\"|''|_\w+)?", name) else ""


def _unknown_columns(table: _Table, file: str) -> SceneError:
    names = ",".join(table.names) if any(table.names) else f"{len(table.rows[0])} columns without names"
    return SceneError("columns", f"got {shown(names)}", _NAMES, file)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _number(cell: str, line: int, file: str) -> float:
    if not _is_number(cell):
        raise SceneError(f"line {line}", f"got {shown(cell)}", "a number, with a decimal point", file)
    return float(cell)


def _checked(check: Callable[[Any, str], float], value: float, name: str, line: int, file: str) -> float:
    """A number that passes ``check`` of :mod:`contact_scene.errors`, or its error with line and file."""
    try:
        return float(check(value, f"{name}, line {line}"))
    except SceneError as error:
        raise error.in_file(file) from None


def _set_columns(data: RelaxationData | DynamicData, names: Sequence[str]) -> None:
    """Check the columns of measured data: numbers > 0, as many in each, ascending in the first."""
    for name in names:
        values = np.array(getattr(data, name), dtype=float)
        if values.ndim != 1 or values.size == 0 or values.shape != np.shape(getattr(data, names[0])):
            raise SceneError(name, f"shape {values.shape}", "as many numbers as in the other columns")
        if not ((values >= SMALLEST) & (values <= LARGEST)).all():
            index = int(np.argmin((values >= SMALLEST) & (values <= LARGEST)))
            positive(float(values[index]), f"{name}[{index}]")
        values.flags.writeable = False
        object.__setattr__(data, name, values)
    if np.any(np.diff(getattr(data, names[0])) < 0.0):
        raise SceneError(names[0], "decreases", "ascending values")
