"""Internal variables on nodes of the surface, and what they are between them.

On one side of the edge they are smooth: cubics between nodes, over the radius or, beyond a place where an
edge rests or has rested, over the root of the distance from it. Nodes that a straight line through their
neighbours reproduces are taken out again. Radii from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LONG = 8.0
"""By how much longer than the next an interval is for its end there to count as joined by a short one."""
_HALVINGS = 16
"""Nodes beyond a kink that stand for it, at its reach halved once, twice and so on, and their mirror images:
a long interval beside a short one with the root in it would overshoot with the slope between them."""


@dataclass(frozen=True)
class NodalVariables:
    """Nodes at ``radius`` (n,), rising, and their internal variables ``values`` (n, K).

    ``kinks`` are nodes where an edge rests or has rested: each leaves the square root of the distance beyond
    it. From a kink to the next the root of the distance from it is the coordinate of interpolation, in which
    such a state is smooth; before the first, the radius is. No slope is taken across a kink. Where an edge
    that has just set off is the first node, ``rest`` is the radius it has rested at: the root is still that.
    """

    radius: Array
    values: Array
    kinks: tuple[float, ...] = ()
    rest: float | None = None

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
                origin[low:high] = self.radius[low] if low > 0 or self.rest is None else self.rest
        return origin

    @cached_property
    def _intervals(self) -> tuple[Array, Array]:
        """Start and width of each interval in its coordinate, each shape (n - 1,)."""
        start, end = self.radius[:-1].copy(), self.radius[1:].copy()
        for low, high in pairwise(self._bounds):
            if not np.isnan(self._origin[low]):
                start[low:high] = np.sqrt(start[low:high] - self._origin[low])
                end[low:high] = np.sqrt(end[low:high] - self._origin[low])
        return start, end - start

    @cached_property
    def _cubics(self) -> Array:
        """Cubics over the share of each interval, powers 0 to 3, shape (n - 1, 4, K)."""
        values, (_, width) = self.values, self._intervals
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
        start, width = self._intervals
        i = self.radius[1:-1].searchsorted(radius)
        x = radius
        if self.kinks:
            base = self._origin.take(i)
            x = np.where(base == base, np.sqrt(np.maximum(radius - base, 0.0)), radius)
        z = np.minimum(np.maximum((x - start.take(i)) / width.take(i), 0.0), 1.0)[:, None]
        cubics = self._cubics.take(i, axis=0)
        values = cubics[:, 3] * z
        for power in (2, 1):
            values += cubics[:, power]
            values *= z
        values += cubics[:, 0]
        return values

    def roots_at_kinks(self) -> tuple[Array, Array]:
        """Kinks beyond the first node, and the roots of the distance that begin there.

        Returns
        -------
        radius : ndarray (k,)
        strength : ndarray (k, K)
            ``s`` in ``values = ... + s sqrt(r - radius)``.
        """
        sections = [section for section in pairwise(self._bounds) if section[0] > 0]
        width, strength = self._intervals[1], np.empty((len(sections), self.values.shape[1]))
        for strengths, (low, high) in zip(strength, sections, strict=True):
            last = min(low + 2, high)
            rise = self.values[low + 1 : last + 1] - self.values[low:last]
            strengths[:] = _slopes(width[low:last, None], rise)[0]
        return self.radius[[low for low, _ in sections]], strength

    def with_distinct_kinks(self, faded: float, edge: float, apart: float) -> NodalVariables:
        """Without kinks whose root has faded, and without one of two that the edge cannot tell apart.

        Parameters
        ----------
        faded : float
            What a root that has faded reaches at most, in the unit of the variables, over a distance as long
            as the radius of its kink.
        edge : float
        apart : float
            Least distance of two kinks as a part of theirs from the edge.

        Returns
        -------
        NodalVariables
            Of two close kinks that of the stronger root stays, and nodes keep what the other one leaves.
        """
        kinks, strength = self.roots_at_kinks()
        size = np.abs(strength).max(axis=1, initial=0.0) * np.sqrt(kinks)
        gone = size <= faded
        double = np.zeros(len(kinks), bool)
        for inner, outer in pairwise(np.flatnonzero(~gone).tolist()):
            if not double[inner] and kinks[outer] - kinks[inner] < apart * abs(kinks[inner] - edge):
                double[inner if size[inner] < size[outer] else outer] = True
        if not (gone | double).any():
            return self
        bounds = np.concatenate((self.radius[:1], kinks, self.radius[-1:]))
        inside, beyond = (kinks - bounds[:-2])[double, None], (bounds[2:] - kinks)[double, None]
        steps = np.minimum(beyond, kinks[double, None]) * 0.5 ** np.arange(1.0, _HALVINGS + 1.0)
        nodes = kinks[double, None] + np.concatenate((steps, -np.minimum(steps, inside)), axis=1)
        radius = np.union1d(self.radius, nodes)
        left = tuple(kink for kink in self.kinks if kink not in kinks[gone | double])
        return NodalVariables(radius, self.at(radius), left, self.rest)

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
        width, rise = self._intervals[1], self.values[1:] - self.values[:-1]
        # coordinates of the two sides of a kink differ: kinks stay below
        share = (width[i - 1] / (width[i - 1] + width[i]))[:, None]
        change = np.abs(share * rise[i] - (1.0 - share) * rise[i - 1]).max(axis=1)
        close = self.radius[i + 1] - self.radius[i - 1] <= spacing[i]
        keep = np.ones(len(self.radius), bool)
        keep[i[(change <= tolerance) & close]] = False
        keep[self._bounds] = True
        return self._thinned(keep, tolerance)

    def _thinned(self, keep: NDArray[np.bool_], tolerance: float) -> NodalVariables:
        """The nodes kept, and those that the cubics through them miss by more than a tolerance.

        Where a short interval borders on one that the removal makes long, its slope overshoots there.
        """
        removed = np.flatnonzero(~keep)
        thinned = NodalVariables(self.radius[keep], self.values[keep], self.kinks, self.rest)
        missed = np.abs(thinned.at(self.radius[removed]) - self.values[removed]).max(axis=1) > tolerance
        if not missed.any():
            return thinned
        keep[removed[missed]] = True
        return NodalVariables(self.radius[keep], self.values[keep], self.kinks, self.rest)


def _slopes(gap: Array, rise: Array) -> Array:
    """Derivatives at the nodes (n, K): of the parabola through each node and its neighbours.

    From the gaps (n - 1, 1) and the rises (n - 1, K) between them.
    """
    secant = rise / gap
    if len(gap) < 2:
        return np.repeat(secant, 2, axis=0)
    left, right = gap[:-1], gap[1:]
    middle = (secant[:-1] * right + secant[1:] * left) / (left + right)
    first, last = 2.0 * secant[:1] - middle[:1], 2.0 * secant[-1:] - middle[-1:]
    return np.concatenate((first, middle, last))


def _end_slopes(gap: Array, rise: Array) -> tuple[Array, Array]:
    """Derivatives at both ends of each interval over its share, each (n - 1, K).

    At the end that a far shorter interval joins no steeper than a cubic may be that stays between its ends:
    the parabola through both has the slope of the short one, whatever is in the long one.
    """
    slope = _slopes(gap, rise)
    first, last = gap * slope[:-1], gap * slope[1:]
    ratio = gap[1:, 0] / gap[:-1, 0]
    after = np.flatnonzero(ratio > _LONG) + 1
    before = np.flatnonzero(ratio * _LONG < 1.0)
    for ends, joined in ((first, after), (last, before)):
        if len(joined):
            most = 3.0 * rise[joined]
            ends[joined] = np.minimum(np.maximum(ends[joined], np.minimum(most, 0.0)), np.maximum(most, 0.0))
    return first, last
