"""Finished parts of a long command, stored in its folder until the whole is done.

A command that is stopped, in whatever way, does what is missing when it is given again; stored answers are
taken over bit for bit, run times included. When its results are written the store is removed.
"""

from __future__ import annotations

import hashlib
import shutil
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from contact_scene.errors import SceneError
from contact_scene.files import read_text
from validation.execution import fingerprints, records
from validation.execution.files import write_whole

FOLDER = ".unfinished"
VERSION = ".version"
"""File that says by which version of the program, and of its packages, the answers were given."""
LARGEST = 1_000_000_000
"""Bytes of a stored answer, at most."""


@dataclass(frozen=True)
class _Header:
    """What stands beside an answer: its fingerprint, and the wall time (s) of the work up to it."""

    fingerprint: str
    seconds: float


class Store:
    """Answers by fingerprint (see ``fingerprints``), each a file: a digest, a header and the answer as JSON.

    Parameters
    ----------
    out : Path or None
        The command's folder; without one nothing is stored.
    fresh : bool
        Whether to remove what is stored. What another version has stored is removed in any case.

    Attributes
    ----------
    taken_over : int
        Answers of an earlier attempt so far.
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
        """The stored answer of a kind (see ``records``); ``None`` if there is none that can be used."""
        if self._folder is None or not (self._folder / fingerprint).is_file():
            return None
        try:
            digest, _, body = read_text(self._folder / fingerprint, LARGEST).partition("\n")
            if hashlib.sha256(body.encode()).hexdigest() != digest:
                return None
            header, _, answer = body.partition("\n")
            about: _Header = records.loads(header, _Header)
            found = records.loads(answer, kind) if about.fingerprint == fingerprint else None
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
            write_whole(self._folder / VERSION, fingerprints.version())
        body = f"{records.dumps(_Header(fingerprint, self.seconds))}\n{records.dumps(answer)}"
        write_whole(self._folder / fingerprint, f"{hashlib.sha256(body.encode()).hexdigest()}\n{body}")

    def clear(self) -> None:
        """Remove all answers."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)


def _is_of_this_version(folder: Path) -> bool:
    try:
        return read_text(folder / VERSION) == fingerprints.version()
    except SceneError:
        return False
