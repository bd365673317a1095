"""Finished runs of a sweep by fingerprint, in one file: what ``kill -9`` leaves of it is whole.

An SQLite file with a write-ahead log. A row is a run: what is known about it as JSON, which gives the numbers
back bit for bit, its processor time, and, if it was asked for, its trace. What cannot be read back counts as
not stored. One process holds the file at a time, as it holds the folder (see ``folder_lock``).
"""

from __future__ import annotations

import errno
import sqlite3
import sys
import zlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError
from validation.runs import provenance, store

FILE = "runs.sqlite"
_TABLES = """
PRAGMA locking_mode = EXCLUSIVE;
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
CREATE TABLE IF NOT EXISTS runs (fingerprint TEXT PRIMARY KEY, record TEXT, seconds REAL);
CREATE TABLE IF NOT EXISTS traces (fingerprint TEXT PRIMARY KEY, columns TEXT);
"""
_COLUMNS = (
    "SELECT fingerprint, record, seconds FROM runs LIMIT 0", "SELECT fingerprint, columns FROM traces LIMIT 0"
)  # fmt: skip
"""What the tables of another program do not answer."""
_DAMAGED = sqlite3.DatabaseError, UnicodeDecodeError
"""What is raised over a damaged file; the latter where SQLite's message quotes it."""
Columns = dict[str, NDArray[np.float64]]
_Kind = TypeVar("_Kind")


@dataclass(frozen=True)
class RunRecord:
    """What a sweep keeps of a run: measures and relative error estimates that apply, rows of its trace."""

    outcome: str
    reason: str
    finished: bool = False
    measures: dict[str, float] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    rows: int = 0


@dataclass(frozen=True)
class StoredRun:
    """A run by the fingerprint of what was computed, its processor time (s), and its columns, if kept."""

    fingerprint: str
    record: RunRecord
    seconds: float
    columns: Columns | None = None


def _is_foreign(error: Exception) -> bool:
    """Whether a file is damaged or another program's, rather than a disk full or failing."""
    foreign = (sqlite3.SQLITE_ERROR, sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
    return getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF in foreign


class RunTable:
    """Runs by fingerprint, in a folder or, without one, in memory; ``fresh`` removes what is stored.

    Raises ``SceneError`` if the file is damaged or another program's; every method that stores, too,
    ``OSError`` with the name of the file if the disk is full or fails.
    """

    def __init__(self, folder: Path | None = None, fresh: bool = False) -> None:
        self._path = None if folder is None else folder / FILE
        if fresh and self._path is not None:
            for ending in ("", "-wal", "-shm"):
                self._path.with_name(FILE + ending).unlink(missing_ok=True)
        try:
            self._connection = sqlite3.connect(self._path or ":memory:")
            self._make_tables()
        except _DAMAGED as error:
            raise self._unusable(error) from None

    def _make_tables(self) -> None:
        try:
            self._connection.executescript(_TABLES)
            for question in _COLUMNS:
                self._connection.execute(question)
            self._tell_of_other_version()
        except _DAMAGED:
            self.close()
            raise

    def _tell_of_other_version(self) -> None:
        """Say that nothing is taken over of what another version has stored."""
        of_this = zlib.crc32(provenance.version().encode()) >> 1
        (before,) = self._connection.execute("PRAGMA user_version").fetchone()
        if before != of_this and self._connection.execute("SELECT 1 FROM runs LIMIT 1").fetchone():
            print(f"crosscontact: starting anew: {self._path} is of another version", file=sys.stderr)
        self._connection.execute(f"PRAGMA user_version = {of_this}")

    def put(self, runs: Iterable[StoredRun]) -> None:
        """Store runs, all of them or none."""
        try:
            with self._connection:
                for run in runs:
                    row = (run.fingerprint, store.dumps(run.record), run.seconds)
                    self._connection.execute("INSERT OR REPLACE INTO runs VALUES (?, ?, ?)", row)
                    if run.columns is not None:
                        trace = (run.fingerprint, store.dumps(run.columns))
                        self._connection.execute("INSERT OR REPLACE INTO traces VALUES (?, ?)", trace)
        except _DAMAGED as error:
            raise self._unusable(error) from None

    def record(self, fingerprint: str) -> RunRecord | None:
        """What is known about a run; ``None`` if it is not stored."""
        return self._value("SELECT record FROM runs WHERE fingerprint = ?", fingerprint, RunRecord)

    def columns(self, fingerprint: str) -> Columns | None:
        """The trace of a run; ``None`` if it is not kept."""
        return self._value("SELECT columns FROM traces WHERE fingerprint = ?", fingerprint, Columns)

    def holds(self, fingerprint: str, trace: bool = False) -> bool:
        """Whether a run is stored, with its trace if that is asked for and the run has one."""
        record = self.record(fingerprint)
        if record is None:
            return False
        return not trace or record.rows == 0 or self.columns(fingerprint) is not None

    def seconds(self, fingerprint: str) -> float | None:
        """Processor time of a stored run."""
        seconds = self._cell("SELECT seconds FROM runs WHERE fingerprint = ?", fingerprint)
        return seconds if isinstance(seconds, float) else None

    def _value(self, question: str, fingerprint: str, kind: type[_Kind]) -> _Kind | None:
        cell = self._cell(question, fingerprint)
        try:
            return store.loads(cell, kind) if isinstance(cell, str) else None
        except SceneError:
            return None

    def _cell(self, question: str, fingerprint: str) -> Any:
        try:
            row = self._connection.execute(question, (fingerprint,)).fetchone()
        except _DAMAGED as error:
            raise self._unusable(error) from None
        return None if row is None else row[0]

    def _unusable(self, error: Exception) -> SceneError | OSError:
        if not _is_foreign(error):  # as of any file that the disk does not take or give
            return OSError(errno.EIO, str(error), str(self._path))
        problem = f"{self._path} cannot be used: {error}"
        return SceneError("--out", problem, "runs that this program has stored, or --fresh")

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    def __enter__(self) -> RunTable:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
