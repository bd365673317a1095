"""Files of material data: Prony series, measured moduli and shift factors.

Series, which a scene takes as they are:

- ``pyvisco``: a coefficient table, see :func:`read_pyvisco`;
- ``reptate``: a mode file of RepTate ("Save Modes"): the number of modes, then number, relaxation time and
  **shear** modulus of each. It has no relaxed modulus;
- ``branches``: a table of relaxation time and branch modulus, ``tau, E`` (or ``G``).

Measured data, which :mod:`contact_scene.prony` turns into a series:

- ``relaxation``: time and relaxation modulus, ``t, E`` (pyvisco: ``t, E_relax``; RepTate: ``.gt``, whose
  ``sxy`` is the stress after a step of the strain ``gamma``);
- ``dynamic``: frequency, storage and loss modulus, ``w, E', E''`` (pyvisco: ``f, E_stor, E_loss``; RepTate:
  ``.tts``).

All are tables of :mod:`contact_scene.tables`. Names tell ``f`` (cycles per unit time) from ``w`` or
``omega`` (radians per unit time), and ``E`` from ``G``. Without names two columns are time and modulus, three
are angular frequency, storage and loss modulus, and the moduli are Young's (in RepTate's data files shear
moduli).
"""

from __future__ import annotations

import math
import os
import re
from typing import Any

import numpy as np

from contact_scene.errors import SceneError, cell_shown
from contact_scene.files import as_path, read_text
from contact_scene.material import Branch
from contact_scene.measured_moduli import DynamicData, RelaxationData
from contact_scene.tables import QUANTITIES, Array, Table, modulus_letter, read_table
from contact_scene.temperature_shift import ShiftTable
from contact_scene.value_checks import Range, finite, not_negative, number, one_of, positive

FORMATS = ("pyvisco", "reptate", "branches", "relaxation", "dynamic")
"""Kinds of material files."""

MEASURED = ("relaxation", "dynamic")
"""Those that hold measured data, not a series."""

SHEAR_FILES = (".tts", ".gt")
"""Ends of RepTate's data files, whose moduli are shear moduli."""

_COLUMNS = {
    "pyvisco": (
        ("relaxation time", "fraction"),
        ("relaxation time", "instantaneous modulus", "modulus"),
    ),
    "reptate": (("mode", "relaxation time", "modulus"),),
    "branches": (("relaxation time", "modulus"),),
    "relaxation": (("time", "stress"), ("time", "modulus")),
    "dynamic": (
        ("frequency", "storage modulus", "loss modulus"),
        ("angular frequency", "storage modulus", "loss modulus"),
    ),
    "shift": (("temperature", "log shift factor"), ("temperature", "shift factor")),
}
"""What the columns of each format hold, one of several ways; without names, the last."""

_WANTED = {
    "pyvisco": "tau_i and alpha_i, E_0, E_i (or G_0, G_i), as in a pyvisco coefficient file",
    "reptate": "a mode file: number of modes, then i, tau_i, G_i",
    "shift": "T, a_T | T, log_aT",
    "plain": "tau, E | t, E | f, E', E'' (f per unit time) | w, E', E'' (angular), with G for shear moduli",
}
"""The same in words."""

_RANGES = {
    "fraction": Range("0 <= alpha_i <= 1", 0.0, 1.0),
    "log shift factor": finite,
    "temperature": finite,
}
"""Of what is not positive."""

CONTRADICTION = 0.01
"""Difference of ``E_i`` from ``alpha_i E_0``, relative to ``E_0``, from which on they contradict each other:
a table rounded to two digits passes."""
EXHAUSTED = 1e-6
"""If ``1 - sum alpha_i`` is below this, it is rounding in the file, not a relaxed modulus."""


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


def read_shift_factors(path: str | os.PathLike[str]) -> ShiftTable:
    """Shift factors from a table with the columns ``T`` and ``a_T`` or ``log_aT`` (decadic)."""
    file = str(path)
    table = _table(read_text(as_path(path)), file, "shift")
    columns = _numbers(table, table.places(*_COLUMNS["shift"]))
    factors = columns.get("log shift factor")
    logarithms = map(math.log10, columns["shift factor"]) if factors is None else factors.tolist()
    try:
        return ShiftTable(tuple(columns["temperature"].tolist()), tuple(logarithms))
    except SceneError as error:
        raise error.in_file(file) from None


def format_of(text: str, file: str) -> str:
    """Which of ``FORMATS`` a text is in, by its header or the number of its columns."""
    head = text[:4000].lower()
    if "alpha_i" in head or ("tau_i" in head and re.search(r"\b[eg]_0\b", head)):
        return "pyvisco"
    first = next((row for row in head.split("\n") if row.strip() and not row.lstrip().startswith("#")), "")
    if re.search(r"#\s*(maxwell modes|number of modes)", head) or first.strip().isdecimal():
        return "reptate"
    table = _table(text, file, "plain")
    for kind in ("branches", *MEASURED):
        if any(set(wanted) <= set(table.kinds) for wanted in _COLUMNS[kind]):
            return kind
    by_width = {2: "relaxation", 3: "dynamic"}
    if any(table.names) or table.width not in by_width:
        raise table.unknown()
    return by_width[table.width]


