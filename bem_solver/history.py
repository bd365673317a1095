"""History of the surface: internal variables on nodes that stay where they are.

Each side of the edge keeps the variables that are smooth there: scaled Maxwell stresses inside, where ``v``
has no singularity, and scaled Voigt strains outside, which do not carry the square root that ``v`` has at
the edge: cubics between nodes, over the radius or, beyond a place where an edge rests or has rested, over
the root of the distance from it. Nodes are laid where the edge goes, graded towards it, and taken out again
where a straight line through their neighbours says the same to the stated tolerance. Radii from the axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_LONG = 8.0
"""By how much longer than the next an interval is for its end there to count as joined by a short one."""


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
    def _intervals(self) -> tuple[Array, Array, Array]:
        """Start, width and origin of the root of each interval in its coordinate; NaN: that is the radius."""
        start, end = self.radius[:-1].copy(), self.radius[1:].copy()
        origin = np.full(len(start), np.nan)
        for low, high in pairwise(self._bounds):
            if low > 0 or (self.kinks and self.kinks[0] == self.radius[0]):
                origin[low:high] = self.radius[low]
                start[low:high] = np.sqrt(start[low:high] - self.radius[low])
                end[low:high] = np.sqrt(end[low:high] - self.radius[low])
        return start, end - start, origin

    @cached_property
    def _cubics(self) -> Array:
        """Cubics over the share of each interval, powers 0 to 3, shape (n - 1, 4, K)."""
        values, (_, width, _) = self.values, self._intervals
        cubics = np.empty((len(width), 4, values.shape[1]))
        cubics[:, 0] = values[:-1]
        rise, wide = values[1:] - values[:-1], width[:, None]
        for low, high in pairwise(self._bounds):
            first, last = _end_slopes(wide[low:high], rise[low:high])
            beyond = rise[low:high] - first
            cubics[low:high, 1] = first
            cubics[low:high, 3] = last - first - 2.0 * beyond
            cubics[low:high, 2] = beyond - cubics[low:high, 3]
        return cubics

    def at(self, radius: Array) -> Array:
        """Variables (m, K) at any radii (m,), by cubics; constant beyond the ends."""
        if len(self.radius) == 0:
            return np.zeros((len(radius), self.values.shape[1]))
        if len(self.radius) == 1:
            return np.repeat(self.values, len(radius), axis=0)
        start, width, origin = self._intervals
        i = self.radius[1:-1].searchsorted(radius)
        x = radius
        if self.kinks:
            base = origin.take(i)
            x = np.where(base == base, np.sqrt(np.maximum(radius - base, 0.0)), radius)
        z = np.minimum(np.maximum((x - start.take(i)) / width.take(i), 0.0), 1.0)[:, None]
        cubics = self._cubics.take(i, axis=0)
        return cubics[:, 0] + z * (cubics[:, 1] + z * (cubics[:, 2] + z * cubics[:, 3]))

    def coarsened(self, tolerance: float, spacing: Array, parity: int) -> NodalVariables:
        """Without every second node that its neighbours reproduce; both ends stay."""
        i = np.arange(1 + parity, len(self.radius) - 1, 2)
        if len(i) == 0:
            return self
        width, rise = self._intervals[1], self.values[1:] - self.values[:-1]
        # coordinates of the two sides of a kink differ: kinks stay below
        share = (width[i - 1] / (width[i - 1] + width[i]))[:, None]
        change = np.abs(share * rise[i] - (1.0 - share) * rise[i - 1]).max(axis=1)
        close = self.radius[i + 1] - self.radius[i - 1] <= spacing[i]
        keep = np.ones(len(self.radius), bool)
        keep[i[(change <= tolerance) & close]] = False
        keep[self._bounds] = True
        return NodalVariables(self.radius[keep], self.values[keep], self.kinks)


def _slopes(gap: Array, rise: Array) -> Array:
    """Derivatives at the nodes (n, K): of the parabola through each node and its neighbours."""
    secant = rise / gap
    if len(gap) < 2:
        return np.repeat(secant, 2, axis=0)
    left, right = gap[:-1], gap[1:]
    middle = (secant[:-1] * right + secant[1:] * left) / (left + right)
    first, last = 2.0 * secant[:1] - middle[:1], 2.0 * secant[-1:] - middle[-1:]
    return np.concatenate((first, middle, last))


def _end_slopes(gap: Array, rise: Array) -> tuple[Array, Array]:
    """Derivatives at both ends of each interval over its share, each (n - 1, K).

    Where a far shorter interval joins, no steeper than a cubic may be that stays between its ends.
    """
    slope = _slopes(gap, rise)
    first, last = gap * slope[:-1], gap * slope[1:]
    after, before = gap[1:] > _LONG * gap[:-1], gap[1:] * _LONG < gap[:-1]
    least, most = np.minimum(3.0 * rise, 0.0), np.maximum(3.0 * rise, 0.0)
    first[1:] = np.where(after, np.clip(first[1:], least[1:], most[1:]), first[1:])
    last[:-1] = np.where(before, np.clip(last[:-1], least[:-1], most[:-1]), last[:-1])
    return first, last


NODES_APART = 0.05
"""How far apart nodes are, as a part of their distance from the edge, where that is several zones."""
_FARTHEST, _NEAREST_END = 200.0, 20.0
"""How far out nodes are laid, in contact radii, and how near the last may be before there are more."""


@dataclass(frozen=True)
class SurfaceHistory:
    """Scaled Maxwell stresses up to the edge, scaled Voigt strains from the edge on.

    ``direction`` is the sign of the last motion of the edge, ``farthest`` the radius it has reached in it
    (``None``: not yet any); ``turning`` the radius at which that motion began, or of a kink that it comes
    near, until the edge has left it far enough for it to be a kink.
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
    def past_kinks(self) -> tuple[float, ...]:
        """Where an edge has rested or turned, without the edge itself."""
        edge = self.outer.radius[:1].tolist()
        turning = () if self.turning is None else (self.turning,)
        return tuple(kink for kink in (*self.kinks, *turning) if kink not in edge)

    def rested_at(self, edge: float) -> float | None:
        """Radius from which an edge sets out if it advances now, or has set out and is still near."""
        if edge <= 0.0:
            return None
        if self.direction > 0:
            return None if self.turning is None else min(self.turning, edge)
        return edge if self.farthest is None else min(self.farthest, edge)

    @cached_property
    def radius(self) -> Array:
        """All nodes, rising, the edge once."""
        return np.concatenate((self.inner.radius[:-1], self.outer.radius))

    def outside(self, radius: Array) -> Array:
        """Strains (m, K) outside the edge: beyond the last node they fall as ``1/r``, far from any load."""
        strains = self.outer.at(radius)
        if len(self.outer.radius):
            strains *= np.minimum(self.outer.radius[-1] / radius, 1.0)[:, None]
        return strains

    @classmethod
    def blank(cls, branches: int) -> SurfaceHistory:
        """An undisturbed surface."""
        empty = NodalVariables(np.empty(0), np.empty((0, branches)))
        return cls(empty, empty)


