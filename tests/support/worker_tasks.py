"""Work for processes of the tests, in a module of its own: a process imports it, and nothing else of a test.

Beside a test it would cost every process the import of the solvers, ten times as long as its own start.
"""

from __future__ import annotations

import time
from pathlib import Path


def square(value: float) -> float:
    """Fails where the value is negative."""
    if value < 0.0:
        raise ValueError(f"{value}\nis negative")
    return value * value


def spin() -> None:
    """Never ends, and uses processor time."""
    while True:
        pass


def silent(value: int, tell_share=None) -> int:
    """Could tell its share, and does not."""
    return value


def wait_half_way(seen: Path, tell_share) -> bool:
    """Tells that it is half-way, and goes on when that is seen."""
    tell_share(0.5)
    deadline = time.monotonic() + 60.0
    while not seen.exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    return seen.exists()


def unpickled_in_vain() -> None:
    """As of a module that the process does not have."""
    raise ModuleNotFoundError("No module named 'nowhere'")


class NotThere:
    """Can be pickled, not unpickled."""

    def __reduce__(self):
        return unpickled_in_vain, ()
