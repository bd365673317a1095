"""What a fall of the load that moves with the edge leaves of itself at points the edge does not pass.

``int (exp(-(t_end - t)/theta) - even) dS(|r - a(t)|, t)`` along a path, by parts; what remains is smooth in
the root of the abscissa of the path (step or travel) from the passage of the edge, within or beyond the step.
Where and when the fall is read follows from the path alone: it is worked out once for all falls that are
tried along it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bem_solver.bent_path import BentPath
from bem_solver.creep import SMALLEST

Array = NDArray[np.float64]
Fall = Callable[[Array, Array], Array]

_RULES = {
    longest: (0.5 * (nodes + 1.0), 0.5 * weights)
    for longest, (nodes, weights) in (
        (most, np.polynomial.legendre.leggauss(count)) for most, count in ((1.0, 12), (math.inf, 20))
    )
}
"""Quadratures over a step by its length, in retardation times, up to which they are exact to 1e-6."""
_FORGOTTEN = 36.0
"""Time, in retardation times, after which nothing is left of a lag: ``exp(-36)`` is rounding."""


@dataclass(frozen=True)
class RecentChange:
    """Between two shares of a step still to come, at radii that the edge does not pass between them.

    ``radius``, ``begin`` and ``end`` are (m, 1), ``y`` (K,) is the step in retardation times.
    """

    path: BentPath
    radius: Array
    y: Array
    begin: Array
    end: Array

    @classmethod
    def along(cls, path: BentPath, radius: Array, y: Array, begin: Array, end: Array) -> RecentChange:
        """Of a path.

        Parameters
        ----------
        path : BentPath
        radius : ndarray (m,)
        y : ndarray (K,)
            Step, in retardation times.
        begin, end : ndarray (m,)
            Shares still to come, ``begin >= end``.

        Returns
        -------
        RecentChange
        """
        return cls(path, radius[:, None], y, begin[:, None], end[:, None])

    def of(self, fall: Fall, even: Array | float = 0.0) -> Array:
        """The integral (m, K) of a fall.

        Parameters
        ----------
        fall : callable
            ``S`` of a distance from the edge, a square root near it, and the share of the path's abscissa
            gone by.
        even : ndarray (m, K) or (K,), optional
            Share of an even change that is taken off.

        Returns
        -------
        ndarray (m, K)
        """
        y, (distance, come) = self.y, self._ends
        at_ends = fall(distance, come)
        left_of_begin = self._left_of_begin - even
        change = (1.0 - even) * at_ends[:, 1:] - left_of_begin * at_ends[:, :1]
        remembered = self._remembered
        if remembered.all():
            return change - self._whole.lagging(fall)
        if remembered.any():
            change[:, remembered] -= Lagging.along(self, y[remembered], self._first).lagging(fall)
        forgets = ~remembered
        if forgets.any():
            since = self.path.abscissa(np.minimum(self.begin, self.end + _FORGOTTEN / y[forgets]))
            change[:, forgets] -= Lagging.along(self, y[forgets], since).lagging(fall)
        return change

    @cached_property
    def _first(self) -> Array:
        """Abscissa to come at the begin (m, 1)."""
        return self.path.abscissa(self.begin)

    @cached_property
    def last(self) -> Array:
        """Abscissa to come at the end (m, 1)."""
        return self.path.abscissa(self.end)

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """Distance from the edge and abscissa gone by, at begin and end, each (m, 2)."""
        ends = np.concatenate((self._first, self.last), axis=1)
        return np.abs(self.radius - self.path.edge_on(ends)), 1.0 - ends

    @cached_property
    def _left_of_begin(self) -> Array:
        return np.exp(self.y * (self.end - self.begin))

    @cached_property
    def _remembered(self) -> NDArray[np.bool_]:
        """Branches (K,) in which something is left of the begin."""
        return self.y * float((self.begin - self.end).max(initial=0.0)) <= _FORGOTTEN

    @cached_property
    def _whole(self) -> Lagging:
        return Lagging.along(self, self.y, self._first)


@dataclass(frozen=True)
class Lagging:
    """``int S(|r - a(t)|, t) d exp(-(t_end - t)/theta)`` between two shares of the abscissa to come.

    Read at ``distance`` from the edge and abscissa ``come``, each (m, k, points), with weights (m, k) and
    (m, k, points); ``k`` is 1, or K where the branches do not all begin at once: the fall is read once for
    all of them otherwise, and that is what costs.
    """

    distance: Array
    come: Array
    z: Array
    slope: Array | None
    memory: Array
    weights: Array
    scale: Array

    @classmethod
    def along(cls, change: RecentChange, y: Array, first: Array) -> Lagging:
        """From a share of the abscissa to the end of a change.

        Parameters
        ----------
        change : RecentChange
            At radii (m, 1).
        y : ndarray (K,)
            Step, in the retardation times of the branches it is for.
        first : ndarray (m, 1) or (m, K)
            Abscissa to come where it begins.

        Returns
        -------
        Lagging
        """
        path, last = change.path, change.last
        passage = path.passage(change.radius)
        before = passage >= 0.5 * (first + last)  # the passage lies before, not after
        away = np.where(before, -1.0, 1.0)
        nearest = np.where(before, np.minimum(first, passage), np.maximum(last, passage))
        near = np.sqrt(away * (nearest - passage))
        length = float(y.max())
        points, weights = next(rule for longest, rule in _RULES.items() if length <= longest)
        # from the nearest share, not from the passage: an edge that hardly moves passes 1e16 steps away
        ways = np.maximum(away * (np.where(before, last, first) - nearest), 0.0)
        reach = ways / np.maximum(near + np.sqrt(near**2 + ways), SMALLEST)
        beyond = reach[..., None] * points
        z = near[..., None] + beyond
        abscissa = nearest[..., None] + away[..., None] * beyond * (near[..., None] + z)
        left = path.share.at(abscissa) if path.of_travel else abscissa
        distance = np.abs(change.radius[..., None] - path.edge_on(abscissa))
        slope = path.share.slope(abscissa) if path.of_travel else None
        memory = np.exp(y[:, None] * (change.end[..., None] - left))  # (m, K, points)
        return cls(distance, 1.0 - abscissa, z, slope, memory, weights, 2.0 * y * reach)

    def lagging(self, fall: Fall) -> Array:
        """The integral (m, K) of a fall."""
        values = fall(self.distance, self.come) * self.z
        if self.slope is not None:
            values *= self.slope
        return self.scale * ((values * self.memory) @ self.weights)