def measured_data(text: str, file: str, format: str) -> RelaxationData | DynamicData:
    """Measured moduli from the text of a file in one of the formats ``MEASURED``, in any order of rows."""
    table, columns, shear = _plain(text, file, format)
    order = np.argsort(next(iter(columns.values())), kind="stable")
    columns = {kind: values[order] for kind, values in columns.items()}
    units = dict(zip(table.kinds, table.units, strict=True))
    if format == "relaxation":
        moduli = columns.get("modulus")
        if moduli is None:
            moduli = columns["stress"] / (table.stated("gamma", positive) or 1.0)
        shear = shear or "stress" in columns
        return RelaxationData(
            columns["time"],
            moduli,
            shear,
            (units.get("time", ""), units.get("modulus", units.get("stress", ""))),
        )
    omega = columns.get("angular frequency")
    if omega is None:
        omega = 2.0 * math.pi * columns["frequency"]
    frequency = units.get("frequency", units.get("angular frequency", "")).lower()
    stated = ("s" if frequency in ("hz", "rad/s", "1/s") else "", units.get("storage modulus", ""))
    return DynamicData(omega, columns["storage modulus"], columns["loss modulus"], shear, stated)


def branch_table(text: str, file: str, format: str) -> tuple[tuple[Branch, ...], bool]:
    """Branches from a text in the format "reptate" or "branches"; whether their moduli are shear moduli."""
    if format == "reptate":
        return _modes(text, file), True
    _, columns, shear = _plain(text, file, format)
    return _branches(columns["modulus"], columns["relaxation time"]), shear


def read_pyvisco(text: str, file: str, modulus: Any, poisson: Any) -> tuple[float, tuple[Branch, ...]]:
    """Relaxed Young's modulus and branches from the text of a pyvisco coefficient file.

    The table of pyvisco 2.1 (``df_prony.csv``) has a row of names, one of units and one a branch; other
    columns are ignored::

        i,tau_i,alpha_i,E_0,E_i
        -,s,-,MPa,MPa
        1,0.01,0.45,10.95,4.9275

    ``tau_i`` is a *relaxation* time, ``E_0`` the **instantaneous** modulus and ``alpha_i = E_i/E_0``, so that
    ``E(t) = E_0 (1 - sum_i alpha_i + sum_i alpha_i exp(-t/tau_i))``. Shear fits say ``G_0, G_i`` instead;
    then ``E = 2 (1 + nu) G``. ``modulus``, if not ``None``, is the relaxed Young's modulus: the instantaneous
    one is ``modulus/(1 - sum alpha_i)``, and ``E_0`` is not used. If ``sum alpha_i = 1``, as fits in the
    frequency domain usually have it, that ratio says nothing: then the branches share ``E_0 - modulus``.
    """
    times, fractions, glassy = _fractions(text, file, poisson)
    total = math.fsum(fractions)
    exhausted = 1.0 - total < EXHAUSTED
    if modulus is None:
        if glassy is None:
            allowed = "E_0 (or G_0) in the file, or modulus in the scene"
            raise SceneError("E_0", "the file has no such column", allowed, file)
        if exhausted:
            problem = "the sum is 1, which leaves nothing for the relaxed modulus"
            allowed = "a sum below 1, or the relaxed modulus as modulus in the scene"
            raise SceneError("alpha_i", problem, allowed, file)
        relaxed, scale = glassy * (1.0 - total), glassy
    else:
        relaxed = positive(modulus, "modulus")
        if not exhausted:
            scale = relaxed / (1.0 - total)
        elif glassy is None or glassy <= relaxed:
            instead = "the file has no E_0" if glassy is None else f"got {relaxed:g}, and E_0 is {glassy:g}"
            raise SceneError("modulus", instead, "a relaxed modulus below E_0, as the sum of alpha_i is 1")
        else:
            scale = (glassy - relaxed) / total
    return relaxed, _branches(scale * fractions, times)


def _fractions(text: str, file: str, poisson: Any) -> tuple[Array, Array, float | None]:
    """Relaxation times, fractions, and the instantaneous Young's modulus, if given, of a pyvisco table."""
    table = _table(text, file, "pyvisco")
    at = table.places(*_COLUMNS["pyvisco"])
    columns = _numbers(table, at, zero="modulus")
    glassy, moduli = columns.get("instantaneous modulus"), columns.get("modulus")
    if glassy is not None and np.ptp(glassy) > 0.0:
        name = table.names[at["instantaneous modulus"]]
        raise SceneError(name, "differs between rows", "the same value in every row", file)
    ratios = None if glassy is None or moduli is None else moduli / glassy
    fractions = columns.get("fraction", ratios)
    assert fractions is not None
    total = math.fsum(fractions)
    if total > 1.0 + EXHAUSTED:
        raise SceneError("alpha_i", f"the sum is {total:.7g}", "fractions with a sum of at most 1", file)
    if ratios is not None and (apart := np.abs(fractions - ratios) > CONTRADICTION).any():
        row = int(apart.argmax())
        wrong = f"alpha_i is {fractions[row]:g}, but E_i/E_0 is {ratios[row]:g}"
        raise SceneError(f"line {table.rows[row][0]}", wrong, "alpha_i = E_i/E_0", file)
    if glassy is None:
        return columns["relaxation time"], fractions, None
    shear = modulus_letter(table.names[at["instantaneous modulus"]]) == "G"
    nu = number(poisson, "poisson", "0 <= nu <= 0.5", low=0.0, high=0.5) if shear else -0.5
    return columns["relaxation time"], fractions, 2.0 * (1.0 + nu) * float(glassy[0])


