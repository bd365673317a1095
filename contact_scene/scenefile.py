"""Scenes as TOML files: reading with one-line errors, writing so that reading gives the same scene back.

Tables named in a scene (profiles, loading tables, material data) are looked up beside the scene file.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import MISSING, Field, asdict, fields
from functools import cache, partial
from pathlib import Path
from typing import Any

import tomli_w

from contact_scene.adhesion import Adhesion
from contact_scene.approach import Approach
from contact_scene.edge_rate import PowerRate, RateTable
from contact_scene.errors import FINITE, POSITIVE, SceneError, a_string, of_class, one_of, shown
from contact_scene.files import as_path, as_target, read_pairs, read_text, write_pairs, write_whole
from contact_scene.indenter import Cone, FlatPunch, Indenter, PowerLaw, Sphere, TabulatedProfile
from contact_scene.load_steps import STEPS
from contact_scene.loading import STARTS, Loading
from contact_scene.machine import Machine
from contact_scene.material import Branch, BulkRelaxation, Material
from contact_scene.material_file import read_material
from contact_scene.material_models import MODELS
from contact_scene.readers import FORMATS, read_shift_factors
from contact_scene.scene import Scene
from contact_scene.segment import Step
from contact_scene.table import QUANTITIES, Table
from contact_scene.temperature_shift import SHIFTS, WLF, Arrhenius, ShiftTable, at_temperature

_SHAPES: dict[str, type[Indenter]] = {
    kind.shape: kind for kind in (Sphere, Cone, FlatPunch, PowerLaw, TabulatedProfile)
}
_ENTRIES: dict[str, type] = STEPS | {Approach.kind: Approach}
"""Kinds of entries in ``[[loading.steps]]``."""
_WITH_FILE = (TabulatedProfile, Table)
_PROFILE_KEYS = ("file",)
_TABLE_KEYS = ("file", "quantity", "interpolation")
"""What a scene gives of those whose numbers are in a file."""
_RATE_COLUMNS = ("speed", "work")
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
    _known(data, "", ("title", "material", "indenter", "adhesion", "machine", "loading"))
    title = a_string(data.get("title", ""), "title")
    material = _under("material", lambda: _material(_table(data, "material"), where))
    indenter = _under("indenter", lambda: _indenter(_table(data, "indenter"), where))
    adhesion = None
    if "adhesion" in data:
        adhesion = _under("adhesion", lambda: _adhesion(_table(data, "adhesion"), where))
    machine = None
    if "machine" in data:
        machine = _under("machine", lambda: _build(Machine, _table(data, "machine")))
    loading = _under("loading", lambda: _loading(_table(data, "loading"), where, machine))
    return Scene(material, indenter, loading, adhesion, title)


def write_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write a scene as TOML (tables of profiles and loading go into CSV files beside it).

    Raises
    ------
    SceneError
        One line, if the path is none of a file that can be written.
    """
    of_class(scene, "scene", Scene, "a Scene")
    target = as_target(path)
    data: dict[str, Any] = {"title": scene.title, "material": _material_table(scene.material)}
    if isinstance(scene.indenter, TabulatedProfile):
        name = f"{target.stem}-profile.csv"
        write_pairs(
            target.with_name(name), ("radius", "height"), scene.indenter.radii, scene.indenter.heights
        )
        data["indenter"] = {"shape": TabulatedProfile.shape, "file": name}
    else:
        data["indenter"] = {"shape": scene.indenter.shape} | asdict(scene.indenter)  # type: ignore[call-overload]
    if scene.adhesion is not None:
        data["adhesion"] = _adhesion_table(scene.adhesion, target)
    if scene.machine is not None:
        data["machine"] = asdict(scene.machine)
    steps = []
    for index, step in enumerate(scene.loading.steps):
        if isinstance(step, Table):
            name = f"{target.stem}-loading-{index}.csv"
            write_pairs(target.with_name(name), ("time", step.quantity), step.times, step.values)
            said = {"quantity": step.quantity, "interpolation": step.interpolation}
            defaults = {f.name: f.default for f in fields(Table)}
            differing = {key: value for key, value in said.items() if value != defaults[key]}
            steps.append({"kind": step.kind, "file": name} | differing)
        else:
            entries = asdict(step)  # type: ignore[call-overload]
            steps.append({"kind": step.kind} | {k: v for k, v in entries.items() if v is not None})
    data["loading"] = {"start": scene.loading.start, "penetration": scene.loading.penetration, "steps": steps}
    write_whole(target, tomli_w.dumps(data))


def write_material(material: Material, path: str | os.PathLike[str], remark: str = "") -> None:
    """Write the table ``[material]`` of a scene file as TOML, below the lines of ``remark`` as comments.

    Raises
    ------
    SceneError
        One line, if the path is none of a file that can be written.
    """
    of_class(material, "material", Material, "a Material")
    comments = "".join(f"# {line}\n" for line in a_string(remark, "remark").splitlines())
    write_whole(
        as_target(path),
        comments + tomli_w.dumps({"material": _material_table(material)}),
    )


