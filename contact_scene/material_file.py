"""A material from a file of material data, or from the table ``[material]``.

Every file is a table of :mod:`contact_scene.tables`; a format says what its columns hold. Series, which a
scene takes as they are:

- ``pyvisco``: coefficients as pyvisco 2.1 writes them (``df_prony.csv``), a row of names, one of units and
  one a branch: ``i,tau_i,alpha_i,E_0,E_i``. ``tau_i`` is a *relaxation* time, ``E_0`` the **instantaneous**
  modulus and ``alpha_i = E_i/E_0``, so that ``E(t) = E_0 (1 - sum_i alpha_i + sum_i alpha_i exp(-t/tau_i))``;
- ``reptate``: a mode file of RepTate ("Save Modes"): the number of modes, then number, relaxation time and
  **shear** modulus of each. It has no relaxed modulus;
- ``branches``: relaxation time and branch modulus, ``tau, E``.

Measured data, which :mod:`contact_scene.prony` turns into a series:

- ``relaxation``: time and relaxation modulus, ``t, E`` (pyvisco: ``t, E_relax``; RepTate: ``.gt``, whose
  ``sxy`` is the stress after a step of the strain ``gamma``);
- ``dynamic``: frequency, storage and loss modulus, ``w, E', E''`` (pyvisco: ``f, E_stor, E_loss``; RepTate:
  ``.tts``).

Names tell ``f`` (cycles per unit time) from ``w`` or ``omega`` (radians per unit time), and ``E`` from ``G``.
Without names two columns are time and modulus, three are angular frequency, storage and loss modulus, and the
moduli are Young's (in RepTate's data files shear moduli).
"""

from __future__ import annotations

import math
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from contact_scene.checked import Declaration, beside, check_keys, fields_of, from_table
from contact_scene.errors import SceneError, cell_shown
from contact_scene.files import as_path, read_text
from contact_scene.material import MODELS, Branch, Material
from contact_scene.prony import DynamicData, PronyFit, RelaxationData, fit_prony, series_material, young_over
from contact_scene.tables import Array, TextTable, modulus_letter, read_table
from contact_scene.temperature_shift import SHIFTS, at_temperature
from contact_scene.value_checks import Range, finite, not_negative, one_of, positive, whole_from

LARGEST_MISFIT = 0.05
"""Root mean square of the relative residuals up to which measured data become a material without a look at
the fit. Rheometers scatter by less: beyond it no series meets the data."""
CONTRADICTION = 0.01
"""Difference of ``E_i`` from ``alpha_i E_0``, relative to ``E_0``, from which on they contradict each other:
a table rounded to two digits passes."""
EXHAUSTED = 1e-6
"""If ``1 - sum alpha_i`` is below this, it is rounding in the file, not a relaxed modulus."""
SHEAR_FILES = (".tts", ".gt")
"""Ends of RepTate's data files, whose moduli are shear moduli."""
MEASURED = ("relaxation", "dynamic")
"""Formats of measured data; the others are of series, where a modulus may be zero: no branch."""


@dataclass(frozen=True)
class _Format:
    """What the columns of a file hold, one of several ways (without names, the last), and the same in words.

    ``beside``: what further known columns may hold; ``any_more``: others may stand there as well.
    """

    columns: tuple[tuple[str, ...], ...]
    wanted: str = (
        "tau, E | t, E | f, E', E'' (f per unit time) | w, E', E'' (angular), with G for shear moduli"
    )
    beside: tuple[str, ...] = ("temperature",)
    any_more: bool = False


FORMATS = {
    "pyvisco": _Format(
        (("relaxation time", "fraction"), ("relaxation time", "instantaneous modulus", "modulus")),
        "tau_i and alpha_i, E_0, E_i (or G_0, G_i), as in a pyvisco coefficient file",
        ("fraction", "instantaneous modulus", "modulus"),
        any_more=True,
    ),
    "reptate": _Format(
        (("mode", "relaxation time", "modulus"),),
        "a mode file: number of modes, then i, tau_i, G_i",
    ),
    "branches": _Format((("relaxation time", "modulus"),)),
    "relaxation": _Format((("time", "stress"), ("time", "modulus"))),
    "dynamic": _Format(
        (
            ("frequency", "storage modulus", "loss modulus"),
            ("angular frequency", "storage modulus", "loss modulus"),
        )
    ),
}
"""Kinds of material files."""
_KNOWN = sorted({kind for form in FORMATS.values() for way in (*form.columns, form.beside) for kind in way})
_RANGES: dict[str, Range] = {
    "fraction": Range("0 <= alpha_i <= 1", 0.0, 1.0),
    "temperature": finite,
    "mode": whole_from(0),
}
"""Of what is not positive."""


