"""A scene as the table its file holds, any key of which can be changed: dotted paths with indices of lists.

``loading.steps.1.rate`` and ``loading.steps[1].rate`` are the same path.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path
from typing import Any

from contact_scene import Machine, Scene, SceneError, read_scene, scene_from_dict
from contact_scene.checked import Field, field_at
from contact_scene.errors import shown
from contact_scene.material_models import MODELS
from contact_scene.scene import scene_table
from validation import scenes

_INDEX = re.compile(r"\[(\d+)\]")


@dataclass(frozen=True)
class SceneTable:
    """Contents of a scene file.

    Parameters
    ----------
    name : str
    data : dict
        As parsed from TOML.
    folder : Path
        In which the tables that it names are looked up.
    """

    name: str
    data: dict[str, Any]
    folder: Path

    def scene(self, settings: Mapping[str, Any]) -> Scene:
        """The scene with other values at some paths; its title left out, so that equal scenes compare equal.

        Raises
        ------
        SceneError
            If there is no such key, or the scene refuses a value.
        """
        data = reduce(lambda table, item: put(table, *item), settings.items(), self.data)
        return replace(scene_from_dict(data, self.folder), title="")

    def field(self, path: str) -> Field | None:
        """What the scene declares at a path; ``None`` where it declares nothing."""
        place = parts(path)
        if place[0] == "machine":  # a table of its own in a file
            return field_at([Machine], {}, place[1:])
        found = field_at([Scene], self.data, place)
        if found is None and place[0] == "material":
            return field_at(MODELS, self.data.get("material"), place[1:])
        return found


def parts(path: str) -> tuple[str, ...]:
    """Keys and indices along a path."""
    return tuple(_INDEX.sub(r".\1", path).split("."))


def put(table: Any, path: str, value: Any) -> Any:
    """A copy of nested tables and lists with another value at a path; what is beside the path is shared.

    Tables on the way that do not exist are made: the reader of scenes knows which of them there may be.

    Parameters
    ----------
    table : dict or list
        As read from TOML.
    path : str
        Keys and places, with dots between.
    value : object

    Returns
    -------
    dict or list
    """
    return _put(table, parts(path), path, value)


def _put(table: Any, rest: tuple[str, ...], path: str, value: Any) -> Any:
    if not rest:
        return value
    key, after = rest[0], rest[1:]
    if isinstance(table, list):
        if not key.isdecimal() or int(key) >= len(table):
            allowed = f"an index from 0 to {len(table) - 1}" if table else "a path that exists"
            raise SceneError(path, f"the list has no entry {shown(key)}", allowed)
        index = int(key)
        return [*table[:index], _put(table[index], after, path, value), *table[index + 1 :]]
    if not isinstance(table, dict):
        raise SceneError(path, f"{shown(table)} has no keys", "a path to a value of the scene")
    if not key:
        raise SceneError(path, "has an empty part", "names and indices with dots between them")
    return {**table, key: _put(table.get(key, {}), after, path, value)}


def builtin_or_file(name: str, folder: Path) -> SceneTable:
    """The table of a built-in scene or of a scene file, looked up in ``folder``.

    Raises
    ------
    SceneError
        If there is neither, or the file is no valid scene.
    """
    known = name in scenes.names()
    file = scenes.FOLDER / f"{name}.toml" if known else folder / name
    if not known and not os.path.isfile(file):
        raise SceneError("scene", f"{shown(name)} is no built-in scene and no file", "either of them")
    read_scene(file)
    return SceneTable(name if known else file.stem, tomllib.loads(file.read_text("utf-8")), file.parent)


def of_scene(scene: Scene) -> SceneTable:
    """The table of a scene built in Python, its tables of numbers in it."""
    return SceneTable(scene.title or "scene", scene_table(scene), Path())
