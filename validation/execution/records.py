"""Finished runs as JSON: dataclasses by the names of their fields, arrays of floats by their bytes.

What is read has the types that the dataclasses declare; anything else is refused, and nothing is executed.
"""

from __future__ import annotations

import base64
import json
import types
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from contact_scene.errors import SceneError, shown
from validation.execution.files import from_json

_ARRAY = "float64"
"""Key under which the bytes of an array stand, little-endian."""
_LARGEST = 2**63
"""Whole numbers are smaller, so that each is a float, too."""
_WORDS = {
    float: "a number",
    int: "a whole number",
    bool: "true or false",
    str: "a string",
    type(None): "null",
}


def dumps(value: Any) -> str:
    """A value as JSON."""
    return json.dumps(_plain(value))


def loads(text: str, kind: Any) -> Any:
    """The value of a kind that :func:`dumps` has written, bit for bit.

    Raises
    ------
    SceneError
        If the text holds anything else.
    """
    try:
        data = from_json(text)
    except ValueError as error:
        raise SceneError("", f"is no JSON: {error}", "what this program has written") from None
    return checked(data, kind)


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return {entry.name: _plain(getattr(value, entry.name)) for entry in fields(value)}
    if isinstance(value, np.ndarray) and value.dtype == np.float64 and value.ndim == 1:
        return {_ARRAY: base64.b64encode(value.astype("<f8").tobytes()).decode()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(entry) for entry in value]
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"{type(value).__name__} cannot be stored")


def checked(data: Any, kind: Any, key: str = "") -> Any:
    """JSON data as the value of a declared kind.

    Parameters
    ----------
    data : object
        Of ``json.loads``.
    kind : type or annotation
        A dataclass, an enumeration, a float, int, bool or str, an array of floats, a dictionary by strings, a
        tuple, or one of several of these.
    key : str
        Where the data stand, for the error.

    Returns
    -------
    object

    Raises
    ------
    SceneError
        One line, if they are of another kind.
    """
    origin, inner = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        return _one_of(data, inner, key)
    if isinstance(kind, type) and is_dataclass(kind) and isinstance(data, dict):
        hints = _hints(kind)
        odd = sorted((data.keys() - hints.keys()) | (_required(kind) - data.keys()))
        if odd:
            raise SceneError(key, f"missing or unknown: {shown(odd)}", ", ".join(hints))
        return kind(**{name: checked(one, hints[name], _under(key, name)) for name, one in data.items()})
    if origin is dict and isinstance(data, dict):
        return {name: checked(entry, inner[1], _under(key, name)) for name, entry in data.items()}
    if origin is tuple and isinstance(data, list):
        kinds = inner[:1] * len(data) if inner[1:] == (...,) else inner
        if len(kinds) == len(data):
            parts = enumerate(zip(data, kinds, strict=True))
            return tuple(checked(one, of, f"{key}[{i}]") for i, (one, of) in parts)
    if origin is np.ndarray and isinstance(data, dict) and data.keys() == {_ARRAY}:
        return _array(data[_ARRAY], key)
    if isinstance(kind, type) and issubclass(kind, Enum):
        if data in [str(one) for one in kind]:
            return kind(data)
        raise SceneError(key, f"got {shown(data)}", ", ".join(f'"{one}"' for one in kind))
    if type(data) is int and kind in (int, float) and abs(data) < _LARGEST:
        return data
    if kind in _WORDS and kind is not int and type(data) is kind:
        return data
    raise SceneError(
        key, f"got {shown(data)}", _WORDS.get(kind, "a table" if is_dataclass(kind) else "a list")
    )


def _one_of(data: Any, kinds: tuple[Any, ...], key: str) -> Any:
    if data is None and type(None) in kinds:
        return None
    refused = SceneError(key, f"got {shown(data)}", "a value")
    for kind in (one for one in kinds if one is not type(None)):
        try:
            return checked(data, kind, key)
        except SceneError as error:
            refused = error
    raise refused


def _array(text: Any, key: str) -> Any:
    try:
        return np.frombuffer(base64.b64decode(text, validate=True), "<f8").astype(float)
    except (ValueError, TypeError):
        raise SceneError(key, "is no array", "the bytes of an array of floats") from None


@cache
def _hints(kind: type) -> dict[str, Any]:
    hints = get_type_hints(kind)
    return {entry.name: hints[entry.name] for entry in fields(kind)}


@cache
def _required(kind: type) -> frozenset[str]:
    return frozenset(
        entry.name for entry in fields(kind) if entry.default is MISSING and entry.default_factory is MISSING
    )


def _under(key: str, name: str) -> str:
    return f"{key}.{name}" if key else name
