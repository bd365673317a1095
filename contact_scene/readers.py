"""Files of material data: Prony series, measured moduli and shift factors, each with one clear error.

Series, which a scene takes as they are:

- ``pyvisco``: a coefficient table, see :mod:`contact_scene.pyvisco`;
- ``reptate``: a mode file of RepTate ("Save Modes"): the number of modes, then number, relaxation time and
  **shear** modulus of each. It has no relaxed modulus;
- ``branches``: a plain table of relaxation time and branch modulus, ``tau, E`` (or ``G``).

Measured data, which :mod:`contact_scene.prony` turns into a series:

- ``relaxation``: time and relaxation modulus, ``t, E`` (pyvisco: ``t, E_relax``; RepTate: ``.gt``, whose
  ``sxy`` is the stress after a step of the strain ``gamma``);
- ``dynamic``: frequency, storage and loss modulus, ``w, E', E''`` (pyvisco: ``f, E_stor, E_loss``; RepTate:
  ``.tts``).

Plain tables are text with cells parted by commas, semicolons, tabs or blanks. Lines without a number before
the first row are headers, and ``#`` starts a comment; the first of them with known names names the columns.
Names tell ``f`` (cycles per unit time) from ``w`` or ``omega`` (radians per unit time), and ``E`` from ``G``.
Without names two columns are time and modulus, three are angular frequency, storage and loss modulus, and the
moduli are Young's (in RepTate's data files shear moduli).
"""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError, cell_shown
from contact_scene.files import as_path, read_text
from contact_scene.material import Branch
from contact_scene.measured_moduli import DynamicData, RelaxationData
from contact_scene.named_columns import (
    KNOWN_NAMES,
    checked_in_line,
    kind_of,
    modulus_letter,
    named_columns,
    unknown_columns,
)
from contact_scene.reptate import reptate_modes, shear_moduli
from contact_scene.temperature_shift import ShiftTable
from contact_scene.units import check_units
from contact_scene.value_checks import finite, not_negative, one_of, positive

FORMATS = ("pyvisco", "reptate", "branches", "relaxation", "dynamic")
"""Kinds of material files."""

MEASURED = ("relaxation", "dynamic")
"""Those that hold measured data, not a series."""

SHEAR_FILES = (".tts", ".gt")
"""Ends of RepTate's data files, whose moduli are shear moduli."""

_TABLES = {
    "branches": (("relaxation time", "modulus"),),
    "relaxation": (("time", "modulus"),),
    "dynamic": (
        ("frequency", "storage modulus", "loss modulus"),
        ("angular frequency", "storage modulus", "loss modulus"),
    ),
}
"""Columns of each plain format."""


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


def read_measured(path: str | os.PathLike[str], format: str | None = None) -> RelaxationData | DynamicData:
    """Measured moduli from a file, in whichever of the formats above; ``None``: told by its columns.

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong, what is allowed.
    """
    text, file = read_text(as_path(path)), str(path)
    kind = format_of(text, file) if format is None else one_of(format, "format", FORMATS)
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
    table = shear_moduli(named_columns(text, file), text, file)
    for kind, alternatives in _TABLES.items():
        if any(set(wanted) <= set(map(kind_of, table.names)) for wanted in alternatives):
            return kind
    if any(table.names):
        raise unknown_columns(table, file)
    by_width = {2: "relaxation", 3: "dynamic"}
    if len(table.rows[0]) not in by_width:
        raise SceneError(f"line {table.lines[0]}", f"{len(table.rows[0])} columns", KNOWN_NAMES, file)
    return by_width[len(table.rows[0])]


