"""Checks of single values that a user states: of the right kind, within bounds, else an error in one line."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from typing import Any

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError, shown

SMALLEST, LARGEST = 1e-60, 1e60
"""Bounds of every quantity with a dimension: products of five still fit into a float."""

FINITE = f"a finite number, at most {LARGEST:g} in magnitude"
POSITIVE = f"a finite number > 0, from {SMALLEST:g} to {LARGEST:g}"
NOT_NEGATIVE = f"a finite number >= 0, at most {LARGEST:g}"
ZERO_OR_POSITIVE = f"a finite number >= 0: 0, or from {SMALLEST:g} to {LARGEST:g}"

A_COLUMN = "finite numbers, one a row"


def number(
    value: Any,
    key: str,
    allowed: str,
    *,
    low: float = -LARGEST,
    high: float = LARGEST,
    open_low: bool = False,
    open_high: bool = False,
) -> float:
    """Check one finite real number against an interval and return it as a float.

    Parameters
    ----------
    value : object
    key : str
        Dotted path of the key, for the error.
    allowed : str
        The interval in words, for the error.
    low, high : float
        Its ends.
    open_low, open_high : bool
        Whether the ends are excluded.

    Returns
    -------
    float

    Raises
    ------
    SceneError
        If ``value`` is not a real number, not finite, or outside the interval.
    """
    a_number(value, key, allowed)
    try:
        result = float(value)
    except OverflowError:
        raise SceneError(key, "must be finite, got an integer too large for a float", allowed) from None
    if not math.isfinite(result):
        raise SceneError(key, f"must be finite, got {result}", allowed)
    too_low = result <= low if open_low else result < low
    too_high = result >= high if open_high else result > high
    if too_low or too_high:
        raise SceneError(key, f"got {result!r}", allowed)
    return result


def a_number(value: Any, key: str, allowed: str = "a number") -> None:
    """Check that a value is one real number, whichever; a truth value is none."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.floating, np.integer)):
        raise SceneError(key, f"must be a number, got {shown(value)}", allowed)


def positive(value: Any, key: str) -> float:
    """A finite number > 0 (``SMALLEST`` to ``LARGEST``)."""
    return number(value, key, POSITIVE, low=SMALLEST)


def not_negative(value: Any, key: str) -> float:
    """A finite number >= 0 (up to ``LARGEST``)."""
    return number(value, key, NOT_NEGATIVE, low=0.0)


def zero_or_positive(value: Any, key: str) -> float:
    """0, or a finite number > 0 that is divided by (``SMALLEST`` to ``LARGEST``)."""
    result = number(value, key, ZERO_OR_POSITIVE, low=0.0)
    return number(result, key, ZERO_OR_POSITIVE, low=SMALLEST) if result else result


def finite(value: Any, key: str) -> float:
    """A finite number (up to ``LARGEST`` in magnitude)."""
    return number(value, key, FINITE)


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
    """Numbers in a row as an array of its own, shape (n,); not yet checked to be finite.

    Parameters
    ----------
    values : array_like, shape (n,)
    key : str
        Name of the column, for the error.
    allowed : str
        What it may hold, in words.

    Returns
    -------
    ndarray, shape (n,)

    Raises
    ------
    SceneError
        If they are no real numbers, or not in one row.
    """
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
    """Check the class of what a function is given.

    Parameters
    ----------
    value : Any
    key : str
        Name of the argument.
    classes : type or tuple of type
        As of ``isinstance``.
    allowed : str
        The same in words.

    Raises
    ------
    SceneError
        If it is of none of them.
    """
    if not isinstance(value, classes):
        raise SceneError(key, f"got {shown(value)}", allowed)