def read_material(
    path: str | os.PathLike[str],
    poisson: float = 0.5,
    modulus: float | None = None,
    format: str | None = None,
) -> Material:
    """A material from a Prony series or from measured moduli, which are fitted.

    Parameters
    ----------
    path : str or path
        A regular text file of at most 10 MB, in units of the scene.
    poisson : float
        Poisson's ratio; turns shear moduli into Young's.
    modulus : float, optional
        Relaxed Young's modulus. Needed where the file has none: modes of RepTate, plain tables of branches,
        measured data that go on relaxing to the end, some tables of pyvisco.
    format : str, optional
        One of ``FORMATS``; told by the columns of the file otherwise.

    Returns
    -------
    Material

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong, what is allowed.

    Examples
    --------
    >>> _ = Path("series.csv").write_text("tau,E\\n0.1,9e6\\n")
    >>> cc.read_material("series.csv", modulus=1e6).glassy_modulus
    10000000.0
    """
    text, file, kind = text_and_format(path, format)
    given = None if modulus is None else positive(modulus, "modulus")
    if kind in MEASURED:
        return _fitted(measured_data(text, file, kind), file, poisson, given)
    table, columns, shear = _columns(text, file, kind)
    scale = young_over(shear, poisson)
    if kind == "pyvisco":
        relaxed, moduli = _of_fractions(table, columns, given, scale)
    elif given is None:
        raise SceneError("modulus", f"{file} has no relaxed modulus", "the relaxed Young's modulus, > 0")
    else:
        relaxed, moduli = given, scale * columns["modulus"]
    pairs = zip(moduli.tolist(), columns["relaxation time"].tolist(), strict=True)
    return series_material(relaxed, [Branch(*pair) for pair in pairs], poisson, shear=False)


def read_measured(path: str | os.PathLike[str], format: str | None = None) -> RelaxationData | DynamicData:
    """Measured moduli from a file, in whichever of the formats above; ``None``: told by its columns.

    Raises
    ------
    SceneError
        One line: file, line or column, what is wrong, what is allowed.

    Examples
    --------
    >>> _ = Path("moduli.csv").write_text("t,E\\n0.1,9\\n1,5\\n10,2\\n")
    >>> cc.read_measured("moduli.csv").moduli
    array([9., 5., 2.])
    """
    text, file, kind = text_and_format(path, format)
    if kind not in MEASURED:
        allowed = "measured data: time, modulus or frequency, storage, loss"
        raise SceneError("", f"holds a Prony series ({kind}), not measured data", allowed, file)
    return measured_data(text, file, kind)


def text_and_format(
    path: str | os.PathLike[str], format: str | None, key: str = "format"
) -> tuple[str, str, str]:
    """The text of a file, its name, and which of ``FORMATS`` it is in; ``None``: told by its columns."""
    text, file = read_text(as_path(path)), str(path)
    return text, file, format_of(text, file) if format is None else one_of(format, key, FORMATS)


def format_of(text: str, file: str) -> str:
    """Which of ``FORMATS`` a text is in, by its header or the number of its columns."""
    count, text = _without_count(text)
    if count is not None or re.search(r"#\s*(maxwell modes|number of modes)", text[:4000].lower()):
        return "reptate"
    table = read_table(text, file, _KNOWN, FORMATS["branches"].wanted)
    for name, form in FORMATS.items():
        if any({*one} <= {*table.kinds} for one in form.columns):
            return name
    by_width = {2: "relaxation", 3: "dynamic"}
    if any(table.names) or table.width not in by_width:
        raise table.unknown()
    return by_width[table.width]


