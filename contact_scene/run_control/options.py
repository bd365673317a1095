"""Options that all solvers have, and those that count something."""

from __future__ import annotations

from collections.abc import Collection

from contact_scene.value_checks import number, whole_from

MAX_STEPS = 200_000
"""Trial steps, accepted and rejected together, that a run may take where its options name no other number."""


def whole_number(value: int, key: str, least: int) -> int:
    """An option that counts something, ``least`` or more."""
    return whole_from(least)(value, key)


def moments(times: Collection[float], key: str) -> tuple[float, ...]:
    """An option of requested times."""
    return tuple(number(time, key, "finite times") for time in times)
