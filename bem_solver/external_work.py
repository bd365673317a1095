"""Work of the load between the rows of a run, ``int F dD``, to fourth order where both are smooth.

Straight lines between rows cut the corners of every loop: a cycle of n rows loses ``(2 pi/n)^2/6`` of its
area. Between kinks of the loading and jumps of the edge, force and penetration are cubics instead, with the
slopes of the parabolas through neighbouring rows: of the length of the path in the plane of time and edge.
Before a limit point, where the edge runs away, they are smooth in the edge and roots of the time.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LEAST_SHARE = 0.01
"""Distance of a neighbour, in the larger of the two steps, below which it tells no slope: steps that follow
from each other differ by less, those between two prescribed times may be of any length."""


def external_work(
    time: Array, penetration: Array, force: Array, kinks: list[int], edge: Array | None = None
) -> Array:
    """Work since the first row, shape (n,).

    Parameters
    ----------
    time, penetration, force : ndarray (n,)
    kinks : list of int
        Rows at which slopes may jump; so they may between rows of the same time.
    edge : ndarray (n,), optional
        Contact radii. Without them the cubics are those of time.

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
            steps = np.diff(time[rows]) if edge is None else _lengths(time[rows], edge[rows])
            work[first:last] += _beyond_straight(steps, penetration[rows], force[rows])
    return np.concatenate(([0.0], np.cumsum(work)))


def _lengths(time: Array, edge: Array) -> Array:
    """Lengths (n - 1,) of the path of the edge over time between rows, both in parts of their totals.

    The edge counts where it runs away. One that goes to and fro has a long way, and time counts there: where
    it turns and rests for a while, a length of its own way would not be smooth.
    """
    moved = np.abs(np.diff(edge))
    return np.hypot(np.diff(time) / np.ptp(time), moved / (moved.sum() or 1.0))


def _beyond_straight(step: Array, penetration: Array, force: Array) -> Array:
    """Difference between cubics and trapezoids, shape (n - 1,).

    With ``a``, ``b`` the slopes at both ends, times the step, less the chord's: ``F = chord + a s(1-s)^2 - b
    s^2(1-s)`` and the same for D; the integral of their product is a form in these.
    """

    def excess(values: Array) -> tuple[Array, Array, Array]:
        chord = np.diff(values)
        slope = _slopes(step, values)
        return chord, slope[:-1] * step - chord, slope[1:] * step - chord

    d, d0, d1 = excess(penetration)
    f, f0, f1 = excess(force)
    return (d * (f0 - f1) - f * (d0 - d1)) / 12.0 + (f1 * d0 - f0 * d1) / 60.0


def _slopes(step: Array, values: Array) -> Array:
    """Derivatives at the rows, of the parabola through each and its neighbours.

    A neighbour far closer than the other is passed over: what the two rows miss would be all of the secant.
    Where there is no other, the slope is the other secant.
    """
    place = np.concatenate(([0.0], np.cumsum(step)))
    at, inner, inside = place[1:-1], values[1:-1], np.arange(1, len(step))
    away = _LEAST_SHARE * np.maximum(step[:-1], step[1:])
    left = np.clip(place.searchsorted(at - away, "right") - 1, 0, inside - 1)
    right = np.clip(place.searchsorted(at + away, "left"), inside + 1, len(step))
    before, after = at - place[left], place[right] - at
    early, late = (inner - values[left]) / before, (values[right] - inner) / after
    middle = (early * after + late * before) / (before + after)
    middle = np.where(before < away, late, np.where(after < away, early, middle))
    first = 2.0 * (values[1] - values[0]) / step[0] - middle[0]
    last = 2.0 * (values[-1] - values[-2]) / step[-1] - middle[-1]
    return np.concatenate(([first], middle, [last]))