def measured_data(text: str, file: str, format: str) -> RelaxationData | DynamicData:
    """Measured moduli from the text of a file in one of the formats ``MEASURED``, in any order of rows."""
    table, columns, shear = _columns(text, file, format)
    units = dict(zip(table.kinds, table.units, strict=True))
    (across, points), *moduli = columns.items()
    order = np.argsort(points, kind="stable")
    points, values = points[order], [column[order] for _, column in moduli]
    stress = units.get(moduli[0][0], "")
    if format == "relaxation":
        if moduli[0][0] == "stress":
            values, shear = [values[0] / (table.stated("gamma", positive) or 1.0)], True
        return RelaxationData(points, values[0], shear, (units.get(across, ""), stress))
    time = "s" if units.get(across, "").lower() in ("hz", "rad/s", "1/s") else ""
    omega = 2.0 * math.pi * points if across == "frequency" else points
    return DynamicData(omega, values[0], values[1], shear, (time, stress))


def _columns(text: str, file: str, format: str) -> tuple[TextTable, dict[str, Array], bool]:
    """The table in a text, its columns by what they hold, and whether its moduli are shear moduli."""
    form, modes = FORMATS[format], format == "reptate"
    count, text = _without_count(text) if modes else (None, text)
    table = read_table(text, file, _KNOWN, form.wanted)
    if any(table.names) or form.any_more:
        at = table.places(*form.columns)
        wanted = next(one for one in form.columns if {*one} <= {*at})
        wanted = (*wanted, *(kind for kind in at if kind not in wanted and kind in form.beside))
        if not form.any_more and {*table.kinds} - {*wanted}:
            raise table.unknown()
    elif table.width != len(wanted := form.columns[-1]):
        raise table.unknown()
    else:
        at = {kind: place for place, kind in enumerate(wanted)}
    ranges = _RANGES if format in MEASURED else _RANGES | {"modulus": not_negative}
    columns = {kind: table.column(at[kind], ranges.get(kind, positive), kind) for kind in wanted}
    if np.ptp(columns.pop("temperature", np.zeros(1))) > 0.0:
        raise SceneError("temperature", "differs between rows", "moduli at one temperature", file)
    if count not in (None, len(table.rows)):
        problem = f"is {count}, but there are {len(table.rows)} rows"
        raise SceneError("number of modes", problem, "as many rows", file)
    letters = {modulus_letter(table.names[at[kind]]) for kind in columns} - {""}
    if len(letters) > 1 or (modes and "E" in letters):
        raise SceneError("columns", f"got {cell_shown(','.join(table.names))}", "either E or G", file)
    for kind, contradiction in (("frequency", r"rad\W.*"), ("angular frequency", "hz")):
        unit = table.units[at[kind]] if kind in at else ""
        if re.fullmatch(contradiction, unit.lower()):
            raise SceneError("columns", f"{kind} in {unit}", "f in Hz, or w in rad/s", file)
    of_reptate = modes or (format in MEASURED and file.endswith(SHEAR_FILES))
    return table, columns, "G" in letters or (of_reptate and not letters)


def _without_count(text: str) -> tuple[int | None, str]:
    """The number of modes in a line of its own above RepTate's modes, if it is there, and the text with that
    line as a comment."""
    found = re.match(r"((?:[^\S\n]*(?:#.*)?\n)*)([^\S\n]*(\d{1,6})[^\S\n]*\n)", text)
    if found is None:
        return None, text
    return int(found[3]), f"{found[1]}# {found[2]}{text[found.end() :]}"


