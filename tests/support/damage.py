"""Damage to what is stored: bytes and values changed at random; bytes that run a command where unpickled."""

from __future__ import annotations

import json
import random
import types
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

EXECUTED = b"cposix\nsystem\n(S'touch executed'\ntR."
"""A pickle: a reader that takes it for one makes the file ``executed``."""
CRASHING = b"\x80\x05\x8c\x05numpy\x8c\x07ndarray\x93(K\x01\x85\x8c\x01OC\x08AAAAAAAAtR."
"""Another: an array of objects at addresses of the file's choice."""
STRANGE = (None, True, -1, 0, 1.5, 1e400, 10**400, "", "nan", "completed", [], {}, [1.0], {"float64": "A"})


def changed(text: str, chance: random.Random) -> str:
    """A JSON text with one of its values replaced, taken away, or put under another name."""
    data = {"": json.loads(text)}
    places = list(_places(data))
    holder, key = chance.choice(places)
    match chance.randrange(4):
        case 0:
            other, place = chance.choice(places)
            holder[key] = json.loads(json.dumps(other[place]))
        case 1 if isinstance(holder, list) or len(holder) > 1:
            del holder[key]
        case 2 if isinstance(holder, dict) and holder is not data:
            holder[f"{key}_"] = holder.pop(key)
        case _:
            holder[key] = chance.choice(STRANGE)
    return json.dumps(data.get(""))


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    if isinstance(value, (dict, list)):
        for key in value if isinstance(value, dict) else range(len(value)):
            yield value, key
            yield from _places(value[key])


def with_other_bytes(data: bytes, chance: random.Random) -> bytes:
    """The same with a byte changed, a piece cut out, or one doubled."""
    first, last = sorted(chance.randrange(len(data) + 1) for _ in range(2))
    match chance.randrange(3):
        case 0:
            return data[:first] + bytes([chance.randrange(256)]) + data[first + 1 :]
        case 1:
            return data[:first] + data[last:]
    return data[:last] + data[first:]


def is_of(value: Any, kind: Any) -> bool:
    """Whether a value, down to its last part, has the declared kind."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        return any(is_of(value, one) for one in inner)
    if kind is type(None):
        return value is None
    if origin is dict:
        return type(value) is dict and all(
            is_of(k, inner[0]) and is_of(v, inner[1]) for k, v in value.items()
        )
    if origin is tuple:
        kinds = inner[:1] * len(value) if inner[1:] == (...,) else inner
        return type(value) is tuple and len(kinds) == len(value) and all(map(is_of, value, kinds))
    if origin is np.ndarray:
        return type(value) is np.ndarray and value.dtype == np.float64
    if is_dataclass(kind):
        hints = get_type_hints(kind)
        return type(value) is kind and all(is_of(getattr(value, e.name), hints[e.name]) for e in fields(kind))
    if issubclass(kind, Enum):
        return isinstance(value, kind)
    return type(value) in ((float, int) if kind is float else (kind,))
