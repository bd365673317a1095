"""Scenes as TOML files: reading with one-line errors.

Tables named in a scene (profiles, loading tables, material data) are looked up beside the scene file.
"""

from __future__ import annotations

import os
import tomllib
from functools import partial
from pathlib import Path
from typing import Any

from contact_scene.adhesion import Adhesion
from contact_scene.approach import Approach
from contact_scene.edge_rate import RATE_COLUMNS, PowerRate, RateTable
from contact_scene.errors import SceneError, shown
from contact_scene.files import as_path, read_pairs, read_text
from contact_scene.indenter import (
    PROFILE_COLUMNS,
    Cone,
    FlatPunch,
    Indenter,
    PowerLaw,
    Sphere,
    TabulatedProfile,
)
from contact_scene.load_steps import STEPS
from contact_scene.loading import STARTS, Loading
from contact_scene.machine import Machine
from contact_scene.material_table import material_of
from contact_scene.scene import Scene
from contact_scene.scene_tables import beside, built, check_keys, entries_of, required, table_of, under
from contact_scene.segment import Step
from contact_scene.table import QUANTITIES, Table
from contact_scene.value_checks import FINITE, a_string, one_of

SHAPES: dict[str, type[Indenter]] = {
    kind.shape: kind for kind in (Sphere, Cone, FlatPunch, PowerLaw, TabulatedProfile)
}
_ENTRIES: dict[str, type] = STEPS | {Approach.kind: Approach}
"""Kinds of entries in ``[[loading.steps]]``."""
_WITH_FILE = (TabulatedProfile, Table)
_PROFILE_KEYS = ("file",)
_TABLE_KEYS = ("file", "quantity", "interpolation")
"""What a scene gives of those whose numbers are in a file."""
_A_SCENE = "a scene: TOML tables [material], [indenter], [loading] and, if there is adhesion, [adhesion]"


def read_scene(path: str | os.PathLike[str]) -> Scene:
    """Read a scene from a TOML file.

    Raises
    ------
    SceneError
        One line: file, key, what is wrong, what is allowed.
    """
    file = as_path(path, "", "the name of a scene file")
    text = read_text(file)
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # ValueError also for integers of thousands of digits
        raise SceneError("", f"not a TOML file: {error}", _A_SCENE, str(path)) from None
    if not data:
        raise SceneError("", "the file is empty", _A_SCENE, str(path))
    try:
        return scene_from_dict(data, file.parent)
    except SceneError as error:
        raise error.in_file(str(path)) from None


def scene_from_dict(data: dict[str, Any], folder: str | os.PathLike[str] = ".") -> Scene:
    """Build a scene from the parsed contents of a scene file; tables are looked up in ``folder``."""
    where = as_path(folder, "folder", "the path of a folder")
    if not isinstance(data, dict):
        raise SceneError("", f"got {shown(data)}", _A_SCENE)
    check_keys(data, ("title", "material", "indenter", "adhesion", "machine", "loading"))
    title = a_string(data.get("title", ""), "title")
    material = under("material", lambda: material_of(table_of(data, "material"), where))
    indenter = under("indenter", lambda: _indenter(table_of(data, "indenter"), where))
    adhesion = None
    if "adhesion" in data:
        adhesion = under("adhesion", lambda: _adhesion(table_of(data, "adhesion"), where))
    machine = None
    if "machine" in data:
        machine = under("machine", lambda: built(Machine, table_of(data, "machine")))
    loading = under("loading", lambda: _loading(table_of(data, "loading"), where, machine))
    return Scene(material, indenter, loading, adhesion, title)


def _known_to_one(data: dict[str, Any], tag: str, kinds: dict[str, type], in_files: tuple[str, ...]) -> None:
    """A misspelt ``tag`` is told as such, not as one that is missing (``in_files``: keys beside a file)."""
    if tag not in data:
        names = [name for kind in kinds.values() if kind not in _WITH_FILE for name in entries_of(kind)]
        check_keys(data, dict.fromkeys((tag, *names, *in_files)))


def _adhesion(data: dict[str, Any], where: Path) -> Adhesion:
    check_keys(data, entries_of(Adhesion))
    if "stress" not in data:
        required(data, "zone", "a zone > 0, or a stress > 0 instead")
    elif "zone" in data:
        raise SceneError("stress", "given beside zone", "either zone or stress")
    if "rate" not in data:
        return built(Adhesion, data)
    if not isinstance(data["rate"], dict):
        raise SceneError("rate", f"got {shown(data['rate'])}", "a table { speed, exponent } or { file }")
    return built(Adhesion, data | {"rate": under("rate", partial(_edge_rate, data["rate"], where))})


def _edge_rate(entry: dict[str, Any], where: Path) -> PowerRate | RateTable:
    if "file" not in entry:
        return built(PowerRate, entry)
    check_keys(entry, ("file",))
    path = beside(where, entry["file"])
    speeds, works = read_pairs(path, RATE_COLUMNS)
    try:
        return RateTable(speeds, works, str(entry["file"]))
    except SceneError as error:
        raise error.in_file(str(path)) from None


def _indenter(data: dict[str, Any], where: Path) -> Indenter:
    _known_to_one(data, "shape", SHAPES, _PROFILE_KEYS)
    shape = one_of(required(data, "shape", ", ".join(SHAPES)), "shape", tuple(SHAPES))
    if shape != TabulatedProfile.shape:
        return built(SHAPES[shape], data, "shape")
    check_keys(data, ("shape", *_PROFILE_KEYS))
    path = beside(where, required(data, "file", "a CSV file of radius, height"))
    radii, heights = read_pairs(path, PROFILE_COLUMNS)
    try:
        return TabulatedProfile(radii, heights, str(data["file"]))
    except SceneError as error:
        raise error.in_file(str(path)) from None


def _loading(data: dict[str, Any], where: Path, machine: Machine | None) -> Loading:
    check_keys(data, ("start", "penetration", "steps"))
    start = one_of(required(data, "start", " | ".join(STARTS)), "start", STARTS)
    penetration = required(data, "penetration", FINITE)
    entries = data.get("steps", [])
    if not isinstance(entries, (list, tuple)):
        raise SceneError("steps", f"got {shown(entries)}", "[[loading.steps]] tables")
    steps = tuple(
        under(f"steps[{index}]", partial(_step, entry, where)) for index, entry in enumerate(entries)
    )
    return Loading(start, penetration, steps, machine)


def _step(entry: Any, where: Path) -> Step:
    if not isinstance(entry, dict):
        raise SceneError("", f"got {shown(entry)}", "a table with a kind")
    _known_to_one(entry, "kind", _ENTRIES, _TABLE_KEYS)
    kind = one_of(required(entry, "kind", ", ".join(_ENTRIES)), "kind", tuple(_ENTRIES))
    if kind != Table.kind:
        return built(_ENTRIES[kind], entry, "kind")
    check_keys(entry, ("kind", *_TABLE_KEYS))
    quantity = one_of(entry.get("quantity", QUANTITIES[0]), "quantity", QUANTITIES)
    path = beside(where, required(entry, "file", f"a CSV file of time, {quantity}"))
    times, values = read_pairs(path, ("time", quantity), [one for one in QUANTITIES if one != quantity])
    options = {key: entry[key] for key in ("quantity", "interpolation") if key in entry}
    try:
        return Table(times, values, str(entry["file"]), **options)
    except SceneError as error:
        raise error if error.key in options else error.in_file(str(path)) from None
