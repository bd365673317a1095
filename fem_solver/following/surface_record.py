"""What the edge has left on the surface, finer than the mesh holds where it is not at present.

Away from the edge a component changes by itself: in contact by the penetration, outside by recovery, and its
intensity, the branch variables over ``L^-1 1``, by the same law at every radius. Points that a fine strip has
seen are thus followed exactly, whatever mesh there is now.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from fem_solver.following.components import Components

Array = NDArray[np.float64]

_STRAIGHT = 1e-4
"""Deviation from a line between its neighbours below which a point is dropped, relative to the largest
intensity of the branch: a tenth of the tolerance of a step."""


@dataclass(frozen=True)
class SurfaceRecord:
    """Intensities of the branch variables at radii.

    Parameters
    ----------
    positions : ndarray, shape (m,)
        Radii, rising.
    intensity : ndarray, shape (branches, m)
    edge : int
        Number of points in contact; the next one is the node that is released in part.
    """

    positions: Array
    intensity: Array
    edge: int

    def renewed(self, nodes: SurfaceRecord, range_of_nodes: tuple[int, int], edge: float) -> SurfaceRecord:
        """The record with what the mesh knows in a range of its nodes, thinned elsewhere.

        Points that the edge has passed are left out wherever they are: with wide elements there they may lie
        short of the first node that has changed.

        Parameters
        ----------
        nodes : SurfaceRecord
            The nodes of the mesh.
        range_of_nodes : tuple of int
            First and last node that replace what there is; the edge is between them.
        edge : float
            Where the edge is now.

        Returns
        -------
        SurfaceRecord
        """
        first, last = range_of_nodes
        kept = slice(first, last + 1)
        held = np.arange(len(self.positions)) < self.edge
        inner = held & (self.positions < min(nodes.positions[first], edge))
        outer = ~held & (self.positions > nodes.positions[last])
        left = _thinned(self.positions[inner], self.intensity[:, inner])
        right = _thinned(self.positions[outer], self.intensity[:, outer])
        return SurfaceRecord(
            np.concatenate([left[0], nodes.positions[kept], right[0]]),
            np.hstack([left[1], nodes.intensity[:, kept], right[1]]),
            len(left[0]) + nodes.edge - first,
        )

    def after(self, solid: Components, dt: float, change: float) -> SurfaceRecord:
        """The record after a time, of which what the edge passes is wrong.

        Parameters
        ----------
        solid : Components
        dt : float
            Time; 0 for a glassy response.
        change : float
            Of the penetration.

        Returns
        -------
        SurfaceRecord
        """
        inside, outside = self.intensity[:, : self.edge], self.intensity[:, self.edge :]
        pressed = np.full(inside.shape[1], change)
        within = solid.linear(np.zeros_like(pressed), inside, dt, pressed)
        return SurfaceRecord(self.positions, np.hstack([within, solid.recovered(outside, dt)[1]]), self.edge)


def interpolated(x: Array, values: Array, at: Array) -> Array:
    """Monotonic cubic interpolation of every row, continued by at most one interval.

    Parameters
    ----------
    x : ndarray, shape (m,)
    values : ndarray, shape (rows, m)
    at : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (rows, n)
    """
    if x.size < 2:
        return np.repeat(values[:, -1:], len(at), axis=1) if x.size else np.zeros((len(values), len(at)))
    if not values.any():
        return np.zeros((len(values), len(at)))
    low, high = 2.0 * x[0] - x[1], 2.0 * x[-1] - x[-2]
    # the two points on either side of each place make the cubic there
    beside = np.searchsorted(x, at)[:, None] + np.arange(-2, 2)
    used = np.unique(np.clip(beside, 0, len(x) - 1))
    if used.size < 2:
        used = np.arange(len(x))
    with np.errstate(over="ignore"):  # over a difference lost in underflow: the slope there is then zero
        return np.asarray(PchipInterpolator(x[used], values[:, used], axis=1)(np.clip(at, low, high)))


def averaged(x: Array, values: Array, bounds: Array) -> Array:
    """Means of the same interpolation over adjoining intervals: what a jump adds to a sum over them stays.

    Parameters
    ----------
    x : ndarray, shape (m,)
    values : ndarray, shape (rows, m)
    bounds : ndarray, shape (n + 1,)
        Rising.

    Returns
    -------
    ndarray, shape (rows, n)
    """
    if x.size < 2 or not values.any():
        return interpolated(x, values, bounds[1:])
    within = np.clip(bounds, x[0], x[-1])
    with np.errstate(over="ignore"):  # as above
        total = PchipInterpolator(x, values, axis=1).antiderivative()(within)
    total += values[:, :1] * np.minimum(bounds - x[0], 0.0) + values[:, -1:] * np.maximum(bounds - x[-1], 0.0)
    return np.asarray(np.diff(total, axis=1) / np.diff(bounds))


def _thinned(x: Array, values: Array) -> tuple[Array, Array]:
    """Every second point dropped where all rows are straight."""
    if x.size < 5:
        return x, values
    middle = np.arange(1, len(x) - 1, 2)
    share = (x[middle] - x[middle - 1]) / (x[middle + 1] - x[middle - 1])
    line = (1.0 - share) * values[:, middle - 1] + share * values[:, middle + 1]
    largest = np.abs(values).max(axis=1, keepdims=True)
    kept = np.ones(len(x), dtype=bool)
    kept[middle] = (np.abs(values[:, middle] - line) > _STRAIGHT * largest).any(axis=0)
    return x[kept], values[:, kept]
