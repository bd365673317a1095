"""Rules for single values that a user states: of the right kind, within bounds, else an error in one line."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Set
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError, shown

SMALLEST, LARGEST = 1e-60, 1e60
"""Bounds of every quantity with a dimension: products of five still fit into a float."""


@dataclass(frozen=True)
class Rule:
    """What a value may be, in words; called with a value and its key, it gives it back checked."""

    words: str

    def __call__(self, value: Any, key: str) -> Any:
        raise AssertionError("defined by every kind of rule")

    def refused(self, key: str, problem: str) -> SceneError:
        """The error of a value that is not allowed."""
        return SceneError(key, problem, self.words)


@dataclass(frozen=True)
class Kind(Rule):
    """Objects of some classes."""

    classes: Any = ()

    def __call__(self, value: Any, key: str) -> Any:
        if not isinstance(value, self.classes):
            raise self.refused(key, f"got {shown(value)}")
        return value


@dataclass(frozen=True)
class Number(Rule):
    """Real numbers, whichever; a truth value is none."""

    def __call__(self, value: Any, key: str) -> Any:
        if isinstance(value, bool) or not isinstance(value, (int, float, np.floating, np.integer)):
            raise self.refused(key, f"must be a number, got {shown(value)}")
        return value


@dataclass(frozen=True)
class Range(Number):
    """Real numbers from ``low`` to ``high``, the ends included unless ``open``, and those in ``also``."""

    low: float = -LARGEST
    high: float = LARGEST
    open: bool = False
    also: tuple[float, ...] = ()

    def __call__(self, value: Any, key: str) -> float:
        super().__call__(value, key)
        number = value if isinstance(value, int) else float(value)  # integers may be too large for a float
        if number in self.also or self.holds(number):
            return float(number)
        raise self.refused(key, f"got {shown(number)}")

    def holds(self, value: Any) -> Any:
        """Whether a number, or each of an array, lies between the ends; nan does not."""
        if self.open:
            return (self.low < value) & (value < self.high)
        return (self.low <= value) & (value <= self.high)


@dataclass(frozen=True)
class Whole(Range):
    """Whole numbers of a range."""

    def __call__(self, value: Any, key: str) -> int:
        super().__call__(value, key)
        return int(value)

    def holds(self, value: Any) -> Any:
        return super().holds(value) & (value % 1 == 0)


@dataclass(frozen=True)
class Column(Rule):
    """Real numbers in a row, as an array of its own of shape (n,); those of a range, if there is one."""

    within: Range | None = None

    def __call__(self, value: Any, key: str) -> NDArray[np.float64]:
        try:
            array = np.array(value)
            if array.dtype.kind not in "iufO":  # no truth values, texts, dates or complex numbers
                raise TypeError
            array = array.astype(float, copy=False)
        except (TypeError, ValueError, OverflowError):
            raise self.refused(key, f"got {shown(value)}") from None
        if array.ndim != 1:
            raise self.refused(key, f"has shape {array.shape}")
        if self.within is not None and not (held := self.within.holds(array)).all():
            row = int(np.argmin(held))
            self.within(float(array[row]), f"{key}[{row}]")
        return array


finite = Range(f"a finite number, at most {LARGEST:g} in magnitude")
positive = Range(f"a finite number > 0, from {SMALLEST:g} to {LARGEST:g}", SMALLEST)
not_negative = Range(f"a finite number >= 0, at most {LARGEST:g}", 0.0)
zero_or_positive = Range(
    f"a finite number >= 0: 0, or from {SMALLEST:g} to {LARGEST:g}", SMALLEST, also=(0.0,)
)
column = Column("finite numbers, one a row: one dimension")
a_string = Kind("a string", str)
true_or_false = Kind("True or False", (bool, np.bool_))


def whole_from(least: int) -> Whole:
    """Whole numbers from the least one that is allowed."""
    return Whole(f"a whole number >= {least}", least)


def number(
    value: Any, key: str, allowed: str, *, low: float = -LARGEST, high: float = LARGEST, open: bool = False
) -> float:
    """A finite real number of an interval as a float; ``allowed``: the interval in words, for the error."""
    return Range(allowed, low, high, open)(value, key)


def of_class(value: Any, key: str, classes: Any, allowed: str) -> None:
    """Check the class of what a function is given, as ``isinstance`` does; ``allowed``: in words."""
    Kind(allowed, classes)(value, key)


def low_and_high(text: str, key: str) -> tuple[float, float]:
    """The bounds of a number that ``LOW:HIGH`` states."""
    try:
        low, high = (finite(float(part), key) for part in text.split(":"))
    except ValueError:
        raise SceneError(key, f"got bounds {shown(text)}", "two finite numbers, LOW:HIGH") from None
    return low, high


def one_of(value: Any, key: str, choices: Collection[str]) -> str:
    """A string out of ``choices``."""
    if not isinstance(value, str) or value not in choices:
        raise SceneError(key, f"got {shown(value)}", "one of " + ", ".join(f'"{c}"' for c in choices))
    return value


def function_or_none(value: Any, key: str, of: str) -> None:
    """Check something to be called with ``of``, or ``None``."""
    if value is not None and not callable(value):
        raise SceneError(key, f"got {shown(value)}", f"a function of {of}")


def as_tuple(value: Any, key: str, allowed: str) -> tuple[Any, ...]:
    """The entries of a list, tuple or other iterable that has an order; a text is none of its letters."""
    if isinstance(value, (str, bytes, Mapping, set, frozenset)):
        raise SceneError(key, f"got {shown(value)}", allowed)
    try:
        return tuple(value)
    except TypeError:
        raise SceneError(key, f"got {shown(value)}", allowed) from None


def several(value: Any, key: str, allowed: str) -> tuple[Any, ...]:
    """The entries of what is iterable, whether or not it has an order; a text is none of its letters."""
    return tuple(value) if isinstance(value, Set) else as_tuple(value, key, allowed)
