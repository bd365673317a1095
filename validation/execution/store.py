"""Finished parts of a long command, stored in its folder until the whole is done.

A command that is stopped, in whatever way, does what is missing when it is given again; stored answers are
taken over bit for bit, run times included. When its results are written the store is removed.
"""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import Any

from validation.execution import checked_pickle

FOLDER = ".unfinished"


class Store:
    """Answers by fingerprint (see ``fingerprints``).

    Parameters
    ----------
    out : Path or None
        The command's folder; without one nothing is stored.
    fresh : bool
        Whether to remove what is stored.

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

    @property
    def seconds(self) -> float:
        """Time spent on the command so far, earlier attempts included."""
        return self._seconds_before + time.perf_counter() - self._began

    @property
    def holds_answers(self) -> bool:
        """Whether an answer is stored, of this attempt or an earlier one."""
        return self._folder is not None and self._folder.is_dir() and any(self._folder.iterdir())

    def get(self, fingerprint: str) -> Any:
        """The stored answer, or ``None``."""
        if self._folder is None:
            return None
        try:
            answer, seconds = checked_pickle.read(self._folder / fingerprint, fingerprint)
        except checked_pickle.UnusableFile:
            return None
        self.taken_over += 1
        self._seconds_before = max(self._seconds_before, seconds)
        return answer

    def put(self, fingerprint: str, answer: Any) -> None:
        """Store an answer."""
        if self._folder is not None:
            self._folder.mkdir(exist_ok=True)
            checked_pickle.write(self._folder / fingerprint, fingerprint, answer, self.seconds)

    def clear(self) -> None:
        """Remove all answers."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
