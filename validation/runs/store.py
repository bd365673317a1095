"""Finished parts of a long command, stored in its folder until the whole is done.

A command that is stopped, in whatever way, does what is missing when it is given again; stored answers are
taken over bit for bit, run times included. When its results are written the store is removed.

An answer is JSON: dataclasses by the names of their fields, arrays of floats by their bytes. What is read
has the types that the dataclasses declare; anything else is refused, and nothing is executed.
"""

from __future__ import annotations

import base64
import hashlib
import json
import shutil
import sys
import time
import types
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from contact_scene.errors import SceneError, shown
from contact_scene.files import read_text
from validation.runs import provenance
from validation.runs.files import from_json, write_whole

FOLDER = ".unfinished"
VERSION = ".version"
"""File that says by which version of the program, and of its packages, the answers were given."""
LARGEST = 1_000_000_000
"""Bytes of a stored answer, at most."""
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


@dataclass(frozen=True)
class _Header:
    """What stands beside an answer: its fingerprint, and the wall time (s) of the work up to it."""

    fingerprint: str
    seconds: float


class Store:
    """Answers by fingerprint, each a file in the command's folder: a digest, a header and the answer as JSON.

    Without a folder nothing is stored. ``fresh`` removes what is stored; what another version has stored is
    removed in any case. ``taken_over`` counts the answers of an earlier attempt so far.
    """

    def __init__(self, out: Path | None = None, fresh: bool = False) -> None:
        self._folder = None if out is None else out / FOLDER
        self.taken_over = 0
        self._seconds_before = 0.0
        self._began = time.perf_counter()
        if fresh:
            self.clear()
        elif self._folder is not None and self._folder.is_dir() and not _is_of_this_version(self._folder):
            print(f"crosscontact: starting anew: {self._folder} is of another version", file=sys.stderr)
            self.clear()

    @property
    def seconds(self) -> float:
        """Time spent on the command so far, earlier attempts included."""
        return self._seconds_before + time.perf_counter() - self._began

    @property
    def holds_answers(self) -> bool:
        """Whether an answer is stored, of this attempt or an earlier one."""
        return self._folder is not None and any(self._folder.glob("[!.]*"))

    def get(self, fingerprint: str, kind: Any) -> Any:
        """The stored answer of a kind (see :func:`checked`); ``None`` if there is none that can be used."""
        if self._folder is None or not (self._folder / fingerprint).is_file():
            return None
        try:
            digest, _, body = read_text(self._folder / fingerprint, LARGEST).partition("\n")
            if hashlib.sha256(body.encode()).hexdigest() != digest:
                return None
            header, _, answer = body.partition("\n")
            about: _Header = loads(header, _Header)
            found = loads(answer, kind) if about.fingerprint == fingerprint else None
        except SceneError:
            return None
        self.taken_over += found is not None
        self._seconds_before = max(self._seconds_before, about.seconds)
        return found

    def put(self, fingerprint: str, answer: Any) -> None:
        """Store an answer."""
        if self._folder is None:
            return
        if not self._folder.is_dir():
            self._folder.mkdir()
            write_whole(self._folder / VERSION, provenance.version())
        body = f"{dumps(_Header(fingerprint, self.seconds))}\n{dumps(answer)}"
        write_whole(self._folder / fingerprint, f"{hashlib.sha256(body.encode()).hexdigest()}\n{body}")

    def clear(self) -> None:
        """Remove all answers."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)


def _is_of_this_version(folder: Path) -> bool:
    try:
        return read_text(folder / VERSION) == provenance.version()
    except SceneError:
        return False


def dumps(value: Any) -> str:
    """A value as JSON."""
    return json.dumps(_plain(value))


def loads(text: str, kind: Any) -> Any:
    """The value of a kind that :func:`dumps` has written, bit for bit; ``SceneError`` for anything else."""
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
    """JSON data as the value of a declared kind, or a ``SceneError`` of one line at the key where they stand.

    A kind is a dataclass, an enumeration, a float, int, bool or str, an array of floats, a dictionary by
    strings, a tuple, or one of several of these.
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
