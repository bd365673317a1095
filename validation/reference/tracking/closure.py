"""The closure integral (paper, Eq. closure) in Abel space, free of singular integrands.

With ``x`` behind and ``y`` ahead of the edge ``a``, ``d(y) = w(y) - (D - G(y))``,
``K(x, y) = int_{y-da}^x dr/sqrt((x^2-r^2)((r+da)^2-y^2))``, integrated by parts over ``x``:

    2 da I = -(2/pi^2) int_a^{a+da} d(y) [ q(y-da) K(y-da, y) + int_{y-da}^a q(x) dK/dx dx ] dy.

``K(y-da, y) = pi/(2 sqrt(y (y-da)))`` exactly; the inner integral is a correction of order ``da/a`` whose
kernel is smooth, so it is expanded in powers of ``(x - a + da)/da`` from Gauss-Chebyshev values.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.closure import NEAR_AXIS, kernel_slope
from validation.reference.sneddon import Transform
from validation.reference.tracking import hermite
from validation.reference.tracking.short_contact import short_contact_integral

Array = NDArray[np.float64]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(2)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT  # two points of equal weight
_POWERS = np.vander(_GAUSS, increasing=True)
# _REST[j, l]: integral from Gauss point j to the end of the panel of the l-th Lagrange polynomial
_REST = ((1.0 - _GAUSS[:, None] ** np.arange(1, 3)) / np.arange(1, 3)) @ np.linalg.inv(_POWERS)
_REST_SHARES = _REST / _WEIGHT

_LATTICE = np.linspace(0.0, 1.0, 11)  # panels where nodes are few
_DEGREE = 6


@dataclass(frozen=True)
class EdgeFields:
    """Fields near the edge, known at nodes.

    ``inside`` (m,) rises to the edge and carries ``memory = sum_k b_k``; ``outside`` (l,) rises from the edge
    and carries the free ``w``. A few nodes beyond the zone are needed for the slopes.
    """

    inside: Array
    memory: Array
    outside: Array
    strain: Array
    penetration: float


def closure_integral(edge: EdgeFields, zone: float, relaxed: float, transform: Transform) -> float:
    """``I(a)`` (paper, Eq. closure), the energy per area that opening by one zone length would release.

    Parameters
    ----------
    edge : EdgeFields
        Fields within one zone length of the edge and a few nodes beyond.
    zone : float
        Process-zone length.
    relaxed : float
        Relaxed plane modulus ``E0*``.
    transform : Transform
        Abel transform of the indenter.

    Returns
    -------
    float
        Energy per area; negative where the edge is under compression or overlaps ahead: the contact grows.
    """
    radius = float(edge.inside[-1])
    start = radius - zone
    x, memory, y, strain = edge.inside, edge.memory, edge.outside, edge.strain
    memory_slopes, strain_slopes = hermite.slopes(x, memory), hermite.slopes(y, strain)

    def stress(at: Array) -> Array:
        rubber = relaxed * (edge.penetration - transform(at))
        return hermite.evaluate(x, memory, memory_slopes, at) + rubber

    def opening(at: Array) -> Array:
        return hermite.evaluate(y, strain, strain_slopes, at) - edge.penetration + transform(at)

    if zone > NEAR_AXIS * radius:
        return _signed(*short_contact_integral(stress, opening, x, y, radius, zone), zone)
    breaks = np.concatenate(
        (
            zone * _LATTICE,
            x[x.searchsorted(start, side="right") : -1] - start,
            y[: y.searchsorted(radius + zone)] - radius,
        )
    )
    breaks.sort()
    width = breaks[1:] - breaks[:-1]
    s = breaks[:-1] + width * _GAUSS[:, None]  # (2, m): Gauss points, panels
    weight = width * _WEIGHT[:, None]
    behind, ahead = start + s, radius + s
    q, d = stress(behind), opening(ahead)
    weighted, loads = weight * d, weight * q
    main = 0.5 * np.pi * float(np.vdot(weighted, q / np.sqrt(ahead * behind)))

    powers = np.empty((_DEGREE, *s.shape))
    powers[0], powers[1:] = 1.0, s / zone
    np.multiply.accumulate(powers, axis=0, out=powers)
    moments = loads * powers
    before = (moments[:, 0] + moments[:, 1]).cumsum(axis=1)
    inner = _REST_SHARES @ moments
    inner += (before[:, -1:] - before)[:, None]
    pairs = inner.reshape(_DEGREE, -1) @ (weighted * powers).reshape(_DEGREE, -1).T
    total = main + float(np.vdot(kernel_slope(start, zone), pairs))
    return _signed(total, float(before[0, -1]), float(weighted.sum()), zone)


def _signed(total: float, load: float, openings: float, zone: float) -> float:
    """``I`` from its double integral; negative where the zone is pressed and would overlap ahead.

    ``load``, ``openings``: integrals of ``q`` behind and of ``d`` ahead of the edge over one zone.
    """
    value = -total / (np.pi**2 * zone)
    return -abs(value) if load > 0.0 and openings < 0.0 else value