def distinct(radius: Array, fixed: tuple[float, ...], smallest: float) -> Array:
    """Sorted radii at least ``smallest`` apart, lest slopes be rounding, the ``fixed`` among them."""
    merged = np.unique(radius)
    free = merged[np.abs(merged[:, None] - np.array(fixed)).min(axis=1, initial=math.inf) >= smallest]
    keep = np.ones(len(free), bool)
    last = 0  # the outermost node kept so far
    for outer in (np.flatnonzero(np.diff(free) < smallest) + 1).tolist():
        last = outer - 1 if keep[outer - 1] else last
        keep[outer] = free[outer] - free[last] >= smallest
    return np.union1d(free[keep], fixed)


def updated_kinks(
    before: SurfaceHistory, edge: float, new_edge: float, apart: float, rest: float
) -> tuple[tuple[float, ...], int, float | None, float]:
    """Kinks, direction, turning and farthest radius after the edge went from ``edge`` to ``new_edge``.

    An edge that turned leaves a kink once it is ``apart`` from there; kinks closer than that to a newer one
    are dropped. One that the edge comes near takes the place of the turning until the edge has passed it.
    """
    farthest = edge if before.farthest is None else before.farthest
    direction, turning = before.direction, before.turning
    ahead = (new_edge - farthest) * direction
    if ahead > 0.0:
        farthest = new_edge
    elif direction == 0 or ahead < -rest:
        direction = int(np.sign(new_edge - farthest)) or direction
        turning, farthest = farthest, new_edge
    older = [k for k in before.kinks if k != edge and abs(k - new_edge) >= rest]
    kinks = [k for k in older if abs(k - new_edge) >= apart]
    if turning is not None and abs(new_edge - turning) >= apart:
        kinks = [k for k in kinks if abs(k - turning) >= apart] + [turning]
        turning = None
    if turning is None and len(kinks) < len(older):
        turning = min(older, key=lambda kink: abs(kink - new_edge))
    elif turning is None and any(k != edge and abs(k - new_edge) < rest for k in before.kinks):
        turning = new_edge
    return tuple(sorted(kinks)), direction, turning, farthest


def graded_nodes(annuli_radii: Array, edge: float, reach: float) -> Array:
    """Collocation radii within ``reach`` inside the edge, their mirror images outside, and the edge."""
    inside = edge * annuli_radii
    inside = inside[inside >= edge - reach]
    return np.concatenate((inside, [edge], 2.0 * edge - inside))


def nodes_beyond(edge: float, length: float, last: float = 0.0) -> Array:
    """Radii from ``length`` outside the edge to far beyond, at distances from it in equal ratios."""
    size = edge + length
    if last >= _NEAREST_END * size:
        return np.empty(0)
    way = _FARTHEST * size - edge
    radii = edge + np.geomspace(length, way, math.ceil(math.log(way / length) / NODES_APART) + 1)
    return radii[radii > last]


def midpoints_of_wide_intervals(radius: Array, spacing: Array) -> Array:
    """Mid-points of the intervals that are longer than ``spacing`` (n - 1,) allows."""
    wide = np.diff(radius) > spacing
    return 0.5 * (radius[1:] + radius[:-1])[wide]
