"""Closure at the contact edge (paper, Eq. closure).

``I = (1/(2 da)) int_0^da sigma(a - s) g(a + da - s) ds = dgamma``: the tension at distance s inside the
edge meets the gap at distance da - s outside it. With ``s = da sin^2(psi)`` the square-root ends become
smooth. I > dgamma recedes, I < dgamma advances; the stable edge is where I rises through dgamma with a. A
compressive edge (kappa > 0) also has sigma g > 0, with both signs wrong: it counts negative.

The rule must resolve what the history can hold. Too few points see short waves of the stress behind an
advancing edge as long ones, and feed them: the edge then moves in jerks.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ClosureRule:
    """Quadrature over the process zone: ``distance`` (q,) inside the edge in zones, and ``weight`` (q,)."""

    distance: Array
    weight: Array

    @classmethod
    def resolving(cls, divisions: int) -> ClosureRule:
        """A rule for a history held at ``divisions`` per zone."""
        nodes, weights = np.polynomial.legendre.leggauss(2 * divisions + 8)
        psi = 0.25 * np.pi * (nodes + 1.0)
        return cls(np.sin(psi) ** 2, 0.25 * np.pi * weights * np.sin(2.0 * psi))

    def inside(self, zone: float, edge: float) -> Array:
        """Distances s inside the edge at which tension is wanted; the zone is cut at the centre."""
        return min(zone, edge) * self.distance

    def integral(self, tension: Array, gap: Array, zone: float, edge: float) -> float:
        """``I`` (Eq. closure), energy per area.

        Parameters
        ----------
        tension, gap : ndarray (q,)
            At ``a - s`` and at ``a + zone - s`` for the s of :meth:`inside`.
        zone, edge : float

        Returns
        -------
        float
        """
        return float(min(zone, edge) * (self.weight @ (tension * gap)) / (2.0 * zone))
