"""Tables of a scene file: keys checked, required, and made into the dataclass they describe."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import MISSING, Field, fields
from functools import cache
from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError, shown


def under(prefix: str, build: Callable[[], Any]) -> Any:
    """What ``build()`` returns; an error in it is one of a key under ``prefix``.

    Raises
    ------
    SceneError
        One that names a file already is left as it is.
    """
    try:
        return build()
    except SceneError as error:
        raise error if error.file else error.under(prefix) from None


def check_keys(data: dict[str, Any], allowed: Iterable[str]) -> None:
    """Refuse keys that are not allowed in a table.

    Raises
    ------
    SceneError
        For the first of them.
    """
    names = tuple(allowed)
    for key in data:
        if key not in names:
            raise SceneError(str(key), "unknown key", ", ".join(names))


def table_of(data: dict[str, Any], key: str) -> dict[str, Any]:
    """The table of that name in a scene.

    Raises
    ------
    SceneError
        If it is missing, or no table.
    """
    if key not in data:
        raise SceneError("", "is missing", f"a table [{key}]")
    if not isinstance(data[key], dict):
        raise SceneError("", f"got {shown(data[key])}", f"a table [{key}]")
    return data[key]


def required(data: dict[str, Any], key: str, allowed: str) -> Any:
    """The value of a key that a table must have.

    Raises
    ------
    SceneError
        If it is missing; it says what is ``allowed``.
    """
    if key not in data:
        raise SceneError(key, "is missing", allowed)
    return data[key]


@cache
def entries_of(kind: type) -> dict[str, Field[Any]]:
    """Those of a dataclass that a file may give."""
    return {entry.name: entry for entry in fields(kind) if entry.init}


def built(kind: type, data: dict[str, Any], tag: str | None = None) -> Any:
    """A frozen dataclass constructed from a table; ``tag`` is a key already dealt with.

    Raises
    ------
    SceneError
        If a key is unknown or missing, or a value is not allowed.
    """
    known = entries_of(kind)
    check_keys({k: v for k, v in data.items() if k != tag}, [*known, *([tag] if tag else [])])
    for name, entry in known.items():
        if name not in data and entry.default is MISSING:
            raise SceneError(name, "is missing", f"keys {', '.join(known)}")
    return kind(**{k: v for k, v in data.items() if k != tag})


def beside(where: Path, name: Any) -> Path:
    """The path of a file that a scene names, in the folder ``where``.

    Raises
    ------
    SceneError
        If it is no name of a file.
    """
    if not isinstance(name, str) or not name or "\0" in name:
        raise SceneError("file", f"got {shown(name)}", "the name of a file beside the scene")
    return where / name
