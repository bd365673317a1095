"""Closure at the contact edge (paper, Eq. closure).

``I = (1/(2 da)) int_0^da sigma(a - s) g(a + da - s) ds = dgamma``: the tension at distance s inside the edge meets
the gap at distance da - s outside it. With ``s = da sin^2(psi)`` the square-root ends become smooth.
I > dgamma recedes, I < dgamma advances; the stable edge is where I rises through dgamma with a.
A compressive edge (kappa > 0) also has sigma g > 0, with both signs wrong: it counts negative.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_POINTS = 12
_nodes, _weights = np.polynomial.legendre.leggauss(_POINTS)
_psi = 0.25 * np.pi * (_nodes + 1.0)
#: distances from the edge in units of the zone, and the weights that go with them
DISTANCES: Array = np.sin(_psi) ** 2
WEIGHTS: Array = 0.25 * np.pi * _weights * 2.0 * np.sin(_psi) * np.cos(_psi)


def inner_distances(zone: float, edge: float) -> Array:
    """Distances s inside the edge at which tension is wanted; the zone is cut at the centre."""
    return min(zone, edge) * DISTANCES


def closure_integral(tension: Array, gap: Array, zone: float, edge: float) -> float:
    """``I`` from tension at ``a - s`` and gap at ``a + zone - s`` for the s of :func:`inner_distances`."""
    length = min(zone, edge)
    return float(length * (WEIGHTS @ (tension * gap)) / (2.0 * zone))
