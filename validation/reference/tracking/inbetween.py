"""Values between the rows of a run: the cubic through the four nearest rows of a smooth stretch.

Rows that crowd beside a long step make a polynomial of their rounding errors. Where it departs from the
straight line by more than the four rows differ, the straight line is taken.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def cubics(time: Array, values: Array, ends: Indices, index: Indices, at: Array) -> Array:
    """Values at the times ``at`` (m,), which lie between the rows ``index`` and ``index + 1``; (m, n).

    Parameters
    ----------
    time, values : ndarray, shape (l,) and (l, n)
        Rows; strictly rising times within a stretch.
    ends : ndarray of int
        Rows at which the stretches end and begin, rising, the first and last row among them. A short stretch
        has a polynomial of lower degree.
    """
    stretch = ends.searchsorted(index, side="right")
    first, last = ends[stretch - 1], ends[stretch]
    start = np.maximum(np.minimum(index - 1, last - 3), first)
    count = last - first + 1
    result = np.empty((len(at), values.shape[1]))
    for degree in (1, 2, 3):
        these = count == degree + 1 if degree < 3 else count > 3
        if these.any():
            rows = start[these, None] + np.arange(degree + 1)
            curve = _newton(time[rows], values[rows], at[these])
            left = index[these]
            share = (at[these] - time[left]) / (time[left + 1] - time[left])
            chord = values[left] + share[:, None] * (values[left + 1] - values[left])
            wild = np.abs(curve - chord) > np.ptp(values[rows], axis=1)
            result[these] = np.where(wild, chord, curve)
    return result


def _newton(nodes: Array, values: Array, at: Array) -> Array:
    """Polynomials through ``nodes`` (m, p) with ``values`` (m, p, n) at ``at`` (m,)."""
    table = values.copy()
    degree = nodes.shape[1] - 1
    for order in range(1, degree + 1):
        gap = nodes[:, order:] - nodes[:, :-order]
        table[:, order:] = (table[:, order:] - table[:, order - 1 : -1]) / gap[:, :, None]
    result = table[:, degree]
    for i in range(degree - 1, -1, -1):
        result = table[:, i] + (at - nodes[:, i])[:, None] * result
    return np.asarray(result)