def measured_data(text: str, file: str, format: str) -> RelaxationData | DynamicData:
    """Measured moduli from the text of a file in the format "relaxation" or "dynamic".

    Frequencies in Hz become angular. Rows may come in any order, repeated ones included.

    Parameters
    ----------
    text : str
        Of the file.
    file : str
        Its name, for messages; by its ending some files hold shear moduli.
    format : "relaxation" or "dynamic"

    Returns
    -------
    RelaxationData or DynamicData
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
    """Branches from the text of a file in the format "reptate" or "branches".

    Parameters
    ----------
    text, file
        As of :func:`measured_data`.
    format : "reptate" or "branches"

    Returns
    -------
    BranchTable
    """
    if format == "reptate":
        return BranchTable(reptate_modes(text, file), shear=True)
    columns, letter, _ = _columns(text, file, format)
    pairs = zip(columns["modulus"], columns["relaxation time"], strict=True)
    return BranchTable(tuple(Branch(float(modulus), float(time)) for modulus, time in pairs), letter == "G")


def read_shift_factors(path: str | os.PathLike[str]) -> ShiftTable:
    """Shift factors from a table with the columns ``T`` and ``a_T`` or ``log_aT`` (decadic)."""
    text, file = read_text(as_path(path)), str(path)
    table = named_columns(text, file)
    kinds = [kind_of(name) for name in table.names]
    logarithmic = "log shift factor" in kinds
    wanted = "log shift factor" if logarithmic else "shift factor"
    if "temperature" not in kinds or wanted not in kinds:
        raise SceneError("columns", f"got {cell_shown(','.join(table.names))}", "T, a_T | T, log_aT", file)
    check_units(zip(kinds, table.units, strict=True), "columns", file)
    at, of = kinds.index("temperature"), kinds.index(wanted)
    temperatures, factors = [], []
    for line, row in zip(table.lines, table.rows, strict=True):
        temperatures.append(checked_in_line(finite, row[at], "T", line, file))
        check = finite if logarithmic else positive
        factor = checked_in_line(check, row[of], table.names[of], line, file)
        factors.append(factor if logarithmic else math.log10(factor))
    try:
        return ShiftTable(tuple(temperatures), tuple(factors))
    except SceneError as error:
        raise error.in_file(file) from None


def _columns(text: str, file: str, format: str) -> tuple[dict[str, NDArray[np.float64]], str, dict[str, str]]:
    """Columns of a plain table by what they hold, checked; the letter of their moduli, if any; units."""
    table = shear_moduli(named_columns(text, file), text, file)
    kinds = [kind_of(name) for name in table.names]
    if any(kinds):
        wanted = next((w for w in _TABLES[format] if set(w) <= set(kinds)), None)
        if wanted is None or {*kinds} - {*wanted, "temperature"} or len({*kinds}) < len(kinds):
            raise unknown_columns(table, file)
    else:
        wanted = _TABLES[format][-1]
        if any(table.names) or len(table.rows[0]) != len(wanted):
            raise unknown_columns(table, file)
        kinds = list(wanted)
    if "temperature" in kinds and len({row[kinds.index("temperature")] for row in table.rows}) > 1:
        raise SceneError("temperature", "differs between rows", "moduli at one temperature", file)
    check_units(zip(kinds, table.units, strict=True), "columns", file)
    at = {kind: kinds.index(kind) for kind in wanted}
    letters = {letter for kind in wanted for letter in modulus_letter(table.names[at[kind]])}
    if len(letters) > 1:
        raise SceneError("columns", f"got {cell_shown(','.join(table.names))}", "either E or G", file)
    for kind, contradiction in (("frequency", r"rad\W.*"), ("angular frequency", "hz")):
        unit = table.units[at[kind]] if kind in at else ""
        if re.fullmatch(contradiction, unit.lower()):
            raise SceneError("columns", f"{kind} in {unit}", "f in Hz, or w in rad/s", file)
    columns: dict[str, NDArray[np.float64]] = {}
    for kind, index in at.items():
        zero = kind == "modulus" and format == "branches"
        name = table.names[index] or kind
        checked = [
            checked_in_line(not_negative if zero else positive, row[index], name, line, file)
            for line, row in zip(table.lines, table.rows, strict=True)
        ]
        columns[kind] = np.array(checked)
    return columns, "".join(letters), {kind: table.units[index] for kind, index in at.items()}
