"""Path of the contact edge over one step, and the moments at which it passes the nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EdgeParabola:
    """A parabola in time through the last two rows and the trial row; a line where there is one row only.

    ``a = start + travel (theta + bend theta (theta - 1))`` with the share ``theta`` of the step. The parabola
    is bent no further than it is monotonic.

    Parameters
    ----------
    start, travel : float
        Contact radius at the begin of the step and its change.
    bend : float
        Between -1 and 1.
    """

    start: float
    travel: float
    bend: float = 0.0

    @classmethod
    def through(cls, start: float, end: float, dt: float, before: tuple[float, float] | None) -> EdgeParabola:
        """The path from ``start`` to ``end``.

        Parameters
        ----------
        start, end : float
            Contact radii.
        dt : float
            Length of the step.
        before : tuple of float, optional
            Length of the step before and the contact radius at its begin.

        Returns
        -------
        EdgeParabola
        """
        travel = end - start
        if before is None or travel == 0.0:
            return cls(start, travel)
        length, earlier = before
        curvature = (travel / dt - (start - earlier) / length) / (dt + length)
        return cls(start, travel, float(np.clip(curvature * dt**2 / travel, -1.0, 1.0)))

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
        return np.clip(share, 0.0, 1.0)
