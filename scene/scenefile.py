"""Scenes as TOML files: reading with one-line errors, writing so that reading gives the same scene back.

Tables named in a scene (profiles, loading tables, material data) are looked up beside the scene file.
"""

from __future__ import annotations

import csv
import os
import tomllib
from collections.abc import Callable, Iterable
from dataclasses import fields
from pathlib import Path
from typing import Any

from scene.adhesion import Adhesion
from scene.errors import SceneError, one_of
from scene.indenter import Cone, FlatPunch, Indenter, PowerLaw, Profile, Sphere
from scene.loading import STARTS, STEPS, Loading, Step, Table
from scene.material import Branch, BulkRelaxation, Material
from scene.pyvisco import read_pyvisco
from scene.scene import Scene

_SHAPES: dict[str, type[Indenter]] = {
    kind.shape: kind for kind in (Sphere, Cone, FlatPunch, PowerLaw, Profile)
}
_TOO_LARGE = 10_000_000  # bytes; a scene or a table beyond this is a mistake


def read_scene(path: str | os.PathLike[str]) -> Scene:
    """Read a scene from a TOML file.

    Raises
    ------
    SceneError
        One line: file, key, what is wrong, what is allowed.
    """
    file = Path(path)
    text = _text(file, str(path))
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise SceneError("", f"not a TOML file: {error}", "a scene as in the README", str(path)) from None
    if not data:
        raise SceneError("", "the file is empty", "a scene as in the README", str(path))
    try:
        return scene_from_dict(data, file.parent)
    except SceneError as error:
        raise error.in_file(str(path)) from None


def scene_from_dict(data: dict[str, Any], folder: str | os.PathLike[str] = ".") -> Scene:
    """Build a scene from the parsed contents of a scene file; tables are looked up in ``folder``."""
    where = Path(folder)
    _known(data, "", ("title", "material", "indenter", "adhesion", "loading"))
    title = data.get("title", "")
    if not isinstance(title, str):
        raise SceneError("title", f"got {title!r:.40}", "a string")
    material = _under("material", lambda: _material(_table(data, "material"), where))
    indenter = _under("indenter", lambda: _indenter(_table(data, "indenter"), where))
    adhesion = None
    if "adhesion" in data:
        adhesion = _under("adhesion", lambda: _build(Adhesion, _table(data, "adhesion")))
    loading = _under("loading", lambda: _loading(_table(data, "loading"), where))
    return Scene(material, indenter, loading, adhesion, title)


def write_scene(scene: Scene, path: str | os.PathLike[str]) -> None:
    """Write a scene as TOML (tables of profiles and loading go into CSV files beside it)."""
    target = Path(path)
    lines = [f"title = {_quoted(scene.title)}", "", "[material]"]
    material = scene.material
    lines += [f"modulus = {material.modulus!r}", f"poisson = {material.poisson!r}"]
    if material.branches:
        lines.append(f"branches = {_branch_list(material.branches)}")
    if material.bulk == "elastic":
        lines.append('bulk = "elastic"')
    elif isinstance(material.bulk, BulkRelaxation):
        inner = [] if material.bulk.modulus is None else [f"modulus = {material.bulk.modulus!r}"]
        inner.append(f"branches = {_branch_list(material.bulk.branches)}")
        lines.append("bulk = { " + ", ".join(inner) + " }")
    lines += ["", "[indenter]", f'shape = "{scene.indenter.shape}"']
    if isinstance(scene.indenter, Profile):
        name = f"{target.stem}-profile.csv"
        _write_table(
            target.with_name(name), ("radius", "height"), scene.indenter.radii, scene.indenter.heights
        )
        lines.append(f"file = {_quoted(name)}")
    else:
        lines += _keys(scene.indenter)
    if scene.adhesion is not None:
        lines += ["", "[adhesion]", *_keys(scene.adhesion)]
    lines += [
        "",
        "[loading]",
        f'start = "{scene.loading.start}"',
        f"penetration = {scene.loading.penetration!r}",
    ]
    for index, step in enumerate(scene.loading.steps):
        lines += ["", "[[loading.steps]]", f'kind = "{step.kind}"']
        if isinstance(step, Table):
            name = f"{target.stem}-loading-{index}.csv"
            _write_table(target.with_name(name), ("time", "penetration"), step.times, step.penetrations)
            lines.append(f"file = {_quoted(name)}")
        else:
            lines += _keys(step)
    target.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _text(file: Path, shown: str) -> str:
    try:
        if file.is_dir():
            raise SceneError("", "is a folder", "a TOML file", shown)
        if file.stat().st_size > _TOO_LARGE:
            raise SceneError("", "is larger than 10 MB", "a scene or a table of moderate size", shown)
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise SceneError("", "not a text file (no UTF-8)", "UTF-8 text", shown) from None
    except (OSError, ValueError) as error:
        if isinstance(error, SceneError):
            raise
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError("", f"cannot be read: {reason}", "an existing, readable file", shown) from None


