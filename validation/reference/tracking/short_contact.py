"""The closure integral of a contact hardly longer than its process zone, down to one as short as it.

There ``K(x, y)`` is singular where ``x`` and ``b = y - da`` both come to the axis. Two substitutions make the
integrand smooth: the outer variable is ``t = sqrt(x)``, and for each ``x`` the kernel is a polynomial in
``b/x``, whose coefficients meet moments of ``d`` summed up from the innermost point:

    int_b0^a [ (pi/2) d(b + da) q(b)/sqrt(b (b + da)) + q(b) int_b0^b d(b' + da) (dK/dx)(b, b') db' ] db.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from validation.reference.tracking.hermite import each_once

Array = NDArray[np.float64]
Field = Callable[[Array], Array]

_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(4)
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT
_PANELS = 12
"""Even panels of ``sqrt(x)`` where nodes are few."""
_HALVINGS = 15
"""Panels halved towards the axis, down to 1e-9 of the contact radius."""
_DEGREE = 10
"""Coefficients of the kernel in ``b/x``: analytic up to ``b/x = -1``, so that ten leave an error of 1e-8."""
_KNOTS = 0.5 * (1.0 - np.cos(np.pi * (np.arange(_DEGREE) + 0.5) / _DEGREE))
_TO_POWERS = np.linalg.inv(np.vander(_KNOTS, increasing=True))
_RING = np.cos(np.pi * (np.arange(8) + 0.5) / 8)


def short_contact_integral(
    behind: Field, ahead: Field, inside: Array, outside: Array, radius: float, zone: float
) -> tuple[float, float, float]:
    """``int_a^{a+da} d(y) [ q(y-da) K(y-da, y) + int_{y-da}^a q(x) dK/dx dx ] dy``, and ``int q``, ``int d``.

    Parameters
    ----------
    behind, ahead : callable
        ``q(x)`` in contact and ``d(y)`` ahead of the edge, for arrays of any shape.
    inside, outside : ndarray, shape (m,) and (l,)
        Nodes of the two fields, between which they are smooth.
    radius : float
        Contact radius, one to ``LONGEST`` zones.
    zone : float
        Process-zone length.

    Returns
    -------
    tuple of float
        The double integral, and the integrals of ``q`` and ``d`` over one zone.
    """
    left, h = _panels(inside, outside, radius, zone)
    t = left[:, None] + h[:, None] * _GAUSS  # (m, g)
    x = t * t
    step = 2.0 * h[:, None] * _WEIGHT  # dx/sqrt(x)
    opening, stress = ahead(x + zone), behind(x)
    main = 0.5 * np.pi * float((step * opening * stress / np.sqrt(x + zone)).sum())
    orders = np.arange(_DEGREE)[:, None, None]
    panel = (step * t * opening * (x / radius) ** orders).sum(axis=2)
    before = panel.cumsum(axis=1) - panel
    inner = left[:, None, None] + (h[:, None] * _GAUSS)[:, :, None] * _GAUSS  # from the panel's start to t
    weight = 2.0 * inner * (h[:, None] * _GAUSS)[:, :, None] * _WEIGHT * ahead(inner**2 + zone)
    own = np.array([(weight * (inner**2 / radius) ** order).sum(axis=2) for order in range(_DEGREE)])
    moments = (before[:, :, None] + own) * (radius / x) ** orders
    coefficients = _kernel_coefficients(x.ravel(), zone).reshape(moments.shape)
    total = main + float((step * t * stress * (coefficients * moments).sum(axis=0)).sum())
    return total, float((step * t * stress).sum()), float((step * t * opening).sum())


def _panels(inside: Array, outside: Array, radius: float, zone: float) -> tuple[Array, Array]:
    """Left ends and widths of panels in ``sqrt(x)``, halved towards the axis."""
    start = max(radius - zone, 0.0)
    first, last = np.sqrt(start), np.sqrt(radius)
    even = np.linspace(first, last, _PANELS + 1)
    geometric = last * 0.5 ** np.arange(1, _HALVINGS)
    nodes = np.concatenate((inside, outside - zone))
    nodes = np.sqrt(nodes[(nodes > start) & (nodes < radius)])
    breaks = each_once(even, geometric[geometric > first], nodes)
    return breaks[:-1], np.diff(breaks)


def _kernel_coefficients(x: Array, zone: float) -> Array:
    """``dK/dx`` at the points ``x`` (n,) as coefficients of powers of ``b/x``; shape (degree, n)."""
    angle = np.arccos(np.minimum(2.0 * x / (LONGEST * zone) - 1.0, 1.0))
    series = np.cos(_ORDERS[:, None] * angle)
    return np.asarray(_TABLE.T @ series / np.sqrt(x**3 * zone))


def _scaled_kernel_slope(x: Array) -> Array:
    """``x^(3/2) dK/dx`` for a zone of one at the points ``x`` (n,) and ``b = x knot``; shape (n, degree)."""
    x, b = x[:, None, None], x[:, None, None] * _KNOTS[:, None]
    middle, half = 0.5 * (1.0 + _KNOTS[:, None]), 0.5 * (1.0 - _KNOTS[:, None])
    first = 1.0 + middle + half * _RING  # (x + r)/x
    second = x * (middle + half * _RING) + b + 2.0
    r_x = 0.5 * (1.0 + _RING)
    values = -0.5 * ((1.0 + r_x) / first + x * r_x / second) / np.sqrt(first * second)
    return np.asarray(np.pi * values.mean(axis=2))


LONGEST = 2.5
"""Largest contact radius, in zones, for which the kernel is tabulated: a Chebyshev series over ``x``."""
_ORDERS = np.arange(24)
_SAMPLES = np.pi * (_ORDERS + 0.5) / len(_ORDERS)
_TABLE = _scaled_kernel_slope(0.5 * LONGEST * (np.cos(_SAMPLES) + 1.0)) @ _TO_POWERS.T
_TABLE = (2.0 - (_ORDERS[:, None] == 0)) / len(_ORDERS) * np.cos(np.outer(_ORDERS, _SAMPLES)) @ _TABLE
