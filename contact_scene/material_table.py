"""The table ``[material]`` of a scene file: its series is given, in a file, or that of a model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

from contact_scene.checked import beside, check_keys, fields_of, from_table, required, under
from contact_scene.errors import SceneError, shown
from contact_scene.material import Material
from contact_scene.material_file import read_material
from contact_scene.material_models import MODELS
from contact_scene.readers import FORMATS, read_shift_factors
from contact_scene.temperature_shift import SHIFTS, Shift, ShiftTable, at_temperature
from contact_scene.value_checks import one_of

_COMMON = ("model", "poisson", "bulk", "temperature", "shift")


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
