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
Selection = slice | NDArray[np.bool_]

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
        held = np.arange(len(self.positions)) < self.edge
        inner = held & (self.positions < min(nodes.positions[first], edge))
        outer = ~held & (self.positions > nodes.positions[last])
        within, beyond = slice(first, nodes.edge), slice(nodes.edge, last + 1)
        left = _thinned(*self._joined(inner, nodes, within), int(inner.sum()))
        # mirrored: the points that may go come first
        x, values = nodes._joined(beyond, self, outer)
        right = _thinned(-x[::-1], values[:, ::-1], int(outer.sum()))
        return SurfaceRecord(
            np.concatenate([left[0], -right[0][::-1]]),
            np.hstack([left[1], right[1][:, ::-1]]),
            len(left[0]),
        )

    def _joined(self, own: Selection, other: SurfaceRecord, others: Selection) -> tuple[Array, Array]:
        """Positions and intensities of points of two records, those of this one first."""
        return (
            np.concatenate([self.positions[own], other.positions[others]]),
            np.hstack([self.intensity[:, own], other.intensity[:, others]]),
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


def _thinned(x: Array, values: Array, count: int) -> tuple[Array, Array]:
    """Every second of the first points dropped where neither a line nor the interpolation misses it.

    The interpolation takes its slopes from the intervals beside a point. Where one of them is far longer than
    the other, points on a line alone would not keep it on that line.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Rising.
    values : ndarray, shape (rows, m)
    count : int
        Number of points that may be dropped.

    Returns
    -------
    x, values : ndarray
    """
    middle = np.arange(1, min(count, len(x) - 1), 2)
    if not middle.size:
        return x, values
    share = (x[middle] - x[middle - 1]) / (x[middle + 1] - x[middle - 1])
    line = (1.0 - share) * values[:, middle - 1] + share * values[:, middle + 1]
    allowed = _STRAIGHT * np.abs(values).max(axis=1, keepdims=True)
    dropped = middle[(np.abs(values[:, middle] - line) <= allowed).all(axis=0)]
    kept = np.ones(len(x), dtype=bool)
    while dropped.size:
        kept[dropped] = False
        at = np.concatenate(
            [0.5 * (x[dropped - 1] + x[dropped]), x[dropped], 0.5 * (x[dropped] + x[dropped + 1])]
        )
        missed = np.abs(interpolated(x[kept], values[:, kept], at) - interpolated(x, values, at)) > allowed
        needed = missed.any(axis=0).reshape(3, -1).any(axis=0)
        kept[dropped[needed]] = True
        if not needed.any():
            break
        dropped = dropped[~needed]
    return x[kept], values[:, kept]
