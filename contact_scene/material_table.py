"""The table ``[material]`` of a scene file: its series is given, in a file, or that of a model."""

from __future__ import annotations

from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError, shown
from contact_scene.material import Branch, BulkRelaxation, Material
from contact_scene.material_file import read_material
from contact_scene.material_models import MODELS
from contact_scene.readers import FORMATS, read_shift_factors
from contact_scene.scene_tables import beside, built, check_keys, required, under
from contact_scene.temperature_shift import SHIFTS, WLF, Arrhenius, ShiftTable, at_temperature
from contact_scene.value_checks import POSITIVE, one_of


def _branch_tuple(entries: Any) -> tuple[Branch, ...]:
    if not isinstance(entries, (list, tuple)):
        raise SceneError("branches", f"got {shown(entries)}", "a list of tables { modulus, time }")
    branches = []
    for index, entry in enumerate(entries):
        if not isinstance(entry, dict):
            raise SceneError(f"branches[{index}]", f"got {shown(entry)}", "a table { modulus, time }")
        branches.append(under(f"branches[{index}]", partial(built, Branch, entry)))
    return tuple(branches)


def material_of(data: dict[str, Any], where: Path) -> Material:
    """The material of a table; files it names are looked up in the folder ``where``.

    Raises
    ------
    SceneError
        With the key within the table.
    """
    common = ("model", "poisson", "bulk", "temperature", "shift")
    model = one_of(data.get("model", "prony"), "model", ("prony", *MODELS))
    own: tuple[str, ...] = ("modulus", "branches", "file", "format")
    if model in MODELS:
        own = tuple(f.name for f in fields(MODELS[model]))
    check_keys(data, (*own, *common))
    poisson = required(data, "poisson", "0 <= nu <= 0.5")
    bulk = data.get("bulk")
    if isinstance(bulk, dict):
        bulk = under("bulk", partial(_bulk, bulk))
    modulus, prony = _series(model, {key: data[key] for key in own if key in data}, poisson, where)
    return _at_temperature(Material(modulus, poisson, prony, bulk), data, where)


def _bulk(table: dict[str, Any]) -> BulkRelaxation:
    check_keys(table, ("modulus", "branches"))
    return BulkRelaxation(table.get("modulus"), _branch_tuple(table.get("branches", [])))


def _series(model: str, data: dict[str, Any], poisson: Any, where: Path) -> tuple[Any, tuple[Branch, ...]]:
    """Relaxed modulus and branches, as given, from a file or of a model."""
    if model in MODELS:
        return built(MODELS[model], data).series()
    if "file" in data:
        if "branches" in data:
            raise SceneError("branches", "given beside file", "either branches or file")
        form = one_of(data.get("format", "pyvisco"), "format", FORMATS)
        material = read_material(beside(where, data["file"]), poisson, data.get("modulus"), form)
        return material.modulus, material.branches
    if "format" in data:
        raise SceneError("format", "given without file", "file and format together")
    modulus = required(data, "modulus", POSITIVE)
    return modulus, _branch_tuple(data.get("branches", []))


def _at_temperature(material: Material, data: dict[str, Any], where: Path) -> Material:
    """The material at ``temperature``, where the scene gives one, and ``shift`` with it."""
    if "temperature" not in data and "shift" not in data:
        return material
    allowed = "temperature and shift together"
    for key, other in (("shift", "temperature"), ("temperature", "shift")):
        if key not in data:
            raise SceneError(key, f"is missing beside {other}", allowed)
    entry, kinds = data["shift"], (*SHIFTS, ShiftTable.model)
    if not isinstance(entry, dict):
        raise SceneError("shift", f"got {shown(entry)}", f"a table with a model: {', '.join(kinds)}")
    shift = under("shift", partial(_shift, entry, where))
    return at_temperature(material, shift, data["temperature"])


def _shift(entry: dict[str, Any], where: Path) -> WLF | Arrhenius | ShiftTable:
    default = ShiftTable.model if "file" in entry else None
    model = one_of(entry.get("model", default), "model", (*SHIFTS, ShiftTable.model))
    if model in SHIFTS:
        return built(SHIFTS[model], entry, "model")
    check_keys(entry, ("model", "file"))
    return read_shift_factors(beside(where, required(entry, "file", "a table of T and a_T or log_aT")))
