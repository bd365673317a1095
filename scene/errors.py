"""Errors a user can cause, said in one line: file, key, what is wrong, what is allowed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass
class SceneError(ValueError):
    """A scene that cannot be accepted.

    Parameters
    ----------
    key : str
        Dotted path of the offending key, e.g. ``material.branches[1].time``.
    problem : str
        What is wrong with it.
    allowed : str
        What would be accepted.
    file : str
        The file it was read from; empty for scenes built in Python.
    """

    key: str
    problem: str
    allowed: str = ""
    file: str = ""

    def __str__(self) -> str:
        parts = [part for part in (self.file, self.key, self.problem) if part]
        line = ": ".join(parts)
        if self.allowed:
            line += f"; allowed: {self.allowed}"
        return " ".join(line.split())

    def under(self, prefix: str) -> SceneError:
        """The same error with ``prefix`` put before its key."""
        key = prefix if not self.key else prefix + ("" if self.key.startswith("[") else ".") + self.key
        return SceneError(key, self.problem, self.allowed, self.file)

    def in_file(self, file: str) -> SceneError:
        """The same error with the name of the file it came from (kept if it already has one)."""
        return SceneError(self.key, self.problem, self.allowed, self.file or file)


class UnsupportedScene(SceneError):
    """A valid scene that this solver cannot answer; the message says why and what can."""


def number(
    value: Any,
    key: str,
    allowed: str,
    *,
    low: float = -math.inf,
    high: float = math.inf,
    open_low: bool = False,
    open_high: bool = False,
) -> float:
    """Check one finite real number against an interval and return it as a float.

    Raises
    ------
    SceneError
        If ``value`` is not a real number, not finite, or outside the interval.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        try:
            import numpy as np

            is_numpy = isinstance(value, (np.floating, np.integer))
        except ImportError:  # pragma: no cover - numpy is a dependency
            is_numpy = False
        if not is_numpy:
            raise SceneError(key, f"must be a number, got {_show(value)}", allowed)
    try:
        result = float(value)
    except OverflowError:
        raise SceneError(key, "must be finite, got an integer too large for a float", allowed) from None
    if not math.isfinite(result):
        raise SceneError(key, f"must be finite, got {result}", allowed)
    too_low = result <= low if open_low else result < low
    too_high = result >= high if open_high else result > high
    if too_low or too_high:
        raise SceneError(key, f"got {result:g}", allowed)
    return result


def positive(value: Any, key: str) -> float:
    """A finite number > 0."""
    return number(value, key, "a finite number > 0", low=0.0, open_low=True)


def one_of(value: Any, key: str, choices: Sequence[str]) -> str:
    """A string out of ``choices``."""
    if not isinstance(value, str) or value not in choices:
        raise SceneError(key, f"got {_show(value)}", "one of " + ", ".join(f'"{c}"' for c in choices))
    return value


def _show(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
