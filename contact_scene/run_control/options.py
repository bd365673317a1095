"""Options that all solvers have, and those that count something."""

from __future__ import annotations

from collections.abc import Collection

from contact_scene.errors import SceneError
from contact_scene.value_checks import number

MAX_STEPS = 200_000
"""Trial steps, accepted and rejected together, that a run may take where its options name no other number."""


def whole_number(value: int, key: str, least: int) -> int:
    """An option that counts something.

    Parameters
    ----------
    value : int
    key : str
        Of the option, for the message.
    least : int
        Smallest number allowed.

    Returns
    -------
    int

    Raises
    ------
    SceneError
        If it is not a whole number, or less than ``least``.
    """
    allowed = f"a whole number >= {least}"
    number(value, key, allowed, low=least)
    if value != int(value):
        raise SceneError(key, f"got {value!r:.40}", allowed)
    return int(value)


def moments(times: Collection[float], key: str) -> tuple[float, ...]:
    """An option of requested times.

    Parameters
    ----------
    times : collection of float
    key : str
        Of the option, for the message.

    Returns
    -------
    tuple of float

    Raises
    ------
    SceneError
        If one of them is not a finite number.
    """
    return tuple(number(time, key, "finite times") for time in times)