def _of_fractions(
    table: TextTable, columns: dict[str, Array], relaxed: float | None, scale: float
) -> tuple[float, Array]:
    """Relaxed Young's modulus and Young's moduli of the branches of a pyvisco table.

    The instantaneous modulus is ``relaxed/(1 - sum alpha_i)``, if the relaxed one is given, else ``E_0``. If
    ``sum alpha_i = 1``, as fits in the frequency domain usually have it, that ratio says nothing: then the
    branches share ``E_0 - relaxed``.
    """
    file, glassy, ratios = table.file, None, None
    if (stated := columns.get("instantaneous modulus")) is not None:
        if np.ptp(stated) > 0.0:
            name = table.names[table.kinds.index("instantaneous modulus")]
            raise SceneError(name, "differs between rows", "the same value in every row", file)
        glassy = scale * float(stated[0])
        ratios = columns["modulus"] / stated if "modulus" in columns else None
    fractions = columns.get("fraction", ratios)
    assert fractions is not None  # the format has one or the other
    total = math.fsum(fractions)
    if total > 1.0 + EXHAUSTED:
        raise SceneError("alpha_i", f"the sum is {total:.7g}", "fractions with a sum of at most 1", file)
    if ratios is not None and (apart := np.abs(fractions - ratios) > CONTRADICTION).any():
        row = int(apart.argmax())
        wrong = f"alpha_i is {fractions[row]:g}, but E_i/E_0 is {ratios[row]:g}"
        raise SceneError(f"line {table.rows[row][0]}", wrong, "alpha_i = E_i/E_0", file)
    exhausted = 1.0 - total < EXHAUSTED
    if relaxed is not None and not exhausted:
        glassy = relaxed / (1.0 - total)
    if glassy is None:
        allowed = "E_0 (or G_0) in the file, or modulus in the scene where the sum of alpha_i is below 1"
        raise SceneError("E_0", "the file has no such column", allowed, file)
    if relaxed is None and exhausted:
        problem, allowed = "the sum is 1, which leaves nothing for the relaxed modulus", "a sum below 1"
        raise SceneError(
            "alpha_i", problem, f"{allowed}, or the relaxed modulus as modulus in the scene", file
        )
    if relaxed is None:
        relaxed = glassy * (1.0 - total)
    if exhausted and glassy <= relaxed:
        allowed = "a relaxed modulus below E_0, as the sum of alpha_i is 1"
        raise SceneError("modulus", f"got {relaxed:g}, and E_0 is {glassy:g}", allowed)
    return relaxed, ((glassy - relaxed) / total if exhausted else glassy) * fractions


def _fitted(data: RelaxationData | DynamicData, file: str, poisson: float, relaxed: float | None) -> Material:
    scale = young_over(data.shear, poisson)
    try:
        fit = fit_prony(data, relaxed=None if relaxed is None else relaxed / scale)
        material = fit.material(poisson)
    except SceneError as error:
        raise error if error.key == "modulus" else error.in_file(file) from None
    if fit.misfit > LARGEST_MISFIT:
        allowed = f"a misfit of at most {LARGEST_MISFIT:g}; `crosscontact material {file} --plot` draws it"
        raise SceneError("", no_series_meets(fit), allowed, file)
    return material


def no_series_meets(fit: PronyFit) -> str:
    """What is wrong with data that the best series misses."""
    return f"no Prony series meets the data: misfit {fit.misfit:.2g}, at most {fit.largest_residual:.2g}"


# The table [material] of a scene

_SHIFT = Declaration(classes=SHIFTS, kinds=SHIFTS)


def material_of(data: dict[str, Any], where: Path) -> Material:
    """The material of a table; files it names are looked up in the folder ``where``."""
    models = {kind.model: kind for kind in MODELS}
    model = one_of(data.get("model", "prony"), "model", ("prony", *models))
    own = (*fields_of(models[model]),) if model in models else ("modulus", "branches", "file", "format")
    check_keys(data, (*own, "model", "poisson", "bulk", "temperature", "shift"))
    if "poisson" not in data:
        raise SceneError("poisson", "is missing", fields_of(Material)["poisson"].allowed("poisson"))
    stated = {key: data[key] for key in own if key in data}
    if model in models:
        modulus, branches = from_table([models[model]], stated | {"model": model}, where).series()
        stated = {"modulus": modulus, "branches": branches}
    elif "file" in data:
        if "branches" in data:
            raise SceneError("branches", "given beside file", "either branches or file")
        form = one_of(data.get("format", "pyvisco"), "format", FORMATS)
        read = read_material(beside(where, data["file"]), data["poisson"], data.get("modulus"), form)
        stated = {"modulus": read.modulus, "branches": read.branches}
    elif "format" in data:
        raise SceneError("format", "given without file", "file and format together")
    stated |= {key: data[key] for key in ("poisson", "bulk") if key in data}
    material: Material = from_table([Material], stated, where)
    for key, other in (("shift", "temperature"), ("temperature", "shift")):
        if key not in data and other in data:
            raise SceneError(key, f"is missing beside {other}", "temperature and shift together")
    if "shift" not in data:
        return material
    shift = data["shift"]
    if isinstance(shift, dict) and "file" in shift:
        shift = {"model": "file"} | shift
    return at_temperature(material, _SHIFT.check(shift, "shift", where), data["temperature"])
