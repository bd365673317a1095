"""Work for processes of the tests, in a module of its own: a process imports it, and nothing else of a test.

Beside a test it would cost every process the import of the solvers, ten times as long as its own start.
"""

from __future__ import annotations


def square(value: float) -> float:
    """Fails where the value is negative."""
    if value < 0.0:
        raise ValueError(f"{value}\nis negative")
    return value * value


def spin() -> None:
    """Never ends, and uses processor time."""
    while True:
        pass


def unpickled_in_vain() -> None:
    """As of a module that the process does not have."""
    raise ModuleNotFoundError("No module named 'nowhere'")


class NotThere:
    """Can be pickled, not unpickled."""

    def __reduce__(self):
        return unpickled_in_vain, ()
