"""The closure integral as one matrix between ``q`` behind the edge and ``d`` ahead of it.

With ``x = a - da + s`` behind and ``y = a + s`` ahead, ``0 < s < da``, and the kernel of
:mod:`validation.reference.tracking.closure`,

    I = -1/(pi^2 da) int_0^da d(s) [ (pi/2) q(s)/sqrt(x y) + int_s^da q(s') dK/dx(s', s) ds' ] ds = d^T W q.

``W`` depends on radius, zone and points alone. The points are those of Gauss in panels between breaks: the
ends of the zone, graded towards both, and where the table of passages has edges.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.polynomials import gauss, powers
from validation.reference.tracking.closure import kernel_slope

Array = NDArray[np.float64]

POINTS, WEIGHTS = gauss(5)
COUNT = len(POINTS)
# integral from a point to the end of its panel of each Lagrange polynomial
_REST = ((1.0 - POINTS[:, None] ** np.arange(1, COUNT + 1)) / np.arange(1, COUNT + 1)) @ np.linalg.inv(
    powers(POINTS, COUNT - 1)
)
_GRADED = np.array([2e-3, 2e-2, 0.2])
"""Breaks near the ends of a zone: fresh surface fades within a small part of it (two levels: 2e-6)."""
BASE = np.unique(np.concatenate(([0.0, 0.5, 1.0], _GRADED, 1.0 - _GRADED)))
NEAR_AXIS = 0.45
"""Zone over radius from which on the kernel is no polynomial of degree 5 but taken point by point."""
_RING = np.cos(np.pi * (np.arange(24) + 0.5) / 24)
_POWERS = np.arange(6)[:, None]


def points(breaks: Array) -> tuple[Array, Array]:
    """Points and weights of Gauss between breaks."""
    width = np.diff(breaks)
    return (breaks[:-1, None] + width[:, None] * POINTS).ravel(), (width[:, None] * WEIGHTS).ravel()


def closure_matrix(radius: float, zone: float, breaks: Array) -> tuple[Array, Array, Array]:
    """Points ``s`` (m,), weights (m,) and ``W`` (m, m), rows of ``d`` without the weights of theirs."""
    s, weight = points(breaks)
    m = len(s)
    x, y = radius - zone + s, radius + s
    matrix = _later(m) * weight
    within = np.lib.stride_tricks.as_strided(matrix, (m // COUNT, COUNT, COUNT), (8 * COUNT * (m + 1), 8 * m, 8))
    within[...] = np.diff(breaks)[:, None, None] * _REST
    if zone > NEAR_AXIS * radius:
        matrix *= _kernel_slopes(x, y - zone, zone)
    else:
        v = (s / zone) ** _POWERS
        matrix *= v.T @ (kernel_slope(radius - zone, zone).T @ v)
    matrix.ravel()[:: m + 1] += 0.5 * math.pi / np.sqrt(x * y)
    return s, weight, matrix


@lru_cache(maxsize=64)
def _later(count: int) -> Array:
    """One for every pair of points of which the second lies in a later panel."""
    panel = np.arange(count) // COUNT
    return (panel[:, None] < panel).astype(float)


def _kernel_slopes(x: Array, behind: Array, zone: float) -> Array:
    """``dK/dx`` at every pair: rows of ``y = behind + zone``, columns of ``x``."""
    x, behind = x[None, :, None], behind[:, None, None]
    r = 0.5 * (x + behind) + 0.5 * (x - behind) * _RING
    slope = 0.5 * (1.0 + _RING)
    first, second = x + r, r + behind + 2.0 * zone
    return np.asarray(math.pi * (-0.5 * ((1.0 + slope) / first + slope / second) / np.sqrt(first * second)).mean(-1))
