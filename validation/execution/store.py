"""Finished parts of a long command, kept in its folder until the whole is done.

A command that is stopped, in whatever way, does what is missing when it is given again; what it has is taken
over bit for bit, run times included. When its results are written the store goes.
"""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import Any

from validation.execution import checked_pickle

FOLDER = ".unfinished"


class Store:
    """Answers by question (see ``resume.question``).

    Parameters
    ----------
    out : Path or None
        The command's folder; without one nothing is kept.
    fresh : bool
        Whether to start anew whatever has been kept.

    Attributes
    ----------
    found : int
        Answers taken over so far.
    """

    def __init__(self, out: Path | None = None, fresh: bool = False) -> None:
        self._folder = None if out is None else out / FOLDER
        self.found = 0
        self._before = 0.0
        self._began = time.perf_counter()
        if fresh:
            self.clear()

    @property
    def seconds(self) -> float:
        """Time spent on the command so far, earlier attempts included."""
        return self._before + time.perf_counter() - self._began

    def get(self, question: str) -> Any:
        """The answer kept, or ``None``."""
        if self._folder is None:
            return None
        try:
            answer, seconds = checked_pickle.read(self._folder / question, question)
        except checked_pickle.Unusable:
            return None
        self.found += 1
        self._before = max(self._before, seconds)
        return answer

    def put(self, question: str, answer: Any) -> None:
        """Keep an answer."""
        if self._folder is not None:
            self._folder.mkdir(exist_ok=True)
            checked_pickle.write(self._folder / question, question, answer, self.seconds)

    def clear(self) -> None:
        """Forget everything."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)
