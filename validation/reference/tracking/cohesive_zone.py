"""Length of a process zone of fixed cohesive stress ``s``, from the tension behind the edge.

The pressure is ``p(r) = -(1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx``, with ``q = 0`` beyond the edge. The
tension ``sigma = -p`` integrated over ``r`` from ``b = a - da`` to ``a``, and by parts over ``x = b/cos(t)``,

    int_b^a sigma dr = -(1/pi) int_0^arccos(b/a) q(b/cos t) dt:

no singularity is left. The zone is as long as that is ``(4/pi) s da``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from validation.reference.sneddon import Transform
from validation.reference.tracking import hermite
from validation.reference.tracking.closure import EdgeFields

Array = NDArray[np.float64]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(4)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT
_EVEN = np.linspace(0.0, 1.0, 9)
"""Panels of the angle where nodes are few."""


def zone_at(edge: EdgeFields, stress: float, relaxed: float, transform: Transform, least: float) -> float:
    """Length of the zone.

    Parameters
    ----------
    edge : EdgeFields
        Fields over the whole contact, of which only those inside are used.
    stress : float
        Cohesive stress.
    relaxed : float
        Relaxed plane modulus ``E0*``.
    transform : Transform
        Abel transform of the indenter.
    least : float
        Length below which a zone is not followed: at an edge that hardly pulls, or is pressed.

    Returns
    -------
    float
        Between ``least`` and the contact radius.
    """
    from scipy.optimize import brentq

    radius = float(edge.inside[-1])
    slopes = hermite.slopes(edge.inside, edge.memory)

    def excess(zone: float) -> float:
        """Tension over a zone of that length beyond what it holds."""
        inner = radius - zone
        nodes = edge.inside[edge.inside > inner]
        widest = math.acos(inner / radius)
        angles = np.concatenate((widest * _EVEN, np.arccos(inner / nodes)))
        angles.sort()
        width = np.diff(angles)
        at = angles[:-1] + width * _GAUSS[:, None]
        x = np.minimum(inner / np.cos(at), radius)
        q = hermite.evaluate(edge.inside, edge.memory, slopes, x)
        q = q + relaxed * (edge.penetration - transform(x))
        tension = -float((_WEIGHT[:, None] * width * q).sum()) / math.pi
        return tension - 4.0 / math.pi * stress * zone

    if excess(least) <= 0.0:
        return least
    longest = radius * (1.0 - 1e-9)
    if excess(longest) >= 0.0:
        return radius

    def slope(root: float) -> float:
        """Nearly straight in the root of the length: next to the edge the tension goes like ``K/sqrt(x)``."""
        return excess(root * root) / root

    ends = math.sqrt(least), math.sqrt(longest)
    return float(brentq(slope, *ends, xtol=1e-15 * ends[1], rtol=1e-14)) ** 2
