"""Errors in the input, in one line: file, key, what is wrong, what is allowed."""

from __future__ import annotations

import reprlib
import unicodedata
from dataclasses import dataclass
from typing import Any

_LONGEST_PART = 200
"""Characters of a key, a file name or a reason in an error message."""


@dataclass
class SceneError(ValueError):
    """A scene that cannot be accepted.

    Parameters
    ----------
    key : str
        Dotted path of the offending key, e.g. ``material.branches[1].time``; in a CSV file the
        column and row.
    problem : str
        What is wrong with it.
    allowed : str
        What would be accepted.
    file : str
        The file it was read from; empty for scenes built in Python.

    Examples
    --------
    >>> try:
    ...     cc.Sphere(radius=-1.0)
    ... except cc.SceneError as error:
    ...     print(error)
    radius: got -1.0; allowed: a finite number > 0, from 1e-60 to 1e+60
    """

    key: str
    problem: str
    allowed: str = ""
    file: str = ""

    def __str__(self) -> str:
        line = ": ".join(_one_line(part) for part in (self.file, self.key, self.problem) if part)
        return line + (f"; allowed: {_one_line(self.allowed)}" if self.allowed else "")

    def under(self, prefix: str) -> SceneError:
        """The same error with ``prefix`` put before its key."""
        key = prefix if not self.key else prefix + ("" if self.key.startswith("[") else ".") + self.key
        return type(self)(key, self.problem, self.allowed, self.file)

    def in_file(self, file: str) -> SceneError:
        """The same error with the name of the file it came from (unchanged if it already has one)."""
        return type(self)(self.key, self.problem, self.allowed, self.file or file)


class UnsupportedScene(SceneError):
    """A valid scene that a solver does not cover; the message gives the reason and an alternative.

    Examples
    --------
    >>> issubclass(cc.UnsupportedScene, cc.SceneError)
    True
    """


class _Short(reprlib.Repr):
    """A ``repr`` bounded in length and depth, whatever a file contains."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 2
        self.maxstring = self.maxother = 40
        self.maxlist = self.maxdict = self.maxtuple = 3

    def repr_int(self, x: int, level: int) -> str:
        return super().repr_int(x, level) if x.bit_length() < 1000 else "a huge integer"


def shown(value: Any) -> str:
    """``value`` as it appears in an error message: at most 60 characters."""
    text = _Short().repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def cell_shown(text: str) -> str:
    """What a table holds in place of a number or name, no longer than that: a scene may name any file."""
    return shown(text if len(text) <= 12 else text[:9] + "...")


def printable(text: str) -> str:
    """The text without what steers a terminal: control and format characters but line ends and tabs."""
    return "".join(c if c in "\n\t" or unicodedata.category(c) not in ("Cc", "Cf") else "?" for c in text)


def _one_line(text: str) -> str:
    """Printable characters only, blanks joined, cut to ``_LONGEST_PART``."""
    printable = "".join(c if c.isprintable() else " " if c.isspace() else "?" for c in text)
    joined = " ".join(printable.split())
    return joined if len(joined) <= _LONGEST_PART else joined[: _LONGEST_PART - 3] + "..."


def one_line(error: Exception) -> str:
    """An exception in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}".rstrip(": ")
