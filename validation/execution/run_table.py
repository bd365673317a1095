"""Finished runs of a sweep by fingerprint, in one file: what ``kill -9`` leaves of it is whole.

An SQLite file with a write-ahead log. A row is a run: what is known about it as JSON, which gives the numbers
back bit for bit, its processor time, and, if it was asked for, its trace. One process holds the file at a
time, as it holds the folder (see ``folder_lock``).
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError
from validation.execution import checked_pickle

FILE = "runs.sqlite"
_TABLES = """
PRAGMA locking_mode = EXCLUSIVE;
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
CREATE TABLE IF NOT EXISTS runs (fingerprint TEXT PRIMARY KEY, record TEXT, seconds REAL);
CREATE TABLE IF NOT EXISTS traces (fingerprint TEXT PRIMARY KEY, columns BLOB);
"""
_COLUMNS = (
    "SELECT fingerprint, record, seconds FROM runs LIMIT 0", "SELECT fingerprint, columns FROM traces LIMIT 0"
)  # fmt: skip
"""What the tables of another program do not answer."""
Columns = dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class StoredRun:
    """A run as it is stored.

    Parameters
    ----------
    fingerprint : str
        Of what was computed (see ``fingerprints``).
    record : dict
        What is known about it; JSON can express it.
    seconds : float
        Processor time.
    columns : dict of str to (rows,) array, or None
        The trace by column, if it is kept.
    """

    fingerprint: str
    record: dict[str, Any]
    seconds: float
    columns: Columns | None = None


class RunTable:
    """Runs by fingerprint.

    Parameters
    ----------
    folder : Path or None
        Of the command; without one the runs are kept in memory.
    fresh : bool
        Whether to remove what is stored.

    Raises
    ------
    SceneError
        If the file is damaged, or another program's.
    """

    def __init__(self, folder: Path | None = None, fresh: bool = False) -> None:
        self._path = None if folder is None else folder / FILE
        if fresh and self._path is not None:
            for ending in ("", "-wal", "-shm"):
                self._path.with_name(FILE + ending).unlink(missing_ok=True)
        try:
            self._connection = sqlite3.connect(self._path or ":memory:")
            self._connection.executescript(_TABLES)
            for question in _COLUMNS:
                self._connection.execute(question)
        except sqlite3.DatabaseError as error:
            problem = f"{self._path} cannot be used: {error}"
            raise SceneError("--out", problem, "runs that this program has stored, or --fresh") from None

    def put(self, runs: Iterable[StoredRun]) -> None:
        """Store runs, all of them or none."""
        with self._connection:
            for run in runs:
                row = (run.fingerprint, json.dumps(run.record, allow_nan=False), run.seconds)
                self._connection.execute("INSERT OR REPLACE INTO runs VALUES (?, ?, ?)", row)
                if run.columns is not None:
                    trace = (run.fingerprint, checked_pickle.dumps(run.columns))
                    self._connection.execute("INSERT OR REPLACE INTO traces VALUES (?, ?)", trace)

    def record(self, fingerprint: str) -> dict[str, Any] | None:
        """What is known about a run; ``None`` if it is not stored."""
        row = self._row("SELECT record FROM runs WHERE fingerprint = ?", fingerprint)
        return None if row is None else json.loads(row[0])

    def columns(self, fingerprint: str) -> Columns | None:
        """The trace of a run; ``None`` if it is not kept."""
        row = self._row("SELECT columns FROM traces WHERE fingerprint = ?", fingerprint)
        return None if row is None else checked_pickle.loads(row[0])

    def holds(self, fingerprint: str, trace: bool = False) -> bool:
        """Whether a run is stored, with its trace if that is asked for and the run has one."""
        record = self._row("SELECT record FROM runs WHERE fingerprint = ?", fingerprint)
        if record is None:
            return False
        if not trace or json.loads(record[0])["rows"] == 0:
            return True
        return self._row("SELECT 1 FROM traces WHERE fingerprint = ?", fingerprint) is not None

    def seconds(self, fingerprint: str) -> float | None:
        """Processor time of a stored run."""
        row = self._row("SELECT seconds FROM runs WHERE fingerprint = ?", fingerprint)
        return None if row is None else float(row[0])

    def _row(self, question: str, fingerprint: str) -> tuple[Any, ...] | None:
        row: tuple[Any, ...] | None = self._connection.execute(question, (fingerprint,)).fetchone()
        return row

    def close(self) -> None:
        """Close the file."""
        self._connection.close()

    def __enter__(self) -> RunTable:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