def _modes(text: str, file: str) -> tuple[Branch, ...]:
    """Modes of RepTate, below their count, which files written by hand may leave out."""
    lines = [re.sub(r"(?<=\S)\s*#.*", "", row) for row in text.split("\n")]
    rows = (index for index, row in enumerate(lines) if not re.match(r"\s*(#|$)", row))
    first, announced = next(rows, 0), None
    counted = lines[first].strip()
    if counted.isdecimal() and len(counted) <= 6:
        announced, lines[first] = int(counted), f"# {counted}"
    table = _table("\n".join(lines), file, "reptate")
    (wanted,) = _COLUMNS["reptate"]
    if table.width != len(wanted):
        allowed = "the number of modes, then three: i, tau_i, G_i"
        raise SceneError(f"line {table.first}", f"{table.width} cells", allowed, file)
    if any(kind not in ("", own) for kind, own in zip(table.kinds, wanted, strict=True)):
        raise table.unknown()
    firsts = [(one.line, one.cells[0]) for one in table.head if not one.comment]
    for line, mode in [*firsts, *((line, cells[0]) for line, cells in table.rows)]:
        if not mode.isdecimal():
            allowed = "the number i of the mode, then tau_i, G_i"
            raise SceneError(f"line {line}", f"got {cell_shown(mode)} first", allowed, file)
    columns = _numbers(table, {"relaxation time": 1, "modulus": 2}, zero="modulus")
    if announced not in (None, len(table.rows)):
        problem = f"is {announced}, but there are {len(table.rows)} rows"
        raise SceneError("number of modes", problem, "as many rows", file)
    return _branches(columns["modulus"], columns["relaxation time"])


def _plain(text: str, file: str, format: str) -> tuple[Table, dict[str, Array], bool]:
    """A plain table, its columns by what they hold, and whether its moduli are shear moduli."""
    table = _table(text, file, "plain")
    if any(table.names):
        at = table.places(*_COLUMNS[format])
        wanted = next(w for w in _COLUMNS[format] if set(w) <= set(at))
        if {*table.kinds} - {*wanted, "temperature"}:
            raise table.unknown()
    else:
        wanted = _COLUMNS[format][-1]
        if table.width != len(wanted):
            raise table.unknown()
        at = dict(zip(wanted, range(table.width), strict=True))
    if "temperature" in at and np.ptp(table.column(at["temperature"])) > 0.0:
        raise SceneError("temperature", "differs between rows", "moduli at one temperature", file)
    letters = {modulus_letter(table.names[at[kind]]) for kind in wanted} - {""}
    if len(letters) > 1:
        raise SceneError("columns", f"got {cell_shown(','.join(table.names))}", "either E or G", file)
    for kind, contradiction in (("frequency", r"rad\W.*"), ("angular frequency", "hz")):
        unit = table.units[at[kind]] if kind in at else ""
        if re.fullmatch(contradiction, unit.lower()):
            raise SceneError("columns", f"{kind} in {unit}", "f in Hz, or w in rad/s", file)
    by_ending = format in MEASURED and not letters and file.endswith(SHEAR_FILES)
    zero = "modulus" if format == "branches" else ""
    return table, _numbers(table, {kind: at[kind] for kind in wanted}, zero), letters == {"G"} or by_ending


def _table(text: str, file: str, format: str) -> Table:
    """The table in a text of a format, or "plain" for any of the plain ones."""
    formats = ("branches", *MEASURED) if format == "plain" else (format,)
    kinds = {kind for one in formats for wanted in _COLUMNS[one] for kind in wanted}
    kinds |= {"temperature"} if format == "plain" else set()
    return read_table(text, file, [kind for kind in QUANTITIES if kind in kinds], _WANTED[format])


def _numbers(table: Table, at: dict[str, int], zero: str = "") -> dict[str, Array]:
    """Columns by what they hold, positive but for those in ``_RANGES`` and ``zero``, which may be 0."""
    ranges = _RANGES | {zero: not_negative}
    return {kind: table.column(place, ranges.get(kind, positive), kind) for kind, place in at.items()}


def _branches(moduli: Array, times: Array) -> tuple[Branch, ...]:
    return tuple(Branch(float(modulus), float(time)) for modulus, time in zip(moduli, times, strict=True))
