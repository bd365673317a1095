"""Numbers of a scene by dotted path, as in a scene file: ``adhesion.work``, ``material.branches[0].time``.

A path names fields of the scene and places in its lists, counted from 0, in brackets or between dots
(``loading.steps.1.rate``). Several numbers are put in together, so that a scene is checked once it is whole.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

from contact_scene.errors import SceneError, shown
from contact_scene.scene import Scene

_PART = re.compile(r"([A-Za-z_]\w*)((?:\[\d+\])*)")


def value_at(scene: Scene, path: str) -> float:
    """The number at a path."""
    at: Any = scene
    passed = ""
    for key in _keys(path):
        at = _entry(at, key, passed, path)
        passed = _joined(passed, key)
    if isinstance(at, bool) or not isinstance(at, (int, float)):
        raise SceneError(path, f"is no number but {shown(at)}", "the path of a number in the scene")
    return float(at)


def with_values(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with other numbers at some paths."""
    tree: dict[str | int, Any] = {}
    for path, value in values.items():
        value_at(scene, path)
        branch = tree
        *before, last = _keys(path)
        for key in before:
            branch = branch.setdefault(key, {})
        branch[last] = value
    changed: Scene = _rebuilt(scene, tree, "")
    return changed


def _keys(path: str) -> list[str | int]:
    keys: list[str | int] = []
    for part in path.split(".") if isinstance(path, str) else [""]:
        if keys and part.isdecimal():
            keys.append(int(part))
            continue
        match = _PART.fullmatch(part)
        if match is None:
            raise SceneError(shown(path), "is no path", "names joined by dots, as adhesion.work")
        keys.append(match[1])
        keys += [int(index) for index in re.findall(r"\d+", match[2])]
    return ["loading", *keys] if keys[0] == "machine" else keys  # a table of its own in scene files


def _joined(passed: str, key: str | int) -> str:
    if isinstance(key, int):
        return f"{passed}[{key}]"
    return f"{passed}.{key}" if passed else key


def _entry(at: Any, key: str | int, passed: str, path: str) -> Any:
    """What is under a key of a part of the scene."""
    where = passed or "a scene"
    if isinstance(key, int):
        if not isinstance(at, tuple):
            raise SceneError(path, f"{where} is no list", "the path of a number in the scene")
        if key >= len(at):
            raise SceneError(path, f"{where} has {len(at)} entries", "places counted from 0")
        return at[key]
    names = [f.name for f in fields(at) if f.init] if is_dataclass(at) else []
    if key not in names:
        if at is None:
            problem, allowed = f"the scene has no {where}", "a scene file that states it, as a first guess"
        else:
            problem, allowed = f"{where} has no {key}", ", ".join(names) or "the path of a number"
        raise SceneError(path, problem, allowed)
    return getattr(at, key)


def _rebuilt(at: Any, tree: Mapping[str | int, Any], passed: str) -> Any:
    """A part of the scene with what the tree holds for it put in, from the inside out."""
    new: dict[Any, Any] = {}
    for key, value in tree.items():
        if isinstance(value, dict):
            part = at[key] if isinstance(key, int) else getattr(at, key)
            new[key] = _rebuilt(part, value, _joined(passed, key))
        else:
            new[key] = value
    if isinstance(at, tuple):
        return tuple(new.get(index, entry) for index, entry in enumerate(at))
    try:
        return replace(at, **new)
    except SceneError as error:
        raise error.under(passed) if passed else error from None
