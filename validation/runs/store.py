"""Finished runs, kept in the folder of a long command: whatever ends the program leaves whole records.

An SQLite file with a write-ahead log. An answer is JSON by the fingerprint of its question: dataclasses by
the names of their fields, arrays of floats by their bytes, beside a digest. What is read has the types that
the dataclasses declare; what has not, or is damaged, counts as not stored, and nothing is executed. One
process holds the file at a time, as it holds the folder (see ``folder``).
"""

from __future__ import annotations

import base64
import errno
import hashlib
import json
import sqlite3
import sys
import time
import types
import zlib
from collections.abc import Mapping
from dataclasses import MISSING, fields, is_dataclass
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, ClassVar, Self, Union, get_args, get_origin, get_type_hints
from weakref import WeakValueDictionary

import numpy as np

from contact_scene.errors import SceneError, shown
from validation.runs import provenance
from validation.runs.folder import from_json

UNFINISHED = ".unfinished.sqlite"
"""The file of a command that removes it when its results are written."""

_TABLE = """
PRAGMA locking_mode = EXCLUSIVE;
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
CREATE TABLE IF NOT EXISTS answers (fingerprint TEXT PRIMARY KEY, digest TEXT, answer TEXT, seconds REAL);
"""
_ROW = "SELECT digest, answer, seconds FROM answers WHERE fingerprint = ?"
_DAMAGED = sqlite3.DatabaseError, UnicodeDecodeError
"""What is raised over a damaged file; the latter where SQLite's message quotes it."""
_FOREIGN = sqlite3.SQLITE_ERROR, sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB
"""Errors of a file that is damaged or another program's, rather than of a disk that is full or fails."""
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


class Store:
    """Answers by fingerprint, in a file of the command's folder, or ``in_memory``; otherwise nothing is kept.

    ``fresh`` removes what is stored. ``taken_over`` counts the answers that were found so far. Every method
    raises ``SceneError`` over a file that is damaged or another program's, ``OSError`` with its name if the
    disk is full or fails.
    """

    _open: ClassVar[WeakValueDictionary[str, Store]] = WeakValueDictionary()
    """By file: one that is opened again, after an interruption say, is closed where it was left open."""

    def __init__(
        self, folder: Path | None = None, fresh: bool = False, file: str = UNFINISHED, in_memory: bool = False
    ) -> None:
        self._path = None if folder is None else folder / file
        self._connection: sqlite3.Connection | None = None
        self.taken_over = 0
        self._seconds_before, self._began = 0.0, time.perf_counter()
        if fresh:
            self.clear()
        if in_memory or (self._path is not None and self._path.exists()):
            self._connect()

    @property
    def seconds(self) -> float:
        """Time spent on the command so far, earlier attempts included."""
        return self._seconds_before + time.perf_counter() - self._began

    @property
    def holds_answers(self) -> bool:
        """Whether an answer is stored, of this attempt or an earlier one."""
        return self._ask("SELECT 1 FROM answers LIMIT 1") is not None

    def get(self, fingerprint: str, kind: Any) -> Any:
        """The stored answer of a kind (see :func:`checked`); ``None`` if there is none that can be used."""
        row = self._ask(_ROW, fingerprint)
        if row is None or not all(isinstance(cell, str) for cell in row[:2]):
            return None
        digest, answer, seconds = row
        try:
            found = loads(answer, kind) if _digest(fingerprint, answer) == digest else None
        except SceneError:
            return None
        self.taken_over += found is not None
        if isinstance(seconds, float):
            self._seconds_before = max(self._seconds_before, seconds)
        return found

    def put(self, fingerprint: str, answer: Any) -> None:
        """Store an answer."""
        self.put_all({fingerprint: answer})

    def put_all(self, answers: Mapping[str, Any]) -> None:
        """Store answers, all of them or, where the program ends, none."""
        if self._connection is None and self._path is None:
            return
        texts = {fingerprint: dumps(answer) for fingerprint, answer in answers.items()}
        rows = [(key, _digest(key, text), text, self.seconds) for key, text in texts.items()]
        try:
            with self._connect() as connection:
                connection.executemany("INSERT OR REPLACE INTO answers VALUES (?, ?, ?, ?)", rows)
        except _DAMAGED as error:
            raise self._unusable(error) from None

    def clear(self) -> None:
        """Remove all answers."""
        self.close()
        if self._path is not None:
            for ending in ("", "-wal", "-shm"):
                self._path.with_name(self._path.name + ending).unlink(missing_ok=True)

    def close(self) -> None:
        """Close the file."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def __del__(self) -> None:
        self.close()  # a connection alone would wait for the collector, and hold the file

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _ask(self, question: str, *given: str) -> Any:
        """The first row of an answer of the file; ``None`` if there is none."""
        if self._connection is None:
            return None
        try:
            return self._connection.execute(question, given).fetchone()
        except _DAMAGED as error:
            raise self._unusable(error) from None

    def _connect(self) -> sqlite3.Connection:
        """Open the file, and say that nothing is taken over of what another version has stored."""
        if self._connection is not None:
            return self._connection
        name = str(self._path or ":memory:")
        if self._path is not None and (earlier := self._open.get(name)) is not None:
            earlier.close()
        try:
            self._connection = sqlite3.connect(name, check_same_thread=False)
            self._connection.executescript(_TABLE)
            self._connection.execute(_ROW, ("",))  # the table of another program has other columns
            of_this = zlib.crc32(provenance.version().encode()) >> 1
            (before,) = self._connection.execute("PRAGMA user_version").fetchone()
            if before != of_this and self.holds_answers:
                print(f"crosscontact: starting anew: {self._path} is of another version", file=sys.stderr)
            self._connection.execute(f"PRAGMA user_version = {of_this}")
        except _DAMAGED as error:
            self.close()
            raise self._unusable(error) from None
        self._open[name] = self
        return self._connection

    def _unusable(self, error: Exception) -> SceneError | OSError:
        if getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF not in _FOREIGN:
            return OSError(errno.EIO, str(error), str(self._path))
        problem = f"{self._path} cannot be used: {error}"
        return SceneError("--out", problem, "runs that this program has stored, or --fresh")


def _digest(fingerprint: str, answer: str) -> str:
    return hashlib.sha256(f"{fingerprint}\n{answer}".encode()).hexdigest()


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
    if type(value) in _WORDS:
        return value
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
    if isinstance(value, (int, float, str)):
        return value
    raise TypeError(f"{type(value).__name__} cannot be stored")


def checked(data: Any, kind: Any, key: str = "") -> Any:
    """JSON data as the value of a declared kind, or a ``SceneError`` of one line at the key where they stand.

    A kind is a dataclass, an enumeration, a float, int, bool or str, an array of floats, a dictionary by
    strings, a tuple, or one of several of these.
    """
    origin, inner = get_origin(kind), get_args(kind)
    several = origin in (Union, types.UnionType)
    if type(data) in (inner if several else (kind,)) and type(data) in _WORDS and type(data) is not int:
        return data
    if several:
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
    raise SceneError(
        key, f"got {shown(data)}", _WORDS.get(kind, "a table" if is_dataclass(kind) else "a list")
    )


def _one_of(data: Any, kinds: tuple[Any, ...], key: str) -> Any:
    if data is None and type(None) in kinds:
        return None
    refused = None
    for kind in (one for one in kinds if one is not type(None)):
        try:
            return checked(data, kind, key)
        except SceneError as error:
            refused = error
    raise refused or SceneError(key, f"got {shown(data)}", "a value")


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