def _material_table(material: Material) -> dict[str, Any]:
    table: dict[str, Any] = {"modulus": material.modulus, "poisson": material.poisson}
    if material.branches:
        table["branches"] = [asdict(branch) for branch in material.branches]
    if isinstance(material.bulk, BulkRelaxation):
        bulk: dict[str, Any] = {} if material.bulk.modulus is None else {"modulus": material.bulk.modulus}
        table["bulk"] = bulk | {"branches": [asdict(branch) for branch in material.bulk.branches]}
    elif material.bulk is not None:
        table["bulk"] = material.bulk
    return table


def _adhesion_table(adhesion: Adhesion, target: Path) -> dict[str, Any]:
    table = {key: value for key, value in asdict(adhesion).items() if value is not None}
    if adhesion.stress is not None:
        del table["zone"]
    if isinstance(adhesion.rate, RateTable):
        name = f"{target.stem}-rate.csv"
        write_pairs(target.with_name(name), _RATE_COLUMNS, adhesion.rate.speeds, adhesion.rate.works)
        table["rate"] = {"file": name}
    return table


def _under(prefix: str, build: Callable[[], Any]) -> Any:
    try:
        return build()
    except SceneError as error:
        raise error if error.file else error.under(prefix) from None


def _known(data: dict[str, Any], prefix: str, allowed: Iterable[str]) -> None:
    names = tuple(allowed)
    for key in data:
        if key not in names:
            raise SceneError(f"{prefix}.{key}" if prefix else str(key), "unknown key", ", ".join(names))


def _known_to_one(data: dict[str, Any], tag: str, kinds: dict[str, type], in_files: tuple[str, ...]) -> None:
    """A misspelt ``tag`` is told as such, not as one that is missing (``in_files``: keys beside a file)."""
    if tag not in data:
        names = [name for kind in kinds.values() if kind not in _WITH_FILE for name in _entries(kind)]
        _known(data, "", dict.fromkeys((tag, *names, *in_files)))


def _table(data: dict[str, Any], key: str) -> dict[str, Any]:
    if key not in data:
        raise SceneError("", "is missing", f"a table [{key}]")
    if not isinstance(data[key], dict):
        raise SceneError("", f"got {shown(data[key])}", f"a table [{key}]")
    return data[key]


def _require(data: dict[str, Any], key: str, allowed: str) -> Any:
    if key not in data:
        raise SceneError(key, "is missing", allowed)
    return data[key]


@cache
def _entries(kind: type) -> dict[str, Field[Any]]:
    """Those of a dataclass that a file may give."""
    return {entry.name: entry for entry in fields(kind) if entry.init}


def _build(kind: type, data: dict[str, Any], tag: str | None = None) -> Any:
    """Construct a frozen dataclass from a table; ``tag`` is a key already dealt with."""
    known = _entries(kind)
    _known({k: v for k, v in data.items() if k != tag}, "", [*known, *([tag] if tag else [])])
    for name, entry in known.items():
        if name not in data and entry.default is MISSING:
            raise SceneError(name, "is missing", f"keys {', '.join(known)}")
    return kind(**{k: v for k, v in data.items() if k != tag})


def _branch_tuple(entries: Any, key: str) -> tuple[Branch, ...]:
    if not isinstance(entries, (list, tuple)):
        raise SceneError(key, f"got {shown(entries)}", "a list of tables { modulus, time }")
    branches = []
    for index, entry in enumerate(entries):
        if not isinstance(entry, dict):
            raise SceneError(f"{key}[{index}]", f"got {shown(entry)}", "a table { modulus, time }")
        branches.append(_under(f"{key}[{index}]", partial(_build, Branch, entry)))
    return tuple(branches)


def _material(data: dict[str, Any], where: Path) -> Material:
    common = ("model", "poisson", "bulk", "temperature", "shift")
    model = one_of(data.get("model", "prony"), "model", ("prony", *MODELS))
    own: tuple[str, ...] = ("modulus", "branches", "file", "format")
    if model in MODELS:
        own = tuple(f.name for f in fields(MODELS[model]))
    _known(data, "", (*own, *common))
    poisson = _require(data, "poisson", "0 <= nu <= 0.5")
    bulk = data.get("bulk")
    if isinstance(bulk, dict):
        table = bulk
        _known(table, "bulk", ("modulus", "branches"))
        branches = _branch_tuple(table.get("branches", []), "bulk.branches")
        bulk = _under("bulk", lambda: BulkRelaxation(table.get("modulus"), branches))
    modulus, prony = _series(model, {key: data[key] for key in own if key in data}, poisson, where)
    return _at_temperature(Material(modulus, poisson, prony, bulk), data, where)


