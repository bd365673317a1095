"""Path of the edge in a step that passes over process zones, and what its square root does on the way.

What the closure sees at the end of such a step was left behind within it, at times that follow from the path,
and the condition there is one on the speed of the edge. The path is the parabola through the edge at the
last two rows and at the end of the step: with rows of equal spacing its speed there is the second-order
backward differentiation formula. That of a receding edge is the cubic through one more row, of third order;
the closure of an advancing one hardly depends on its speed, so that the unevenness of more rows would come
back magnified. Times count from the end of the step backwards, because what matters happens just before it:
``g`` is the share of the step still to come.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import SMALLEST
from bem_solver.outer_fall import OuterFall

Array = NDArray[np.float64]

_LARGEST_BEND = 0.99
"""Change of the speed within a step, relative to its mean over it: below 1 the edge does not turn."""
_RULES = {
    longest: (0.5 * (nodes + 1.0), 0.5 * weights)
    for longest, (nodes, weights) in (
        (most, np.polynomial.legendre.leggauss(count)) for most, count in ((1.0, 12), (math.inf, 20))
    )
}
"""Quadratures over a step by its length, in retardation times, up to which they are exact to 1e-6."""
_NEWTON_STEPS = 4
"""For the share at which a cubic path passes a radius, from that of a parabola close to it."""
_FORGOTTEN = 36.0
"""Time, in retardation times, after which nothing is left of a lag: ``exp(-36)`` is rounding."""


@dataclass(frozen=True)
class EarlierRow:
    """A row before the last, through which paths are parabolas: its time before the last, its penetration.

    With adhesion also its ``edge`` and its ``load``, ``v`` at a distance ``ahead`` outside the edge. Where
    the edge has a curved path, ``ahead`` is zero and ``fall`` that of the load outside the last row;
    ``further`` are time before the last and edge of the row before this one, where that path is a cubic.
    """

    time: float
    penetration: float
    edge: float | None = None
    load: float | None = None
    ahead: float = 0.0
    fall: OuterFall | None = None
    further: tuple[float, float] | None = None


def _root_of_parabola(first: float, second: float, value: Array) -> Array:
    """Root near ``value/first`` of ``first x + second x**2 = value``, or where that comes nearest."""
    root = np.sqrt(np.maximum(first**2 + 4.0 * second * value, 0.0))
    return 2.0 * value / (first + np.copysign(root, first))


def parabola_bend(earlier: tuple[float, float], value: float, duration: float, end: float) -> float:
    """``c`` of the parabola ``value + (end - value) s + c s (s - 1)`` over a share s of a step.

    Parameters
    ----------
    earlier : tuple of float
        Time from an earlier row to the start of the step, and the value at that row.
    value : float
        At the start of the step.
    duration : float
    end : float
        Value at the end of the step.

    Returns
    -------
    float
    """
    time, before = earlier
    return ((end - value) / duration - (value - before) / time) / (duration + time) * duration**2


@dataclass(frozen=True)
class BentPath:
    """``a(g) = end - travel g - bend g (1 - g) - twist g (1 - g) (reach - g)``, share ``g`` still to come.

    The cubic part is zero at both ends of the step and at the row before, ``reach`` steps back.
    """

    end: float
    travel: float
    bend: float
    twist: float = 0.0
    reach: float = 1.0

    @classmethod
    def straight(cls, edge: float, end: float) -> BentPath:
        """The path of constant speed."""
        return cls(end, end - edge, 0.0)

    @classmethod
    def through(
        cls,
        before: tuple[float, float],
        edge: float,
        duration: float,
        end: float,
        further: tuple[float, float] | None = None,
    ) -> BentPath:
        """The parabola, or the cubic, through earlier rows and both ends of a step.

        Parameters
        ----------
        before, edge, duration, end
            The four of :func:`parabola_bend`, its value being the edge.
        further : tuple of float, optional
            Time from one more row, the earliest, to the start of the step, and the edge there.

        Returns
        -------
        BentPath
        """
        travel = end - edge
        limit = _LARGEST_BEND * abs(travel)
        bend = min(max(parabola_bend(before, edge, duration, end), -limit), limit)
        if further is None:
            return cls(end, travel, bend)
        reach, share = 1.0 + before[0] / duration, -further[0] / duration
        missed = further[1] - (edge + travel * share + bend * share * (share - 1.0))
        twist = missed / (share * (share - 1.0) * (share + reach - 1.0))
        limit = max(limit - abs(bend), 0.0) / reach
        return cls(end, travel, bend, min(max(twist, -limit), limit), reach)

    def edge(self, left: Array) -> Array:
        """Edge with a share of the step still to come."""
        bend = self.bend if self.twist == 0.0 else self.bend + self.twist * (self.reach - left)
        return self.end - left * (self.travel + bend * (1.0 - left))

    def left(self, radius: Array) -> Array:
        """Share of the step still to come when the edge passes a radius.

        Beyond [0, 1] continued by the parabola that follows the path at that end; where it does not reach the
        radius, the share at which it comes nearest.
        """
        distance = self.end - radius
        if self.twist == 0.0:
            return _root_of_parabola(self.travel + self.bend, -self.bend, distance)
        first = self.travel + self.bend + self.twist * self.reach
        second = -self.bend - self.twist * (1.0 + self.reach)
        at_start = first + 2.0 * second + 3.0 * self.twist
        early = 1.0 + _root_of_parabola(at_start, second + 3.0 * self.twist, distance - self.travel)
        late = _root_of_parabola(first, second, distance)
        part = distance / self.travel
        share = np.minimum(np.maximum(np.where(part > 0.5, early, late), 0.0), 1.0)
        for _ in range(_NEWTON_STEPS):
            missed = share * (first + share * (second + share * self.twist)) - distance
            slope = first + share * (2.0 * second + 3.0 * share * self.twist)
            share = np.minimum(np.maximum(share - missed / slope, 0.0), 1.0)
        return np.where(part <= 0.0, late, np.where(part >= 1.0, early, share))

    def mean_since(self, left: Array) -> Array:
        """Mean speed from a share of the step still to come on, over the speed then."""
        bend = self.bend + self.twist * (self.reach - left)
        mean = self.travel + bend * (1.0 - left)
        return mean / (mean - left * (bend + self.twist * (1.0 - left)))

    def distance(self, radius: Array, left: Array) -> Array:
        """``|r - a|`` with a share of the step still to come."""
        return np.abs(radius - self.edge(left))

    def recent_change(
        self,
        fall: Callable[[Array, Array], Array],
        radius: Array,
        y: Array,
        begin: Array,
        end: Array,
        even: Array | float = 0.0,
    ) -> Array:
        """``int (exp(-(t_end - t)/theta) - even) dS(|r - a(t)|, t)`` between two shares still to come.

        Parameters
        ----------
        fall : callable
            ``S`` of a distance from the edge, a square root near it, and the share still to come.
        radius : ndarray (m,)
            Radii that the edge does not pass between them.
        y : ndarray (K,)
            Step, in retardation times.
        begin, end : ndarray (m,)
            Shares still to come, ``begin >= end``.
        even : ndarray (m, K) or (K,), optional
            Share of an even change that is taken off.

        Returns
        -------
        ndarray (m, K)

        Notes
        -----
        By parts; what remains is smooth in the root of the time from the passage of the edge, within or
        beyond the step.
        """
        radius, begin, end = radius[:, None], begin[:, None], end[:, None]
        ends = np.concatenate((begin, end), axis=1)
        at_ends = fall(self.distance(radius, ends), ends)
        left_of_begin = np.exp(y * (end - begin)) - even
        change = (1.0 - even) * at_ends[:, 1:] - left_of_begin * at_ends[:, :1]
        remembered = y * float((begin - end).max(initial=0.0)) <= _FORGOTTEN
        forgets = ~remembered
        if remembered.any():
            change[:, remembered] -= self._lagging(fall, radius, y[remembered], begin, end)
        if forgets.any():
            first = np.minimum(begin, end + _FORGOTTEN / y[forgets])
            change[:, forgets] -= self._lagging(fall, radius, y[forgets], first, end)
        return change

    def _lagging(
        self, fall: Callable[[Array, Array], Array], radius: Array, y: Array, begin: Array, end: Array
    ) -> Array:
        """``int S(|r - a(t)|, t) d exp(-(t_end - t)/theta)`` (m, K) between two shares still to come.

        ``radius`` and ``end`` are (m, 1). ``begin`` is (m, K), or (m, 1) if it is the same for all branches:
        ``S`` is then read once for all of them, and that is what costs.
        """
        passage = self.left(radius)
        before = passage >= 0.5 * (begin + end)  # the passage lies before, not after
        away = np.where(before, -1.0, 1.0)
        nearest = np.where(before, np.minimum(begin, passage), np.maximum(end, passage))
        near = np.sqrt(away * (nearest - passage))
        length = float(y.max())
        points, weights = next(rule for longest, rule in _RULES.items() if length <= longest)
        # from the nearest share, not from the passage: an edge that hardly moves passes 1e16 steps away
        ways = np.maximum(away * (np.where(before, end, begin) - nearest), 0.0)
        reach = ways / np.maximum(near + np.sqrt(near**2 + ways), SMALLEST)
        beyond = reach[..., None] * points
        z = near[..., None] + beyond
        left = nearest[..., None] + away[..., None] * beyond * (near[..., None] + z)
        values = fall(self.distance(radius[..., None], left), left) * z
        memory = np.exp(y[:, None] * (end[..., None] - left))  # (m, K, points)
        return 2.0 * y * reach * ((values * memory) @ weights)
