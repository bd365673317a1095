"""Integrals of one column of the rows over another, ``int F dD``."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking import hermite

Array = NDArray[np.float64]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(3)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT


def integrals(time: Array, force: Array, depth: Array, ends: list[int]) -> Array:
    """``int F dD`` between rows, both cubics between ``ends``: in time, across a jump in its parts.

    Parameters
    ----------
    time, force, depth : ndarray, shape (l,)
        Rows; ``F`` and ``D`` may be any two columns.
    ends : list of int
        Rows at which smooth stretches end and begin, rising, the first and last row among them.

    Returns
    -------
    ndarray, shape (l - 1,)
    """
    parts = 0.5 * (force[1:] + force[:-1]) * np.diff(depth)
    for first, last in pairwise(ends):
        if last - first < 3:
            continue
        rows = slice(first, last + 1)
        t, f, d = time[rows], force[rows], depth[rows]
        if t[0] == t[-1]:
            t = np.arange(len(f), dtype=float)
        h = np.diff(t)
        f_slope, d_slope = hermite.slopes(t, f), hermite.slopes(t, d)
        at = t[:-1, None] + h[:, None] * _GAUSS
        speed = hermite.rate(t, d, d_slope, at)
        parts[first:last] = h * ((hermite.evaluate(t, f, f_slope, at) * speed) @ _WEIGHT)
    return parts
