"""Integrals of one column of the rows over another, ``int F dD``, ``int q^2 da``."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking import hermite

Array = NDArray[np.float64]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(3)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT
_CORNER = 1e-2
"""Ratio of neighbouring steps from which on the force may bend within the shorter: an edge sets off."""


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
        f_slope, d_slope = hermite.slopes(t, f, _CORNER), hermite.slopes(t, d, _CORNER)
        at = t[:-1, None] + h[:, None] * _GAUSS
        speed = hermite.rate(t, d, d_slope, at)
        parts[first:last] = h * ((hermite.evaluate(t, f, f_slope, at) * speed) @ _WEIGHT)
    return parts


def released_at_once(radius: Array, squared: Array) -> Array:
    """``int q^2 da`` between rows that are equilibria at a fixed time.

    The edge may rest first: where it sets off, ``q^2/a``, which hardly changes along equilibria, goes on
    from the rows behind.

    Parameters
    ----------
    radius, squared : ndarray, shape (l,)
        ``a`` and ``q(a)^2``.

    Returns
    -------
    ndarray, shape (l - 1,)
    """
    parts = np.zeros(len(radius) - 1)
    moved = np.flatnonzero(radius != radius[0])
    if not len(moved):
        return parts
    first, rate = int(moved[0]), squared / np.where(radius > 0.0, radius, 1.0)
    start = rate[first]
    if first + 1 < len(radius) and radius[first + 1] != radius[first]:
        slope = (rate[first + 1] - rate[first]) / (radius[first + 1] - radius[first])
        start = start + slope * (radius[0] - radius[first])
    begin = slice(first - 1, None)
    path = np.concatenate(([start * radius[0]], squared[first:]))
    parts[begin] = integrals(np.zeros(len(path)), path, radius[begin], [0, len(path) - 1])
    return parts
