"""Checks of single values that a user states: of the right kind, within bounds, else an error in one line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError, shown

SMALLEST, LARGEST = 1e-60, 1e60
"""Bounds of every quantity with a dimension: products of five still fit into a float."""

A_COLUMN = "finite numbers, one a row"


@dataclass(frozen=True)
class Rule:
    """What a value may be, in words; called with a value and its key, it gives it back checked."""

    words: str

    def __call__(self, value: Any, key: str) -> Any:
        raise AssertionError("defined by every kind of rule")


@dataclass(frozen=True)
class Range(Rule):
    """Real numbers from ``low`` to ``high``, the ends included unless ``open``, and those in ``also``."""

    low: float = -LARGEST
    high: float = LARGEST
    open: bool = False
    also: tuple[float, ...] = ()

    def __call__(self, value: Any, key: str) -> float:
        """The number as a float; ``key`` names it in the error."""
        a_number(value, key, self.words)
        try:
            result = float(value)
        except OverflowError:
            raise SceneError(
                key, "must be finite, got an integer too large for a float", self.words
            ) from None
        if result in self.also:
            return result
        if not math.isfinite(result):
            raise SceneError(key, f"must be finite, got {result}", self.words)
        inside = self.low < result < self.high if self.open else self.low <= result <= self.high
        if not inside:
            raise SceneError(key, f"got {result!r}", self.words)
        return result


@dataclass(frozen=True)
class Whole(Range):
    """Whole numbers of a range."""

    def __call__(self, value: Any, key: str) -> int:
        super().__call__(value, key)
        if value != int(value):
            raise SceneError(key, f"got {value!r:.40}", self.words)
        return int(value)


def whole_from(least: int) -> Whole:
    """Whole numbers from the least one that is allowed."""
    return Whole(f"a whole number >= {least}", least)


FINITE = f"a finite number, at most {LARGEST:g} in magnitude"
POSITIVE = f"a finite number > 0, from {SMALLEST:g} to {LARGEST:g}"
NOT_NEGATIVE = f"a finite number >= 0, at most {LARGEST:g}"

finite = Range(FINITE)
positive = Range(POSITIVE, SMALLEST)
not_negative = Range(NOT_NEGATIVE, 0.0)
zero_or_positive = Range(
    f"a finite number >= 0: 0, or from {SMALLEST:g} to {LARGEST:g}", SMALLEST, also=(0.0,)
)


def number(
    value: Any, key: str, allowed: str, *, low: float = -LARGEST, high: float = LARGEST, open: bool = False
) -> float:
    """A finite real number of an interval as a float; ``allowed``: the interval in words, for the error."""
    return Range(allowed, low, high, open)(value, key)


def a_number(value: Any, key: str, allowed: str = "a number") -> None:
    """Check that a value is one real number, whichever; a truth value is none."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.floating, np.integer)):
        raise SceneError(key, f"must be a number, got {shown(value)}", allowed)


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


def column(values: Any, key: str, allowed: str = A_COLUMN) -> NDArray[np.float64]:
    """Real numbers in a row as an array of its own, shape (n,); not yet checked to be finite."""
    try:
        array = np.array(values)
        if array.dtype.kind not in "iufO":  # no truth values, texts, dates or complex numbers
            raise TypeError
        array = array.astype(float, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise SceneError(key, f"got {shown(values)}", allowed) from None
    if array.ndim != 1:
        raise SceneError(key, f"has shape {array.shape}", f"{allowed}: one dimension")
    return array


def finite_column(values: Any, key: str, check: Range = finite) -> tuple[float, ...]:
    """Numbers of a range, one a row; long columns of plain floats at once."""
    entries = values.tolist() if isinstance(values, np.ndarray) else as_tuple(values, key, A_COLUMN)
    if not isinstance(entries, (list, tuple)):  # an array without a dimension
        raise SceneError(key, f"got {shown(values)}", A_COLUMN)
    if all(type(entry) is float for entry in entries):
        numbers = np.array(entries)
        if ((numbers >= check.low) & (numbers <= check.high)).all():  # not a number compares as false
            return tuple(entries)
    return tuple(check(entry, f"{key}, row {row}") for row, entry in enumerate(entries, 1))


def a_string(value: Any, key: str) -> str:
    """A string."""
    of_class(value, key, str, "a string")
    return str(value)


def true_or_false(value: Any, key: str) -> bool:
    """A truth value."""
    of_class(value, key, (bool, np.bool_), "True or False")
    return bool(value)


def function_or_none(value: Any, key: str, of: str) -> None:
    """Check something to be called with ``of``, or ``None``."""
    if value is not None and not callable(value):
        raise SceneError(key, f"got {shown(value)}", f"a function of {of}")


def one_of(value: Any, key: str, choices: Sequence[str]) -> str:
    """A string out of ``choices``."""
    if not isinstance(value, str) or value not in choices:
        raise SceneError(key, f"got {shown(value)}", "one of " + ", ".join(f'"{c}"' for c in choices))
    return value


def of_class(value: Any, key: str, classes: Any, allowed: str) -> None:
    """Check the class of what a function is given, as ``isinstance`` does; ``allowed``: in words."""
    if not isinstance(value, classes):
        raise SceneError(key, f"got {shown(value)}", allowed)
