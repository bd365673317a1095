"""The closure integral, a form between ``q`` behind the edge and ``d`` ahead of it.

With ``x = a - da + s`` behind and ``y = a + s`` ahead, ``0 < s < da``, ``d(y) = w(y) - (D - G(y))`` and
``K(x, y) = int_{y-da}^x dr/sqrt((x^2-r^2)((r+da)^2-y^2))`` the closure (paper, Eq. closure) is, by parts
over x,

    I = -1/(pi^2 da) int_0^da d(s) [ (pi/2) q(s)/sqrt(x y) + int_s^da q(s') dK/dx(s', s) ds' ] ds.

The first term is ``K(y-da, y) = pi/(2 sqrt(y (y-da)))``; the second, of order ``da/a``, has a kernel that
is smooth in the logarithms of the distances of ``x`` and ``y - da`` from the axis. So it is a series of
Chebyshev in both, to 1e-10 with six terms and four more for each factor e that the zone reaches towards the
axis, and the inner integral is a running sum of moments of ``q``. The points are those of Gauss in panels
between breaks: the ends of the zone, graded towards both, and where the table of passages has edges.

The length of a zone of fixed cohesive stress follows from the tension behind the edge. Over the zone that is
of the sharp edge, ``sigma = (1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx``. Integrated over ``r`` from
``b = a - da`` to ``a``, and by parts over ``x = b/cos(t)``, which lies ``da - 2 b sin(t/2)^2/cos(t)`` behind
the edge,

    int_b^a sigma dr = -(1/pi) int_0^arccos(b/a) q(b/cos t) dt = (4/pi) s da.

``q`` behind the edge does not depend on the zone: the length is one root for every end of a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.numerics import (
    NEGLIGIBLE,
    ROUNDING,
    bracketed,
    chebyshev,
    chebyshev_series,
    gauss,
    powers,
)

Array = NDArray[np.float64]

POINTS, WEIGHTS = gauss(5)
COUNT = len(POINTS)
# integral from a point to the end of its panel of each Lagrange polynomial, and over all of the panel
_REST = ((1.0 - POINTS[:, None] ** np.arange(1, COUNT + 1)) / np.arange(1, COUNT + 1)) @ np.linalg.inv(
    powers(POINTS, COUNT - 1)
)
_RUNNING = np.vstack((_REST, WEIGHTS)).T
_GRADED = 2e-3 * 4.0 ** np.arange(4)
"""Breaks near the ends of a zone: a layer that relaxes behind a slow edge is an exponential of any thickness,
which five points follow to 1e-6 over a ratio of 4 (of 10: 1e-4)."""
BASE = np.unique(np.concatenate(([0.0, 0.5, 1.0], _GRADED, 1.0 - _GRADED)))
WIDENING = 3.0
"""Ratio of the distances of breaks from the axis."""
TERMS, TERMS_A_FACTOR = 6, 4.0
"""Terms of the series of the kernel."""
_RING = chebyshev_series(12)[0]

EVEN = np.linspace(0.0, 1.0, 5)
SHORTEST = 1e-3
"""Shortest zone that is followed, in zones at rest: the edge pulls a thirtieth as much."""
LONGEST = 1.0 - NEGLIGIBLE
"""Longest, in contact radii: it fills the contact."""


def points(breaks: Array) -> tuple[Array, Array]:
    """Points and weights of Gauss between breaks."""
    width = (breaks[1:] - breaks[:-1])[:, None]
    return (breaks[:-1, None] + width * POINTS).ravel(), (width * WEIGHTS).ravel()


@dataclass(frozen=True)
class Closure:
    """The closure at a radius.

    ``s``, ``weight`` (m,): points and weights from the inner end of the zone. ``moments`` (l, m): polynomials
    of their places; ``within``: times the widths of their panels, over x. ``kernel`` (l, l): its series.
    """

    zone: float
    s: Array
    weight: Array
    main: Array
    moments: Array
    within: Array
    kernel: Array

    def between(self, q: Array, d: Array) -> float:
        """``I`` of stresses and openings (m,); negative where they are those of pressing next to the edge.

        There the form is not positive, so that it does not jump where an edge ceases to be pressed.
        """
        order = len(self.kernel)
        parts = (self.within * q).reshape(-1, COUNT) @ _RUNNING
        parts = parts.reshape(order, -1, COUNT + 1)
        totals = parts[:, :, COUNT]
        later = totals[:, ::-1].cumsum(axis=1)[:, ::-1] - totals
        after = (parts[:, :, :COUNT] + later[:, :, None]).reshape(order, -1)
        inner = (self.moments * (self.kernel @ after)).sum(axis=0)
        value = float((self.weight * d) @ (self.main * q + inner)) * (-1.0 / (math.pi**2 * self.zone))
        return -abs(value) if q[-1] > 0.0 and d[0] < 0.0 else value


def closure(radius: float, zone: float, breaks: Array) -> Closure:
    """The closure at a radius, by Gauss in panels between breaks, no wider than they are off the axis."""
    start = max(radius - zone, NEGLIGIBLE * radius)
    levels = np.arange(1, int(math.log(radius / start) / math.log(WIDENING)) + 1)
    graded = start * (WIDENING**levels - 1.0)
    breaks = np.union1d(breaks, graded[graded < zone]) if len(levels) else breaks
    s, weight = points(breaks)
    x, y = max(radius - zone, 0.0) + s, radius + s
    width = (breaks[1:] - breaks[:-1]).repeat(COUNT)
    main = 0.5 * math.pi / np.sqrt(x * y)
    place = np.log1p((s - s[0]) / x[0])
    reach = float(place[-1])
    order = TERMS + int(TERMS_A_FACTOR * reach)
    moments = chebyshev(2.0 * place / reach - 1.0, order)
    return Closure(
        zone, s, weight, main, moments, moments * (width / x), kernel_slope(x[0], reach, zone, order)
    )


def kernel_slope(start: float, reach: float, zone: float, order: int) -> Array:
    """``x dK/dx`` as a series (order, order) in the places of ``y - zone`` and ``x``."""
    knots, series = chebyshev_series(order)
    at = start * np.exp(0.5 * reach * (1.0 + knots))
    return np.asarray(series @ (at * kernel_slopes(at, at[:, None], zone)) @ series.T)


def kernel_slopes(x: Array, behind: Array, zone: float | Array) -> Array:
    """``dK/dx`` at pairs of ``x`` and ``y = behind + zone``."""
    x, behind = x[..., None], behind[..., None]
    r = 0.5 * (x + behind) + 0.5 * (x - behind) * _RING
    slope = 0.5 * (1.0 + _RING)
    first, second = x + r, r + behind + 2.0 * zone
    return np.asarray(
        math.pi * (-0.5 * ((1.0 + slope) / first + slope / second) / np.sqrt(first * second)).mean(-1)
    )


def zone_length(
    stress: Callable[[Array], Array],
    edges: Array,
    radius: float,
    cohesive: float,
    at_rest: float,
    guess: float,
) -> float:
    """The length; ``stress``: ``q`` at distances from the edge, ``edges``: those where it may have kinks."""

    def lack(root: float) -> float:
        """Nearly straight in the root of the length: next to the edge the tension goes like ``K/sqrt(x)``."""
        zone = root * root
        widest = 2.0 * math.asin(math.sqrt(0.5 * zone / radius))
        near = edges[(edges > -zone) & (edges < 0.0)]
        angles = 2.0 * np.arcsin(np.sqrt(0.5 * (zone + near) / (radius + near)))
        angle, weight = points(np.unique(np.concatenate((widest * EVEN, angles))))
        behind = 2.0 * (radius - zone) * np.sin(0.5 * angle) ** 2 / np.cos(angle) - zone
        tension = -float(weight @ stress(np.minimum(behind, 0.0)))
        return (tension - 4.0 * cohesive * zone) / root

    low, high = math.sqrt(min(SHORTEST * at_rest, 0.5 * radius)), math.sqrt(LONGEST * radius)
    x = math.sqrt(guess)
    f = lack(x)
    if not math.isfinite(f):
        return math.nan
    after = x * (1.0 + 1e-4)
    for _ in range(8):
        if not low < after < high:
            break
        value = lack(after)
        if value == f:
            break
        step = value * (after - x) / (value - f)
        x, f, after = after, value, after - step
        if abs(step) < ROUNDING * x:
            return x * x
    if lack(low) <= 0.0:
        return low * low
    if lack(high) >= 0.0:
        return LONGEST * radius
    return bracketed(lack, low, high) ** 2
