"""Path of the edge in a step that passes over process zones, and what its square root does on the way.

What the closure sees at the end of such a step was left behind within it, at times that follow from the path,
and the condition there is one on the speed of the edge. The path is the parabola through the edge at the
last two rows and at the end of the step: with rows of equal spacing its speed there is the second-order
backward differentiation formula. Times count from the end of the step backwards, because what matters happens
just before it: ``g`` is the share of the step still to come.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
_FORGOTTEN = 36.0
"""Time, in retardation times, after which nothing is left of a lag: ``exp(-36)`` is rounding."""


@dataclass(frozen=True)
class EarlierRow:
    """The row before the last: its time before the last, its penetration, and its edge.

    ``fall`` is that of the load outside the last. Both are None where the edge keeps to a straight line, and
    only the penetration is a parabola.
    """

    time: float
    penetration: float
    edge: float | None = None
    fall: OuterFall | None = None


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
    """``a(g) = end - travel g - bend g (1 - g)`` for a share ``g`` of the step still to come."""

    end: float
    travel: float
    bend: float

    @classmethod
    def straight(cls, edge: float, end: float) -> BentPath:
        """The path of constant speed."""
        return cls(end, end - edge, 0.0)

    @classmethod
    def through(cls, before: tuple[float, float], edge: float, duration: float, end: float) -> BentPath:
        """The parabola through an earlier row and both ends of a step.

        Parameters
        ----------
        before, edge, duration, end
            The four of :func:`parabola_bend`, its value being the edge.

        Returns
        -------
        BentPath
        """
        travel = end - edge
        limit = _LARGEST_BEND * abs(travel)
        return cls(end, travel, min(max(parabola_bend(before, edge, duration, end), -limit), limit))

    def edge(self, left: Array) -> Array:
        """Edge with a share of the step still to come."""
        return self.end - left * (self.travel + self.bend * (1.0 - left))

    def left(self, radius: Array) -> Array:
        """Share of the step still to come when the edge passes a radius; beyond [0, 1] continued.

        Where the parabola does not reach the radius, the share at which it comes nearest.
        """
        speed = self.travel + self.bend
        distance = self.end - radius
        root = np.sqrt(np.maximum(speed**2 - 4.0 * self.bend * distance, 0.0))
        return 2.0 * distance / (speed + np.copysign(root, speed))

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
        first = np.minimum(begin, end + _FORGOTTEN / y)  # (m, K)
        passage = self.left(radius)
        before = passage >= 0.5 * (begin + end)  # the passage lies before, not after
        away = np.where(before, -1.0, 1.0)
        near = np.sqrt(np.maximum(away * (np.where(before, first, end) - passage), 0.0))
        far = np.sqrt(np.maximum(away * (np.where(before, end, first) - passage), 0.0))
        points, weights = next(rule for longest, rule in _RULES.items() if y.max() <= longest)
        reach = far - near
        z = near[..., None] + reach[..., None] * points
        left = passage[..., None] + away[..., None] * z * z
        values = fall(self.distance(radius[..., None], left), left)
        values *= z * np.exp(y[:, None] * (end[..., None] - left))
        lagging = 2.0 * y * reach * (values @ weights)
        ends = np.concatenate((begin, end), axis=1)
        at_ends = fall(self.distance(radius, ends), ends)
        left_of_begin = np.exp(y * (end - begin)) - even
        return (1.0 - even) * at_ends[:, 1:] - left_of_begin * at_ends[:, :1] - lagging
