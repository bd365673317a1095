"""The closure over the zone, of many scenes at once: quadrature, and the kernel as series."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.scenes import Bodies
from validation.reference.path.closure import kernel_slopes
from validation.reference.path.numerics import chebyshev, chebyshev_series, gauss

Array = NDArray[np.float64]

SHORTEST = 1.5
"""Process zones in the radius down to which the series of the kernel reaches."""
LAYERS = (4e-3, 3e-2, 0.2, 0.6)
"""Breaks of the quadrature, from the edge: a layer that recovers behind a slow edge is an exponential."""
NEAR = np.array([0.0, 4e-3, 3e-2, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0])
"""More breaks, where the place at which the load turned, a corner, may be anywhere in the zone."""
COUNT = 4
"""Points of Gauss between two breaks; the coarser of two resolutions has one less."""
POINTS, WEIGHTS = gauss(COUNT)
_BREAKS = 1.0 - np.array([1.0, *LAYERS[::-1], 0.0])
SWEPT = (_BREAKS[:-1, None] + np.diff(_BREAKS)[:, None] * POINTS).ravel()
SHARES = (np.diff(_BREAKS)[:, None] * WEIGHTS).ravel()
"""Points and weights of what a step sweeps, on [0, 1]: a layer relaxes behind an edge that closes."""
LAYERED = np.append(SWEPT[:-COUNT], 1.0 - LAYERS[0])
"""The same, but for the layer next to the end its beginning alone: values are straight over it."""
SERIES, PLACES, NODES = 12, 10, 6
"""Terms of the kernel in zone over radius, in the places in the zone, and of a stress behind the edge."""
NEGLIGIBLE = 1e-8
"""Relative error of a shorter series of the kernel, which is a part zone over radius of the closure."""
BEHIND = 0.5 * (1.0 + chebyshev_series(NODES)[0])
"""Shares of the zone at which the kernel asks for that."""


@lru_cache
def _kernel() -> Array:
    """Coefficients (r, p, q) of ``a^2 dK/dx`` in zone over radius, in place behind and place ahead."""
    knots, places = chebyshev_series(PLACES)
    share, zones = 0.5 * (1.0 + knots), 0.5 * (1.0 + chebyshev_series(SERIES)[0]) / SHORTEST
    x = 1.0 - zones[:, None] * (1.0 - share)
    slopes = kernel_slopes(x[:, None, :], x[:, :, None], zones[:, None, None, None])
    return np.einsum("sr,qj,pi,rji->spq", chebyshev_series(SERIES)[1], places, places, slopes)


def _inner(v: Array, closing: bool) -> Array:
    """What the kernel makes at shares (m,) of values at nodes: (m, NODES * SERIES).

    ``int_v^1 f(v') kernel(v', v) dv'`` of stresses behind or, where the edge closes, of openings ahead
    ``int_0^v kernel(v, v') f(v') dv'``: products of Chebyshev's polynomials are sums of two.
    """
    order = NODES + PLACES
    at = chebyshev(2.0 * v - 1.0, order + 1)
    signs = (-1.0 if closing else 1.0) ** np.arange(order + 1)[:, None]
    apart = at - signs if closing else signs - at
    rest = np.empty((order, len(v)))
    rest[0], rest[1] = apart[1], 0.25 * apart[2]
    for m in range(2, order):
        rest[m] = 0.5 * (apart[m + 1] / (m + 1) - apart[m - 1] / (m - 1))
    one, two = np.arange(NODES)[:, None], np.arange(PLACES)
    products = 0.25 * (rest[one + two] + rest[np.abs(one - two)])
    kernel = np.einsum("sqp,qm->spm" if closing else "spq,qm->spm", _kernel(), at[:PLACES])
    series = np.einsum("lpm,spm->lsm", products, kernel)
    nodes = np.einsum("ln,lsm->mns", chebyshev_series(NODES)[1], series)
    return np.ascontiguousarray(nodes.reshape(len(v), -1))


@dataclass(frozen=True)
class Quadrature:
    """Points of the zone, and what the closure needs at them.

    ``v``: shares from the inner end; points lie behind an edge that closes, else ahead. ``inner``
    (m, NODES * p) holds up to ``longest``, zone over radius.
    """

    v: Array
    weight: Array
    inner: Array
    closing: bool
    longest: float = 1.0 / SHORTEST

    def up_to(self, longest: float) -> Quadrature:
        """With as many terms as shorter zones need: the kernel is singular where zone and radius are one."""
        reach = 2.0 / longest - 1.0
        terms = math.ceil(-math.log(NEGLIGIBLE) / math.acosh(reach))
        if terms >= SERIES:
            return self
        knots, series = chebyshev_series(terms)
        at = chebyshev(SHORTEST * longest * (1.0 + knots) - 1.0, SERIES)
        inner = self.inner.reshape(-1, SERIES) @ at @ series.T
        return replace(self, inner=inner.reshape(len(self.v), -1), longest=longest)

    def forms(self, bodies: Bodies, radius: Array) -> tuple[Array, Array]:
        """What is made of ones and of ``G`` on the other side (2, m, B), and ``G`` at the points (m, B)."""
        zone = bodies.zone
        behind, ahead = radius - zone * (1.0 - self.v), radius + zone * self.v
        here, there = (behind, ahead) if self.closing else (ahead, behind)
        share = BEHIND[:, None] - (0.0 if self.closing else 1.0)
        series = self.series(bodies, radius)
        values = np.empty((NODES, len(series), 2, len(radius)))
        values[:, :, 0] = series
        np.multiply(bodies.shape(radius + zone * share)[:, None], series, out=values[:, :, 1])
        forms = (self.inner @ values.reshape(self.inner.shape[1], -1)).reshape(len(here), 2, -1)
        forms *= zone / (radius * radius)
        main = 0.5 * math.pi / np.sqrt(behind * ahead)
        forms[:, 0] += main
        forms[:, 1] += main * bodies.shape(there)
        forms *= self.weight[:, None]
        return np.ascontiguousarray(forms.swapaxes(0, 1)), bodies.shape(here)

    def series(self, bodies: Bodies, radius: Array) -> Array:
        """Polynomials (p, B) of zone over radius."""
        terms = self.inner.shape[1] // NODES
        return chebyshev(2.0 / self.longest * (bodies.zone / radius) - 1.0, terms)

    def stressed(self, bodies: Bodies, radius: Array, held: Array) -> Array:
        """The forms (n, m, B) of stresses (m, n, B) at ``BEHIND`` and the points."""
        zone, nodes = bodies.zone, held[:NODES]
        values = nodes[:, None] * self.series(bodies, radius)[:, None]
        inner = self.inner @ values.reshape(self.inner.shape[1], -1)
        inner = inner.reshape(len(self.v), *nodes.shape[1:]).transpose(1, 0, 2) * (zone / (radius * radius))
        main = 0.5 * math.pi / np.sqrt((radius - zone * (1.0 - self.v)) * (radius + zone * self.v))
        return np.asarray(self.weight * (main * held[NODES:].transpose(1, 0, 2) + inner))


@lru_cache(maxsize=4096)
def quadrature(corners: tuple[float, ...], closing: bool = False, count: int = COUNT) -> Quadrature:
    """By ``count`` points of Gauss between breaks from the edge, some of which are corners."""
    points, weights = gauss(count)
    breaks = np.unique((0.0, *LAYERS, *corners, 1.0))
    width = np.diff(breaks)[:, None]
    v = (breaks[:-1, None] + width * points).ravel()
    v = 1.0 - v if closing else v
    return Quadrature(v[:, None], (width * weights).ravel()[:, None], _inner(v, closing), closing)