def _series(model: str, data: dict[str, Any], poisson: Any, where: Path) -> tuple[Any, tuple[Branch, ...]]:
    """Relaxed modulus and branches, as given, from a file or of a model."""
    if model in MODELS:
        return _build(MODELS[model], data).series()
    if "file" in data:
        if "branches" in data:
            raise SceneError("branches", "given beside file", "either branches or file")
        form = one_of(data.get("format", "pyvisco"), "format", FORMATS)
        material = read_material(_beside(where, data["file"]), poisson, data.get("modulus"), form)
        return material.modulus, material.branches
    if "format" in data:
        raise SceneError("format", "given without file", "file and format together")
    modulus = _require(data, "modulus", POSITIVE)
    return modulus, _branch_tuple(data.get("branches", []), "branches")


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
    shift = _under("shift", partial(_shift, entry, where))
    return at_temperature(material, shift, data["temperature"])


def _shift(entry: dict[str, Any], where: Path) -> WLF | Arrhenius | ShiftTable:
    default = ShiftTable.model if "file" in entry else None
    model = one_of(entry.get("model", default), "model", (*SHIFTS, ShiftTable.model))
    if model in SHIFTS:
        return _build(SHIFTS[model], entry, "model")
    _known(entry, "", ("model", "file"))
    return read_shift_factors(_beside(where, _require(entry, "file", "a table of T and a_T or log_aT")))


def _adhesion(data: dict[str, Any], where: Path) -> Adhesion:
    _known(data, "", _entries(Adhesion))
    if "stress" not in data:
        _require(data, "zone", "a zone > 0, or a stress > 0 instead")
    elif "zone" in data:
        raise SceneError("stress", "given beside zone", "either zone or stress")
    if "rate" not in data:
        return _build(Adhesion, data)
    if not isinstance(data["rate"], dict):
        raise SceneError("rate", f"got {shown(data['rate'])}", "a table { speed, exponent } or { file }")
    return _build(Adhesion, data | {"rate": _under("rate", partial(_edge_rate, data["rate"], where))})


def _edge_rate(entry: dict[str, Any], where: Path) -> PowerRate | RateTable:
    if "file" not in entry:
        return _build(PowerRate, entry)
    _known(entry, "", ("file",))
    path = _beside(where, entry["file"])
    speeds, works = read_pairs(path, _RATE_COLUMNS)
    try:
        return RateTable(speeds, works, str(entry["file"]))
    except SceneError as error:
        raise error.in_file(str(path)) from None


def _indenter(data: dict[str, Any], where: Path) -> Indenter:
    _known_to_one(data, "shape", _SHAPES, _PROFILE_KEYS)
    shape = one_of(_require(data, "shape", ", ".join(_SHAPES)), "shape", tuple(_SHAPES))
    if shape != TabulatedProfile.shape:
        return _build(_SHAPES[shape], data, "shape")
    _known(data, "", ("shape", *_PROFILE_KEYS))
    path = _beside(where, _require(data, "file", "a CSV file of radius, height"))
    radii, heights = read_pairs(path, ("radius", "height"))
    try:
        return TabulatedProfile(radii, heights, str(data["file"]))
    except SceneError as error:
        raise error.in_file(str(path)) from None


def _loading(data: dict[str, Any], where: Path, machine: Machine | None) -> Loading:
    _known(data, "", ("start", "penetration", "steps"))
    start = one_of(_require(data, "start", " | ".join(STARTS)), "start", STARTS)
    penetration = _require(data, "penetration", FINITE)
    entries = data.get("steps", [])
    if not isinstance(entries, (list, tuple)):
        raise SceneError("steps", f"got {shown(entries)}", "[[loading.steps]] tables")
    steps = tuple(
        _under(f"steps[{index}]", partial(_step, entry, where)) for index, entry in enumerate(entries)
    )
    return Loading(start, penetration, steps, machine)


def _step(entry: Any, where: Path) -> Step:
    if not isinstance(entry, dict):
        raise SceneError("", f"got {shown(entry)}", "a table with a kind")
    _known_to_one(entry, "kind", _ENTRIES, _TABLE_KEYS)
    kind = one_of(_require(entry, "kind", ", ".join(_ENTRIES)), "kind", tuple(_ENTRIES))
    if kind != Table.kind:
        return _build(_ENTRIES[kind], entry, "kind")
    _known(entry, "", ("kind", *_TABLE_KEYS))
    quantity = one_of(entry.get("quantity", QUANTITIES[0]), "quantity", QUANTITIES)
    path = _beside(where, _require(entry, "file", f"a CSV file of time, {quantity}"))
    times, values = read_pairs(path, ("time", quantity), [one for one in QUANTITIES if one != quantity])
    options = {key: entry[key] for key in ("quantity", "interpolation") if key in entry}
    try:
        return Table(times, values, str(entry["file"]), **options)
    except SceneError as error:
        raise error if error.key in options else error.in_file(str(path)) from None


def _beside(where: Path, name: Any) -> Path:
    if not isinstance(name, str) or not name or "\0" in name:
        raise SceneError("file", f"got {shown(name)}", "the name of a file beside the scene")
    return where / name
