"""History of the surface: internal variables on nodes that stay where they are.

Each side of the edge keeps the variables that are smooth there: scaled Maxwell stresses inside, where ``v``
has no singularity, and scaled Voigt strains outside, which do not carry the square root that ``v`` has at
the edge. Nodes are laid where the edge goes, graded towards it, and taken out again where a straight line
through their neighbours says the same to the stated tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_MOST_KINKS = 8
"""Kinks represented at once; the oldest are dropped."""


@dataclass(frozen=True)
class NodalVariables:
    """Nodes at ``radius`` (n,), rising, and their internal variables ``values`` (n, K).

    ``kinks`` are nodes where an edge rests or has rested: each leaves the square root of the distance beyond
    it. From a kink to the next the root of the distance from it is the coordinate of interpolation, in which
    such a state is smooth; before the first, the radius is. No slope is taken across a kink.
    """

    radius: Array
    values: Array
    kinks: tuple[float, ...] = ()

    @cached_property
    def _bounds(self) -> list[int]:
        """Nodes at which intervals between kinks begin, and the last node."""
        n = len(self.radius)
        at_kinks = np.searchsorted(self.radius, self.kinks)
        return sorted({0, *(int(node) for node in at_kinks if node < n - 1), n - 1})

    @cached_property
    def _origin(self) -> Array:
        """Origin of the root in each interval (n - 1); NaN where the radius is the coordinate."""
        origin = np.full(len(self.radius) - 1, np.nan)
        for low, high in pairwise(self._bounds):
            if low > 0 or (self.kinks and self.kinks[0] == self.radius[0]):
                origin[low:high] = self.radius[low]
        return origin

    @cached_property
    def _intervals(self) -> tuple[Array, Array, bool, Array, Array]:
        """Per interval: start, width, whether any has a root, width times the slopes at both ends."""
        n, branches = self.values.shape
        start, end = np.empty(n - 1), np.empty(n - 1)
        first, last = np.empty((n - 1, branches)), np.empty((n - 1, branches))
        for low, high in pairwise(self._bounds):
            at, values = self.radius[low : high + 1], self.values[low : high + 1]
            if not np.isnan(self._origin[low]):
                at = np.sqrt(at - at[0])
            slope = _slopes(at, values)
            start[low:high], end[low:high] = at[:-1], at[1:]
            first[low:high], last[low:high] = slope[:-1], slope[1:]
        width = end - start
        rooted = not np.isnan(self._origin).all()
        return start, width, rooted, width[:, None] * first, width[:, None] * last

    def at(self, radius: Array) -> Array:
        """Variables (m, K) at any radii (m,), by cubics; constant beyond the ends."""
        if len(self.radius) == 0:
            return np.zeros((len(radius), self.values.shape[1]))
        if len(self.radius) == 1:
            return np.repeat(self.values, len(radius), axis=0)
        start, width, rooted, first, last = self._intervals
        i = self.radius[1:-1].searchsorted(radius)
        x = radius
        if rooted:
            base = self._origin[i]
            x = np.where(np.isnan(base), radius, np.sqrt(np.maximum(radius - base, 0.0)))
        z = np.minimum(np.maximum((x - start[i]) / width[i], 0.0), 1.0)[:, None]
        y0, rest = self.values[i], 1.0 - z
        return (
            y0
            + z * z * (3.0 - 2.0 * z) * (self.values[i + 1] - y0)
            + z * rest * rest * first[i]
            - z * z * rest * last[i]
        )

    def coarsened(self, tolerance: float, spacing: Array, parity: int) -> NodalVariables:
        """Without every second node that its neighbours reproduce; both ends stay.

        Parameters
        ----------
        tolerance : float
            Largest change of any variable, in their own unit.
        spacing : ndarray (n,)
            Largest distance allowed between neighbours.
        parity : int
            0 or 1: which nodes are looked at.
        """
        i = np.arange(1 + parity, len(self.radius) - 1, 2)
        if len(i) == 0:
            return self
        origin = self._origin[i]
        x0, x, x1 = (
            np.where(np.isnan(origin), at, np.sqrt(np.maximum(at - origin, 0.0)))
            for at in (self.radius[i - 1], self.radius[i], self.radius[i + 1])
        )
        share = ((x - x0) / (x1 - x0))[:, None]
        change = np.abs(self.values[i - 1] * (1 - share) + self.values[i + 1] * share - self.values[i]).max(
            axis=1
        )
        close = self.radius[i + 1] - self.radius[i - 1] <= spacing[i]
        keep = np.ones(len(self.radius), bool)
        keep[i[(change <= tolerance) & close & ~np.isin(self.radius[i], self.kinks)]] = False
        return self._thinned(keep, tolerance)

    def _thinned(self, keep: NDArray[np.bool_], tolerance: float) -> NodalVariables:
        """The nodes kept, and those that the cubics through them miss by more than a tolerance.

        Where a short interval borders on one that the removal makes long, its slope overshoots there.
        """
        removed = np.flatnonzero(~keep)
        rest = NodalVariables(self.radius[keep], self.values[keep], self.kinks)
        missed = np.abs(rest.at(self.radius[removed]) - self.values[removed]).max(axis=1) > tolerance
        if not missed.any():
            return rest
        keep[removed[missed]] = True
        return NodalVariables(self.radius[keep], self.values[keep], self.kinks)


def _slopes(at: Array, values: Array) -> Array:
    """Derivatives at the nodes (n, K): of the parabola through each node and its neighbours."""
    gap = np.diff(at)[:, None]
    secant = np.diff(values, axis=0) / gap
    if len(gap) < 2:
        return np.repeat(secant, 2, axis=0)
    left, right = gap[:-1], gap[1:]
    middle = (secant[:-1] * right + secant[1:] * left) / (left + right)
    first, last = 2.0 * secant[:1] - middle[:1], 2.0 * secant[-1:] - middle[-1:]
    return np.concatenate((first, middle, last))


@dataclass(frozen=True)
class SurfaceHistory:
    """Scaled Maxwell stresses up to the edge, scaled Voigt strains from the edge on.

    ``direction`` is the sign of the last motion of the edge, ``farthest`` the radius it has reached in it
    (``None``: not yet any); ``turning`` the radius at which that motion began, until the edge has left it far
    enough for it to be a kink.
    """

    inner: NodalVariables
    outer: NodalVariables
    direction: int = 0
    turning: float | None = None
    farthest: float | None = None

    @property
    def kinks(self) -> tuple[float, ...]:
        """Where an edge rests or has rested, on either side."""
        return tuple(sorted({*self.inner.kinks, *self.outer.kinks}))

    @property
    def radius(self) -> Array:
        """All nodes, rising, the edge once."""
        return np.union1d(self.inner.radius, self.outer.radius)

    @classmethod
    def blank(cls, branches: int) -> SurfaceHistory:
        """An undisturbed surface."""
        empty = NodalVariables(np.empty(0), np.empty((0, branches)))
        return cls(empty, empty)


def distinct(radius: Array, fixed: tuple[float, ...], smallest: float) -> Array:
    """Sorted radii at least ``smallest`` apart, the ``fixed`` among them.

    Slopes between closer nodes would be rounding errors, and feed back into the motion of the edge.
    """
    merged = np.unique(np.concatenate((radius, fixed)))
    for value in fixed:
        merged = merged[(np.abs(merged - value) >= smallest) | np.isin(merged, fixed)]
    keep = np.ones(len(merged), bool)
    last = 0  # the outermost node kept so far
    # of a close pair the outer goes, unless it is fixed
    for outer in (np.flatnonzero(np.diff(merged) < smallest) + 1).tolist():
        last = outer - 1 if keep[outer - 1] else last
        if merged[outer] - merged[last] < smallest:
            keep[last if merged[outer] in fixed else outer] = False
    return merged[keep | np.isin(merged, fixed)]


def updated_kinks(
    before: SurfaceHistory, edge: float, new_edge: float, apart: float, rest: float
) -> tuple[tuple[float, ...], int, float | None, float]:
    """Kinks, direction, turning and farthest radius after the edge went from ``edge`` to ``new_edge``.

    Parameters
    ----------
    before : SurfaceHistory
    edge, new_edge : float
    apart : float
        Smallest distance of a kink from the edge and from newer kinks.
    rest : float
        Accuracy of the edge: so far back from its farthest radius it has not turned.

    Returns
    -------
    kinks : tuple of float
    direction : int
    turning : float or None
    farthest : float

    Notes
    -----
    An edge that turned, or started from rest, leaves a kink once it is ``apart`` from there. Kinks closer
    than that to the edge or to a newer one are dropped: the nodes that stay around them carry their
    history.
    """
    farthest = edge if before.farthest is None else before.farthest
    direction, turning = before.direction, before.turning
    ahead = (new_edge - farthest) * direction
    if ahead > 0.0:
        farthest = new_edge
    elif direction == 0 or ahead < -rest:
        direction = int(np.sign(new_edge - farthest)) or direction
        turning, farthest = farthest, new_edge
    kinks = [k for k in before.kinks if k != edge and abs(k - new_edge) >= apart]
    if turning is not None and abs(new_edge - turning) >= apart:
        kinks = [k for k in kinks if abs(k - turning) >= apart] + [turning]
        turning = None
    return tuple(sorted(kinks[-_MOST_KINKS:])), direction, turning, farthest


def graded_nodes(annuli_radii: Array, edge: float, reach: float) -> Array:
    """Collocation radii within ``reach`` inside the edge, their mirror images outside, and the edge."""
    inside = edge * annuli_radii
    inside = inside[inside >= edge - reach]
    return np.concatenate((inside, [edge], 2.0 * edge - inside))


def midpoints_of_wide_intervals(radius: Array, spacing: Array) -> Array:
    """Mid-points of the intervals that are longer than ``spacing`` (n - 1,) allows."""
    wide = np.diff(radius) > spacing
    return 0.5 * (radius[1:] + radius[:-1])[wide]
