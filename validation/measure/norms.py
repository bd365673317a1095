"""Distance between two curves over time: error norms of curves through rows, which may jump.

Both runs are laid on the union of their times, over the interval that both cover. Between two neighbours of
that union each curve is one cubic (:mod:`validation.measure.row_interpolation`), so the integral of the
squared difference is exact. A jump (two rows of equal time) has a left and a right limit, and both count;
nothing is smeared over it.

A difference is divided by the size of the quantity, which hides what a small oscillation on a large contact
does: that is measured by :mod:`validation.measure.movement_norms`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Trace
from validation.measure.row_interpolation import POINTS, SHORTEST, WEIGHTS, column_curve
from validation.measure.windows import load_step_ends

Array = NDArray[np.float64]

CURVES = ("force", "contact_radius")
"""Columns that runs are compared by, as curves over time."""


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
    size, level : float
        Largest magnitude in the second (1 if it is zero throughout), and its root mean square over that.
    factor : float
        Constant that turns the second into the first with the least root mean square left over.
    """

    mean: float
    rms: float
    largest: float
    at: float
    until: float
    covered: float
    size: float = 1.0
    level: float = 1.0
    factor: float = 1.0


def distance(
    run: Trace, reference: Trace, column: str = "force", spans: Array | None = None
) -> Distance | None:
    """Distance of ``run`` from ``reference`` in one column; ``None`` if they share no interval of time.

    Parameters
    ----------
    run, reference : Trace
    column : str
        Name of a column of both.
    spans : ndarray, shape (n, 2), optional
        Begin and end of every window (see :mod:`validation.measure.windows`): where load steps end, a curve
        may have a corner that rows of one column alone do not tell from a bend.

    Returns
    -------
    Distance or None
    """
    grid = common_times(run.time, reference.time)
    if grid.size < 2:
        return None
    turns = None if spans is None else load_step_ends(spans)
    first = column_curve(run, column, turns).within(grid)
    second = column_curve(reference, column, turns).within(grid)
    apart = first - second
    scale = float(np.abs(second).max())
    if scale == 0.0:
        scale = 1.0
    h = interval_lengths(grid)
    span = float(grid[-1] - grid[0])
    worst = np.unravel_index(int(np.argmax(np.abs(apart) * (h > 0.0))), apart.shape)
    longer = max(run.time[-1] - run.time[0], reference.time[-1] - reference.time[0])

    def mean(values: Array) -> float:
        return float((h * (WEIGHTS @ values)).sum() / span)

    square = mean(second**2)
    return Distance(
        mean=float((h * _mean_magnitude(apart)).sum() / span / scale),
        rms=float(np.sqrt(mean(apart**2)) / scale),
        largest=float(np.abs(apart[worst]) / scale),
        at=float(grid[worst[1]] + POINTS[worst[0]] * h[worst[1]]),
        until=float(grid[-1]),
        covered=float(span / longer),
        size=scale,
        level=float(np.sqrt(square) / scale),
        factor=mean(first * second) / square if square > 0.0 else 1.0,
    )


def interpolation_error(trace: Trace, column: str, spans: Array | None = None) -> float:
    """Estimated error of a curve between its rows: root mean square over the largest magnitude.

    Parameters
    ----------
    trace : Trace
    column : str
    spans : ndarray, shape (n, 2), optional
        As of :func:`distance`.

    Returns
    -------
    float
    """
    grid, size = np.unique(trace.time), float(np.abs(trace.columns()[column]).max(initial=0.0))
    if grid.size < 2 or size == 0.0:
        return 0.0
    turns = None if spans is None else load_step_ends(spans)
    unknown = column_curve(trace, column, turns).uncertainty(grid)
    return float(np.sqrt((np.diff(grid) * (WEIGHTS @ unknown**2)).sum() / (grid[-1] - grid[0])) / size)


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
    grid = common_times(run.time, reference.time)
    if grid.size < 2:
        return None
    first = column_curve(run, column).within(grid)
    second = column_curve(reference, column).within(grid)
    apart = (np.abs(first - second) > tolerance * float(np.abs(second).max())) & (
        interval_lengths(grid) > 0.0
    )
    where = np.flatnonzero(apart.any(axis=0))
    if where.size == 0:
        return None
    i = int(where[0])
    return float(grid[i] + POINTS[np.argmax(apart[:, i])] * (grid[i + 1] - grid[i]))


def common_times(first: Array, second: Array, spans: Array | None = None) -> Array:
    """Times of both runs, rising, and the ends of windows, within what both cover; empty if that is nothing.

    Parameters
    ----------
    first, second : ndarray, shape (n,), (m,)
        Times of the rows of each run.
    spans : ndarray, shape (k, 2), optional
        Begin and end of windows.

    Returns
    -------
    ndarray, shape (l,)
    """
    if first.size < 2 or second.size < 2:
        return np.empty(0)
    begin, end = max(first[0], second[0]), min(first[-1], second[-1])
    times = np.concatenate((first, second) if spans is None else (first, second, spans.ravel()))
    times = np.unique(times)
    return times[(times >= begin) & (times <= end)]


def interval_lengths(grid: Array) -> Array:
    """Lengths of the intervals between times; none between two that rounding holds apart, as of one jump."""
    lengths = np.diff(grid)
    return np.where(lengths > SHORTEST * (grid[-1] - grid[0]), lengths, 0.0)


def _mean_magnitude(apart: Array) -> Array:
    """Mean of ``|d|`` over every interval, ``d`` straight between its points; shape of ``apart`` (5, n)."""
    left, right = apart[:-1], apart[1:]
    total = np.abs(left) + np.abs(right)
    crossing = left * right < 0
    mean = np.where(crossing, (left**2 + right**2) / (2.0 * np.where(total > 0, total, 1.0)), 0.5 * total)
    return np.diff(POINTS) @ mean
