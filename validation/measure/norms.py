"""Distance between two curves over time: error norms of curves through rows, which may jump.

Both runs are laid on the union of their times, over the interval that both cover. Between two neighbours of
that union each curve is one cubic (:mod:`validation.measure.row_interpolation`), so the integral of the
squared difference is exact. A jump (two rows of equal time) has a left and a right limit, and both count;
nothing is smeared over it.

A difference is divided by the size of the quantity, which hides what a small oscillation on a large contact
does, or by its *excursion*: the difference of its largest and smallest value in a window of the run. There
the mean difference in the window is left out, since a contact that is too large by a constant moves as it
should; how large it is, the norm relative to the size says.
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
LEAST_EXCURSION = 5e-3
"""Least excursion that a difference is divided by, relative to the largest magnitude of the column: the
tolerance of curves relative to their size, within which lies whatever moves less."""


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


@dataclass(frozen=True)
class MovementDistance:
    """How differently one column of two runs moves, in the window in which it is worst.

    Parameters
    ----------
    rms : float
        Root mean square of the difference less its mean in the window, over the excursion of the second run.
    begin, end : float
        Of the window.
    """

    rms: float
    begin: float
    end: float


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
    grid = _common_times(run.time, reference.time)
    if grid.size < 2:
        return None
    turns = None if spans is None else load_step_ends(spans)
    first = column_curve(run, column, turns).within(grid)
    second = column_curve(reference, column, turns).within(grid)
    apart = first - second
    scale = float(np.abs(second).max())
    if scale == 0.0:
        scale = 1.0
    h = _lengths(grid)
    span = float(grid[-1] - grid[0])
    worst = np.unravel_index(int(np.argmax(np.abs(apart) * (h > 0.0))), apart.shape)
    longer = max(run.time[-1] - run.time[0], reference.time[-1] - reference.time[0])
    return Distance(
        mean=float((h * _mean_magnitude(apart)).sum() / span / scale),
        rms=float(np.sqrt((h * (WEIGHTS @ apart**2)).sum() / span) / scale),
        largest=float(np.abs(apart[worst]) / scale),
        at=float(grid[worst[1]] + POINTS[worst[0]] * h[worst[1]]),
        until=float(grid[-1]),
        covered=float(span / longer),
    )


def movement_distance(
    run: Trace, reference: Trace, spans: Array, column: str = "force"
) -> MovementDistance | None:
    """How differently two runs move, relative to how the second moves, in the worst of several windows.

    Parameters
    ----------
    run, reference : Trace
    spans : ndarray, shape (n, 2)
        Begin and end of every window (see :mod:`validation.measure.windows`).
    column : str
        Name of the column.

    Returns
    -------
    MovementDistance or None
        ``None`` if no window has a common interval of time.
    """
    grid = _common_times(run.time, reference.time, spans)
    if grid.size < 2:
        return None
    turns = load_step_ends(spans)
    second = column_curve(reference, column, turns).within(grid)
    apart = column_curve(run, column, turns).within(grid) - second
    return _worst_window(grid, apart, second, spans)


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


def movement_interpolation_error(trace: Trace, spans: Array, column: str) -> float:
    """Estimated error of a curve between its rows, relative to its excursion in the worst window.

    Parameters
    ----------
    trace : Trace
    spans : ndarray, shape (n, 2)
        Windows.
    column : str
        Name of the column.

    Returns
    -------
    float
    """
    grid = _common_times(trace.time, trace.time, spans)
    if grid.size < 2:
        return 0.0
    curve = column_curve(trace, column, load_step_ends(spans))
    worst = _worst_window(grid, curve.uncertainty(grid), curve.within(grid), spans, 0.0)
    return 0.0 if worst is None else worst.rms


def movement_bound(trace: Trace, spans: Array, column: str) -> float:
    """Largest movement distance, in any window, of a curve that is off by its own size (root mean square).

    Parameters
    ----------
    trace : Trace
    spans : ndarray, shape (n, 2)
        Begin and end of each window.
    column : str

    Returns
    -------
    float
        Relative, as ``MovementDistance.rms``.
    """
    value = trace.columns()[column]
    size = float(np.abs(value).max(initial=0.0))
    largest = 0.0
    for begin, end in spans:
        rows = value[(trace.time >= begin) & (trace.time <= end)]
        moved = max(float(np.ptp(rows)) if rows.size else 0.0, LEAST_EXCURSION * size)
        if moved > 0.0:
            longer = float(trace.time[-1] - trace.time[0]) / float(end - begin)
            largest = max(largest, float(np.sqrt(longer)) * size / moved)
    return largest


def _worst_window(
    grid: Array, apart: Array, values: Array, spans: Array, centred: float = 1.0
) -> MovementDistance | None:
    """The window in which ``apart`` is largest, relative to the excursion of ``values``.

    Parameters
    ----------
    grid : ndarray, shape (n,)
    apart, values : ndarray, shape (5, n - 1)
        Difference and reference at the points of every interval.
    spans : ndarray, shape (m, 2)
    centred : float
        Share of the mean difference that is left out.

    Returns
    -------
    MovementDistance or None
    """
    h = _lengths(grid)
    first, square = _cumulated(h * (WEIGHTS @ apart)), _cumulated(h * (WEIGHTS @ apart**2))
    least = LEAST_EXCURSION * float(np.abs(values).max())
    lowest, highest = values.min(axis=0), values.max(axis=0)
    worst: MovementDistance | None = None
    for begin, end in np.clip(np.searchsorted(grid, spans), 0, grid.size - 1):
        length = float(grid[end] - grid[begin])
        if length <= 0.0:
            continue
        mean = centred * (first[end] - first[begin]) / length
        moved = max(float(highest[begin:end].max() - lowest[begin:end].min()), least)
        rms = float(np.sqrt(max((square[end] - square[begin]) / length - mean**2, 0.0)))
        relative = rms / moved if moved > 0.0 else (np.inf if rms > 0.0 else 0.0)
        if worst is None or relative > worst.rms:
            worst = MovementDistance(relative, float(grid[begin]), float(grid[end]))
    return worst


def _cumulated(parts: Array) -> Array:
    return np.concatenate(([0.0], np.cumsum(parts)))


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
    first = column_curve(run, column).within(grid)
    second = column_curve(reference, column).within(grid)
    apart = (np.abs(first - second) > tolerance * float(np.abs(second).max())) & (_lengths(grid) > 0.0)
    where = np.flatnonzero(apart.any(axis=0))
    if where.size == 0:
        return None
    i = int(where[0])
    return float(grid[i] + POINTS[np.argmax(apart[:, i])] * (grid[i + 1] - grid[i]))


def _common_times(first: Array, second: Array, spans: Array | None = None) -> Array:
    if first.size < 2 or second.size < 2:
        return np.empty(0)
    begin, end = max(first[0], second[0]), min(first[-1], second[-1])
    times = np.concatenate((first, second) if spans is None else (first, second, spans.ravel()))
    times = np.unique(times)
    return times[(times >= begin) & (times <= end)]


def _lengths(grid: Array) -> Array:
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
