"""Distance between two curves over time: error norms of piecewise linear curves that may jump.

Both runs are laid on the union of their times, over the interval that both cover. Between two neighbours of
that union each curve is a straight line, so the integrals below are exact. A jump (two rows of equal time)
has a left and a right limit, and both count; nothing is smeared over it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Trace

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Distance:
    """How far one column of two runs lies apart, relative to the largest magnitude in the second.

    Parameters
    ----------
    mean : float
        ``(1/T) integral |x - y| dt / max|y|``.
    rms : float
        ``sqrt((1/T) integral (x - y)^2 dt) / max|y|``.
    largest : float
        ``max |x - y| / max|y|``; near a loss of contact this is mostly a shift in time.
    at : float
        Time of the largest difference.
    until : float
        End of the interval covered by both runs.
    covered : float
        Length of that interval over the length of the longer run.
    """

    mean: float
    rms: float
    largest: float
    at: float
    until: float
    covered: float


def distance(run: Trace, reference: Trace, column: str = "force") -> Distance | None:
    """Distance of ``run`` from ``reference`` in one column; ``None`` if they share no interval of time."""
    grid = _common_times(run.time, reference.time)
    if grid.size < 2:
        return None
    first = _limits(run.time, run.columns()[column], grid)
    second = _limits(reference.time, reference.columns()[column], grid)
    left, right = first[0] - second[0], first[1] - second[1]
    scale = float(np.abs(second).max())
    if scale == 0.0:
        scale = 1.0
    h = np.diff(grid)
    span = float(grid[-1] - grid[0])
    largest = np.maximum(np.abs(left), np.abs(right))
    worst = int(np.argmax(largest))
    longer = max(run.time[-1] - run.time[0], reference.time[-1] - reference.time[0])
    return Distance(
        mean=float((h * _mean_magnitude(left, right)).sum() / span / scale),
        rms=float(np.sqrt((h * (left**2 + left * right + right**2) / 3.0).sum() / span) / scale),
        largest=float(largest[worst] / scale),
        at=float(grid[worst] if abs(left[worst]) >= abs(right[worst]) else grid[worst + 1]),
        until=float(grid[-1]),
        covered=float(span / longer),
    )


def parting_time(run: Trace, reference: Trace, tolerance: float, column: str = "force") -> float | None:
    """First time at which two runs differ by more than a tolerance.

    Parameters
    ----------
    run, reference : Trace
    tolerance : float
        Relative to the largest magnitude in ``reference``.
    column : str
        Name of the column.

    Returns
    -------
    float or None
        ``None`` if they never do, or share no interval of time.
    """
    grid = _common_times(run.time, reference.time)
    if grid.size < 2:
        return None
    first = _limits(run.time, run.columns()[column], grid)
    second = _limits(reference.time, reference.columns()[column], grid)
    limit = tolerance * float(np.abs(second).max())
    apart = np.abs(first - second) > limit
    where = np.flatnonzero(apart.any(axis=0))
    if where.size == 0:
        return None
    i = int(where[0])
    return float(grid[i] if apart[0, i] else grid[i + 1])


def _common_times(first: Array, second: Array) -> Array:
    if first.size < 2 or second.size < 2:
        return np.empty(0)
    begin, end = max(first[0], second[0]), min(first[-1], second[-1])
    times = np.unique(np.concatenate((first, second)))
    return times[(times >= begin) & (times <= end)]


def _limits(time: Array, value: Array, grid: Array) -> Array:
    """Limits from inside at the two ends of every grid interval, shape (2, len(grid) - 1)."""
    middle = 0.5 * (grid[1:] + grid[:-1])
    i = np.clip(np.searchsorted(time, middle, side="right") - 1, 0, time.size - 2)
    step = time[i + 1] - time[i]
    # Where the middle of two neighbouring floats is one of them, that pair of rows may be a jump.
    safe = np.where(step > 0, step, 1.0)
    slope = np.where(step > 0, (value[i + 1] - value[i]) / safe, 0.0)
    return np.stack((value[i] + slope * (grid[:-1] - time[i]), value[i] + slope * (grid[1:] - time[i])))


def _mean_magnitude(left: Array, right: Array) -> Array:
    """Mean of ``|d|`` over an interval on which ``d`` runs linearly from ``left`` to ``right``."""
    total = np.abs(left) + np.abs(right)
    crossing = left * right < 0
    return np.where(crossing, (left**2 + right**2) / (2.0 * np.where(total > 0, total, 1.0)), 0.5 * total)