def _under(prefix: str, build: Callable[[], Any]) -> Any:
    try:
        return build()
    except SceneError as error:
        raise error if error.file else error.under(prefix) from None


def _known(data: dict[str, Any], prefix: str, allowed: Iterable[str]) -> None:
    names = tuple(allowed)
    for key in data:
        if key not in names:
            shown = f"{prefix}.{key}" if prefix else key
            raise SceneError(shown, "unknown key", ", ".join(names))


def _table(data: dict[str, Any], key: str) -> dict[str, Any]:
    if key not in data:
        raise SceneError("", "is missing", f"a table [{key}]")
    if not isinstance(data[key], dict):
        raise SceneError("", f"got {data[key]!r:.40}", f"a table [{key}]")
    return data[key]


def _require(data: dict[str, Any], key: str, allowed: str) -> Any:
    if key not in data:
        raise SceneError(key, "is missing", allowed)
    return data[key]


def _build(kind: type, data: dict[str, Any], tag: str | None = None) -> Any:
    """Construct a frozen dataclass from a table; ``tag`` is a key already dealt with."""
    from dataclasses import MISSING

    known = {f.name: f for f in fields(kind) if f.init}
    _known({k: v for k, v in data.items() if k != tag}, "", [*known, *([tag] if tag else [])])
    for name, entry in known.items():
        if name not in data and entry.default is MISSING:
            raise SceneError(name, "is missing", f"keys {', '.join(known)}")
    return kind(**{k: v for k, v in data.items() if k != tag})


def _branch_tuple(given: Any, key: str) -> tuple[Branch, ...]:
    if not isinstance(given, list):
        raise SceneError(key, f"got {given!r:.40}", "a list of tables { modulus, time }")
    branches = []
    for index, entry in enumerate(given):
        if not isinstance(entry, dict):
            raise SceneError(f"{key}[{index}]", f"got {entry!r:.40}", "a table { modulus, time }")
        branches.append(_under(f"{key}[{index}]", lambda entry=entry: _build(Branch, entry)))
    return tuple(branches)


def _material(data: dict[str, Any], where: Path) -> Material:
    _known(data, "", ("modulus", "poisson", "branches", "bulk", "file", "format"))
    poisson = _require(data, "poisson", "0 <= nu <= 0.5")
    bulk = data.get("bulk")
    if isinstance(bulk, dict):
        table = bulk
        _known(table, "bulk", ("modulus", "branches"))
        branches = _branch_tuple(table.get("branches", []), "bulk.branches")
        bulk = _under("bulk", lambda: BulkRelaxation(table.get("modulus"), branches))
    elif bulk is not None and bulk != "elastic":
        raise SceneError("bulk", f"got {bulk!r:.40}", '"elastic" or a table { modulus, branches }')
    if "file" in data:
        if "branches" in data:
            raise SceneError("branches", "given beside file", "either branches or file")
        one_of(data.get("format", "pyvisco"), "format", ("pyvisco",))
        path = _beside(where, data["file"])
        modulus, prony = read_pyvisco(_text(path, str(path)), str(path), data.get("modulus"), poisson)
        return Material(modulus, poisson, prony, bulk)
    if "format" in data:
        raise SceneError("format", "given without file", "file and format together")
    modulus = _require(data, "modulus", "a finite number > 0")
    return Material(modulus, poisson, _branch_tuple(data.get("branches", []), "branches"), bulk)


