"""Distance between the movements of two curves over time, relative to how far the second moves.

A difference is divided by the *excursion*: the difference of the largest and the smallest value in a window
of the run. The mean difference in the window is left out, since a contact that is too large by a constant
moves as it should; how large it is, the norm relative to the size says (:mod:`validation.measure.norms`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Trace
from validation.measure.norms import common_times, interval_lengths
from validation.measure.row_interpolation import WEIGHTS, column_curve
from validation.measure.windows import load_step_ends

Array = NDArray[np.float64]

LEAST_EXCURSION = 5e-3
"""Least excursion that a difference is divided by, relative to the largest magnitude of the column: the
tolerance of curves relative to their size, within which lies whatever moves less."""


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
    grid = common_times(run.time, reference.time, spans)
    if grid.size < 2:
        return None
    turns = load_step_ends(spans)
    second = column_curve(reference, column, turns).within(grid)
    apart = column_curve(run, column, turns).within(grid) - second
    return _worst_window(grid, apart, second, spans)


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
    grid = common_times(trace.time, trace.time, spans)
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
    h = interval_lengths(grid)
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
