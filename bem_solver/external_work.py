"""Work of the load between the rows of a run, ``int F dD``, to fourth order where both are smooth.

Straight lines between rows cut the corners of every loop: a cycle of n rows loses ``(2 pi/n)^2/6`` of its
area. Between kinks of the loading and jumps of the edge, force and penetration are cubics of time instead,
with the slopes of the parabolas through neighbouring rows.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def external_work(time: Array, penetration: Array, force: Array, kinks: list[int]) -> Array:
    """Work since the first row, shape (n,).

    Parameters
    ----------
    time, penetration, force : ndarray (n,)
    kinks : list of int
        Rows at which slopes may jump; so they may between rows of the same time.

    Returns
    -------
    ndarray (n,)
    """
    work = 0.5 * (force[1:] + force[:-1]) * np.diff(penetration)
    at_once = np.flatnonzero(np.diff(time) <= 0.0)
    borders = sorted({0, *kinks, *at_once.tolist(), *(at_once + 1).tolist(), len(time) - 1})
    for first, last in pairwise(borders):
        if last - first > 2:
            rows = slice(first, last + 1)
            work[first:last] += _beyond_straight(time[rows], penetration[rows], force[rows])
    return np.concatenate(([0.0], np.cumsum(work)))


def _beyond_straight(time: Array, penetration: Array, force: Array) -> Array:
    """Difference between cubics and trapezoids, shape (n - 1,).

    With ``a``, ``b`` the slopes at both ends, times the step, less the chord's: ``F = chord + a s(1-s)^2 - b
    s^2(1-s)`` and the same for D; the integral of their product is a form in these.
    """
    step = np.diff(time)

    def excess(values: Array) -> tuple[Array, Array, Array]:
        chord = np.diff(values)
        slope = _slopes(time, values)
        return chord, slope[:-1] * step - chord, slope[1:] * step - chord

    d, d0, d1 = excess(penetration)
    f, f0, f1 = excess(force)
    return (d * (f0 - f1) - f * (d0 - d1)) / 12.0 + (f1 * d0 - f0 * d1) / 60.0


def _slopes(time: Array, values: Array) -> Array:
    """Derivatives at the rows, of the parabola through each and its neighbours."""
    gap = np.diff(time)
    secant = np.diff(values) / gap
    middle = (secant[:-1] * gap[1:] + secant[1:] * gap[:-1]) / (gap[1:] + gap[:-1])
    first, last = 2.0 * secant[0] - middle[0], 2.0 * secant[-1] - middle[-1]
    return np.concatenate(([first], middle, [last]))
