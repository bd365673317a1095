"""A material from a file, or from the table ``[material]``: a series given, in a file, or of a model."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

from contact_scene.checked import beside, check_keys, fields_of, from_table, required, under
from contact_scene.errors import SceneError, shown
from contact_scene.files import as_path, read_text
from contact_scene.material import Material
from contact_scene.material_models import MODELS
from contact_scene.prony import PronyFit, fit_prony, series_material, young_over
from contact_scene.readers import (
    FORMATS,
    MEASURED,
    branch_table,
    format_of,
    measured_data,
    read_pyvisco,
    read_shift_factors,
)
from contact_scene.temperature_shift import SHIFTS, Shift, ShiftTable, at_temperature
from contact_scene.value_checks import one_of, positive

LARGEST_MISFIT = 0.05
"""Root mean square of the relative residuals up to which measured data become a material without a look at
the fit. Rheometers scatter by less: beyond it no series meets the data."""
_COMMON = ("model", "poisson", "bulk", "temperature", "shift")


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
    """
    text, file = read_text(as_path(path)), str(path)
    kind = format_of(text, file) if format is None else one_of(format, "format", FORMATS)
    if kind == "pyvisco":
        relaxed, branches = read_pyvisco(text, file, modulus, poisson)
        return Material(relaxed, poisson, branches)
    if kind in MEASURED:
        return _fitted(text, file, kind, poisson, modulus)
    branches, shear = branch_table(text, file, kind)
    if modulus is None:
        raise SceneError("modulus", f"{file} has no relaxed modulus", "the relaxed Young's modulus, > 0")
    relaxed = positive(modulus, "modulus") / young_over(shear, poisson)
    return series_material(relaxed, branches, poisson, shear)


def _fitted(text: str, file: str, format: str, poisson: float, modulus: float | None) -> Material:
    data = measured_data(text, file, format)
    scale = young_over(data.shear, poisson)
    try:
        fit = fit_prony(data, relaxed=None if modulus is None else positive(modulus, "modulus") / scale)
        material = fit.material(poisson)
    except SceneError as error:
        raise error if error.key == "modulus" else error.in_file(file) from None
    if fit.misfit > LARGEST_MISFIT:
        raise SceneError(
            "",
            no_series_meets(fit),
            f"a misfit of at most {LARGEST_MISFIT:g}; `crosscontact material {file} --plot` draws it",
            file,
        )
    return material


def no_series_meets(fit: PronyFit) -> str:
    """What is wrong with data that the best series misses."""
    return f"no Prony series meets the data: misfit {fit.misfit:.2g}, at most {fit.largest_residual:.2g}"


def material_of(data: dict[str, Any], where: Path) -> Material:
    """The material of a table; files it names are looked up in the folder ``where``."""
    models = {kind.model: kind for kind in MODELS}
    model = one_of(data.get("model", "prony"), "model", ("prony", *models))
    own = (*fields_of(models[model]),) if model in models else ("modulus", "branches", "file", "format")
    check_keys(data, (*own, *_COMMON))
    poisson = required(data, "poisson", fields_of(Material)["poisson"].allowed("poisson"))
    stated = {key: data[key] for key in own if key in data}
    common = {key: data[key] for key in ("poisson", "bulk") if key in data}
    if model in models:
        modulus, branches = from_table([models[model]], stated | {"model": model}, where).series()
        material: Material = from_table(
            [Material], common | {"modulus": modulus, "branches": branches}, where
        )
    elif "file" in data:
        if "branches" in data:
            raise SceneError("branches", "given beside file", "either branches or file")
        form = one_of(data.get("format", "pyvisco"), "format", FORMATS)
        material = read_material(beside(where, data["file"]), poisson, data.get("modulus"), form)
        bulk = fields_of(Material)["bulk"].check(data.get("bulk"), "bulk", where)
        material = replace(material, bulk=bulk)
    else:
        if "format" in data:
            raise SceneError("format", "given without file", "file and format together")
        material = from_table([Material], common | stated, where)
    return _at_temperature(material, data, where)


def _at_temperature(material: Material, data: dict[str, Any], where: Path) -> Material:
    """The material at ``temperature``, where the scene gives one, and ``shift`` with it."""
    if "temperature" not in data and "shift" not in data:
        return material
    for key, other in (("shift", "temperature"), ("temperature", "shift")):
        if key not in data:
            raise SceneError(key, f"is missing beside {other}", "temperature and shift together")
    kinds = [kind.model for kind in (*SHIFTS, ShiftTable)]
    if not isinstance(data["shift"], dict):
        raise SceneError("shift", f"got {shown(data['shift'])}", f"a table with a model: {', '.join(kinds)}")
    shift = under("shift", lambda: _shift(data["shift"], kinds, where))
    return at_temperature(material, shift, data["temperature"])


def _shift(entry: dict[str, Any], kinds: list[str], where: Path) -> Shift:
    default = ShiftTable.model if "file" in entry else None
    if one_of(entry.get("model", default), "model", kinds) != ShiftTable.model:
        shift: Shift = from_table(SHIFTS, entry, where)
        return shift
    check_keys(entry, ("model", "file"))
    return read_shift_factors(beside(where, required(entry, "file", "a table of T and a_T or log_aT")))
