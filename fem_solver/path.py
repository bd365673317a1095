"""Path of the contact edge over one step, and the moments at which it passes the nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Row = tuple[float, float]
"""Time from an earlier row to the begin of the step, and the contact radius at that row."""

_ITERATIONS = 60
"""Most iterations for the moment at which the edge is at a radius: halvings alone would take as many."""
_MOMENT_TOLERANCE = 1e-14
"""Accuracy of that moment, relative to the step."""


@dataclass(frozen=True)
class EdgePolynomial:
    """A cubic in time through the last three rows and the trial row; of lower order where rows are missing.

    ``a = start + travel p(theta)`` with the share ``theta`` of the step and
    ``p = theta + bend theta (theta - 1) + twist theta (theta - 1) (theta + earlier)``: Newton's form. It is
    bent and twisted no further than it is monotonic. The speed at the end of the step is that of the backward
    differentiation formula of the same order.

    Parameters
    ----------
    start, travel : float
        Contact radius at the begin of the step and its change.
    bend : float
        Between -1 and 1.
    twist : float
    earlier : float
        Length of the step before, relative to this one.
    """

    start: float
    travel: float
    bend: float = 0.0
    twist: float = 0.0
    earlier: float = 1.0

    @classmethod
    def through(cls, start: float, end: float, dt: float, before: tuple[Row, ...]) -> EdgePolynomial:
        """The path from ``start`` to ``end``."""
        travel = end - start
        if not before or travel == 0.0:
            return cls(start, travel)
        length, radius = before[0]
        slope = (start - radius) / length
        curvature = (travel / dt - slope) / (dt + length)
        bend = float(np.clip(curvature * dt**2 / travel, -1.0, 1.0))
        if len(before) < 2:
            return cls(start, travel, bend)
        age, oldest = before[1]
        curvature_before = (slope - (radius - oldest) / (age - length)) / age
        third = (curvature - curvature_before) / (dt + age)
        earlier = length / dt
        # Bernstein coefficients of the slope are positive: 1 - bend - earlier twist, 1 - twist and
        # 1 + bend + (1 + earlier) twist
        least, most = -(1.0 + bend) / (1.0 + earlier), min((1.0 - bend) / earlier, 1.0)
        twist = float(np.clip(third * dt**3 / travel, least, most))
        return cls(start, travel, bend, twist, earlier)

    @property
    def opens(self) -> bool:
        """Whether the edge recedes, or rests."""
        return self.travel <= 0.0

    def passed(self, radii: Array) -> Array:
        """Share of the step at which the edge is at each radius: 0 or 1 if it is there before or later."""
        if self.travel == 0.0:
            return np.where(radii <= self.start, 1.0, 0.0)
        way = np.clip((radii - self.start) / self.travel, 0.0, 1.0)
        slope = 1.0 - self.bend
        root = slope + np.sqrt(np.maximum(slope**2 + 4.0 * self.bend * way, 0.0))
        share = np.divide(2.0 * way, root, out=np.zeros_like(way), where=root > 0.0)
        share = np.clip(share, 0.0, 1.0)
        if self.twist != 0.0:
            share = self._improved(share, way)
        return np.where(way >= 1.0, 1.0, np.where(way <= 0.0, 0.0, share))  # to the last bit

    def _improved(self, share: Array, way: Array) -> Array:
        """Roots of the cubic, from those of the parabola: Newton's method within brackets that shrink."""
        low, high = np.zeros_like(way), np.ones_like(way)
        # p in powers of the share
        cubic, square = self.twist, self.bend + self.twist * (self.earlier - 1.0)
        line = 1.0 - self.bend - self.twist * self.earlier
        for _ in range(_ITERATIONS):
            excess = share * (line + share * (square + share * cubic)) - way
            rate = line + share * (2.0 * square + share * (3.0 * cubic))
            low, high = np.where(excess <= 0.0, share, low), np.where(excess >= 0.0, share, high)
            ahead = share - np.divide(excess, rate, out=np.zeros_like(rate), where=rate > 0.0)
            inside = (ahead >= low) & (ahead <= high) & (rate > 0.0)
            ahead = np.where(inside, ahead, 0.5 * (low + high))
            moved, share = np.abs(ahead - share).max(initial=0.0), ahead
            if moved < _MOMENT_TOLERANCE:
                break
        return share


def missed_by_extrapolation(start: float, end: float, dt: float, before: tuple[Row, ...]) -> float:
    """Distance by which the end of a step misses the parabola through the three rows before it."""
    if len(before) < 2:
        return 0.0
    (length, radius), (age, oldest) = before[:2]
    slope = (start - radius) / length
    curvature = (slope - (radius - oldest) / (age - length)) / age
    return abs(end - start - dt * (slope + (dt + length) * curvature))