def _indenter(data: dict[str, Any], where: Path) -> Indenter:
    shape = one_of(_require(data, "shape", ", ".join(_SHAPES)), "shape", tuple(_SHAPES))
    if shape != Profile.shape:
        return _build(_SHAPES[shape], data, "shape")
    _known(data, "", ("shape", "file"))
    path = _beside(where, _require(data, "file", "a CSV file of radius, height"))
    radii, heights = _two_columns(path)
    try:
        return Profile(radii, heights, str(data["file"]))
    except SceneError as error:
        raise SceneError("", error.problem, error.allowed, str(path)) from None


def _loading(data: dict[str, Any], where: Path) -> Loading:
    _known(data, "", ("start", "penetration", "steps"))
    start = one_of(_require(data, "start", " | ".join(STARTS)), "start", STARTS)
    penetration = _require(data, "penetration", "a finite number")
    given = data.get("steps", [])
    if not isinstance(given, list):
        raise SceneError("steps", f"got {given!r:.40}", "[[loading.steps]] tables")
    steps = tuple(
        _under(f"steps[{index}]", lambda entry=entry: _step(entry, where))
        for index, entry in enumerate(given)
    )
    return Loading(start, penetration, steps)


def _step(entry: Any, where: Path) -> Step:
    if not isinstance(entry, dict):
        raise SceneError("", f"got {entry!r:.40}", "a table with a kind")
    kind = one_of(_require(entry, "kind", ", ".join(STEPS)), "kind", tuple(STEPS))
    if kind != Table.kind:
        return _build(STEPS[kind], entry, "kind")
    _known(entry, "", ("kind", "file"))
    path = _beside(where, _require(entry, "file", "a CSV file of time, penetration"))
    times, penetrations = _two_columns(path)
    try:
        return Table(times, penetrations, str(entry["file"]))
    except SceneError as error:
        raise SceneError("", error.problem, error.allowed, str(path)) from None


def _beside(where: Path, name: Any) -> Path:
    if not isinstance(name, str) or not name or "\0" in name:
        raise SceneError("file", f"got {name!r:.40}", "the name of a file beside the scene")
    return where / name


def _two_columns(path: Path) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Two columns of numbers from a CSV; comments (#) and one header line are allowed."""
    shown = str(path)
    lines = [
        line for line in _text(path, shown).splitlines() if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise SceneError("", "the file is empty", "rows of two numbers", shown)
    first: list[float] = []
    second: list[float] = []
    for row, cells in enumerate(csv.reader(lines), 1):
        try:
            if len(cells) != 2:
                raise ValueError
            pair = float(cells[0]), float(cells[1])
        except ValueError:
            if row == 1 and len(cells) == 2 and not first:
                continue
            raise SceneError(
                "", f"row {row} is {','.join(cells)!r:.40}", "two numbers a row", shown
            ) from None
        first.append(pair[0])
        second.append(pair[1])
    return tuple(first), tuple(second)


def _write_table(
    path: Path, header: tuple[str, str], first: Iterable[float], second: Iterable[float]
) -> None:
    rows = [",".join(header)] + [f"{a!r},{b!r}" for a, b in zip(first, second, strict=True)]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def _branch_list(branches: Iterable[Branch]) -> str:
    return "[" + ", ".join(f"{{ modulus = {b.modulus!r}, time = {b.time!r} }}" for b in branches) + "]"


def _keys(thing: Any) -> list[str]:
    return [f"{f.name} = {getattr(thing, f.name)!r}" for f in fields(thing)]


def _quoted(text: str) -> str:
    """A TOML basic string."""
    escaped = "".join(
        {"\\": "\\\\", '"': '\\"'}.get(c, c if c >= " " and c != "\x7f" else f"\\u{ord(c):04x}") for c in text
    )
    return f'"{escaped}"'
