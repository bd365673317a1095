"""Sneddon (1965): any axisymmetric indenter ``f(r)`` on an elastic half-space, without adhesion.

I.N. Sneddon, Int. J. Engng Sci. 3, 47: the contact follows from the Abel transform of the profile,

    G(x) = x int_0^x f'(r)/sqrt(x^2 - r^2) dr,
    H(a) = int_0^a G(x) dx = int_0^a f'(r) sqrt(a^2 - r^2) dr.

A punch held at contact radius ``a`` and penetration ``D`` carries ``q(x) = E* (D - G(x))`` for ``x < a`` and
the force ``F = 2 int_0^a q dx = 2 E* (a D - H(a))``; without adhesion ``q(a) = 0``, so ``D = G(a)``.
For ``f = c r^n``: ``G = c k_n x^n`` with ``k_n = (sqrt(pi)/2) n Gamma(n/2)/Gamma((n+1)/2)``: sphere
``x^2/R``, cone ``(pi/2) x cot(alpha)``, flat punch 0. Between the points of a table the slope is a parabola,
for which both integrals are elementary. Signs: ``D``, ``F``, pressure positive when pressed in.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import FlatPunch, Indenter, Sphere, TabulatedProfile

Array = NDArray[np.float64]
FAR = 3.0
"""Radius, in the last of a table, from which on eight points of Gauss between rows err by rounding alone."""
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_POINTS, _WEIGHTS = 0.5 * (_POINTS + 1.0), 0.5 * _WEIGHTS


def shape_factor(exponent: float) -> float:
    """``k_n = (sqrt(pi)/2) n Gamma(n/2)/Gamma((n+1)/2)``."""
    gammas = math.gamma(0.5 * exponent) / math.gamma(0.5 * (exponent + 1.0))
    return 0.5 * math.sqrt(math.pi) * exponent * gammas


class Transform(Protocol):
    """``G`` for arrays of any shape, its integral from 0, and the radii (m,) at which it has kinks."""

    @property
    def knots(self) -> Array:
        """Where the profile has kinks."""
        ...

    def __call__(self, x: Array) -> Array:
        """``G(x)``."""
        ...

    def integral(self, x: float) -> float:
        """``int_0^x G = int_0^x f'(r) sqrt(x^2 - r^2) dr``."""
        ...

    def squared(self, x: float) -> float:
        """``int_0^x G^2``."""
        ...


@dataclass(frozen=True)
class PowerTransform:
    """``G = coefficient x^exponent``."""

    coefficient: float
    exponent: float
    knots: ClassVar[Array] = np.zeros(0)

    def __call__(self, x: Array) -> Array:
        if self.exponent == 2.0:
            return self.coefficient * x * x
        return self.coefficient * x**self.exponent

    def integral(self, x: float) -> float:
        return self.coefficient * x ** (self.exponent + 1.0) / (self.exponent + 1.0)

    def squared(self, x: float) -> float:
        g = self.coefficient * x**self.exponent
        return g * g * x / (2.0 * self.exponent + 1.0)


@dataclass(frozen=True)
class PiecewiseTransform:
    """Transform of a slope ``c0 + c1 r + c2 r^2``, whose coefficients change at each of the knots.

    ``knots`` has shape (m,) and rises from 0, ``changes`` (3, m). Both transforms are sums over the knots
    within ``x`` of what a change from there on contributes. Seen from far these cancel: there they are sums
    over ``points`` between the knots, and the last of these, of the ``rises`` of the profile.
    """

    knots: Array
    changes: Array
    points: Array
    rises: Array
    last: float

    def __call__(self, x: Array) -> Array:
        at = np.asarray(x, float)
        far = at > FAR * self.knots[-1]
        near = np.where((at > 0.0) & ~far, at, self.knots[1])
        within = int(np.searchsorted(self.knots, near.max(initial=0.0)))
        knots, (c0, c1, c2) = self.knots[:within], self.changes[:, :within]
        r = np.minimum(knots, near[..., None])
        angle, root = self._beyond(r, near[..., None])
        total = angle @ c0 + root @ (c1 + 0.5 * c2 * knots) + 0.5 * near**2 * (angle @ c2)
        if far.any():
            angle, root = self._beyond(self.points, np.where(far, at, np.inf)[..., None])
            total = np.where(far, (1.0 / root) @ self.rises + self.last * angle[..., -1], total)
        return np.where(at > 0.0, at * total, 0.0)

    def integral(self, x: float) -> float:
        if x <= 0.0:
            return 0.0
        if x > FAR * self.knots[-1]:
            angle, root = self._beyond(self.points, x)
            beyond = x * x * angle[-1] - self.points[-1] * root[-1]
            return float(root @ self.rises + 0.5 * self.last * beyond)
        r = np.minimum(self.knots, x)
        angle, root = self._beyond(r, x)
        c0, c1, c2 = self.changes
        total = 0.5 * c0 @ (x * x * angle - r * root) + c1 @ root**3 / 3.0
        return float(total + 0.125 * c2 @ (x**4 * angle - r * (2.0 * r * r - x * x) * root))

    def squared(self, x: float) -> float:
        if x <= 0.0:
            return 0.0
        last = int(np.searchsorted(self.knots, x)) - 1
        return float(self._squared_at_knots[last] + self._squared_between(self.knots[last], np.array(x)))

    @cached_property
    def _squared_at_knots(self) -> Array:
        return np.append(0.0, self._squared_between(self.knots[:-1], self.knots[1:]).cumsum())

    def _squared_between(self, low: Array, high: Array) -> Array:
        """By Gauss: ``G`` is smooth between knots."""
        width = high - low
        return width * (self(low[..., None] + width[..., None] * _POINTS) ** 2 @ _WEIGHTS)

    @staticmethod
    def _beyond(r: Array, x: Array | float) -> tuple[Array, Array]:
        """Integrals of ``1/sqrt(x^2 - r^2)`` and of r times it from ``r`` to ``x``."""
        return np.arccos(r / x), np.sqrt((x - r) * (x + r))


@lru_cache(maxsize=64)
def transform(indenter: Indenter) -> Transform:
    """``G`` of any indenter a scene can hold."""
    if isinstance(indenter, Sphere):  # exactly
        return PowerTransform(1.0 / indenter.radius, 2.0)
    if (law := indenter.power) is not None:
        return PowerTransform(law[1] * shape_factor(law[0]), law[0])
    if isinstance(indenter, FlatPunch):
        return PowerTransform(0.0, 1.0)
    if isinstance(indenter, TabulatedProfile):
        return _tabulated(indenter)
    raise TypeError(f"no transform for {type(indenter).__name__}")


def _tabulated(indenter: TabulatedProfile) -> PiecewiseTransform:
    """The slope is a parabola between table points: read it off at both ends and in the middle."""
    left = np.array(indenter.radii[:-1])
    right = np.array(indenter.radii[1:])
    first, last = indenter.slope(left), indenter.slope(right)
    middle = indenter.slope(0.5 * (left + right))
    h = right - left
    c2 = 2.0 * (first - 2.0 * middle + last) / h**2
    c1 = (last - first) / h
    parabola = np.array(
        [first - c1 * left + c2 * left * right, c1 - c2 * (left + right), c2]
    )  # Newton's form about left and right, in powers of r
    end = float(last[-1])
    before = np.hstack((np.zeros((3, 1)), parabola))
    changes = np.column_stack((parabola, (end, 0.0, 0.0))) - before
    points = left[:, None] + h[:, None] * _POINTS
    rises = h[:, None] * _WEIGHTS * indenter.slope(points)
    return PiecewiseTransform(
        np.array(indenter.radii), changes, np.append(points, right[-1]), np.append(rises, 0.0), end
    )


def depth(indenter: Indenter, x: ArrayLike) -> Array:
    """``G(x)``, the penetration at which an adhesionless contact has radius ``x``; same shape as ``x``.

    Infinite where a power law is beyond floating point; so are :func:`depth_integral` and :func:`force`.
    """
    with np.errstate(over="ignore"):
        return np.asarray(transform(indenter)(np.asarray(x, float)))


def depth_integral(indenter: Indenter, contact_radius: ArrayLike) -> Array:
    """``H(a) = int_0^a G(x) dx``; same shape as ``contact_radius``."""
    if (law := indenter.power) is not None:
        with np.errstate(over="ignore"):
            return np.asarray(
                np.asarray(contact_radius, float) * depth(indenter, contact_radius) / (law[0] + 1.0)
            )
    return np.vectorize(transform(indenter).integral, otypes=[float])(contact_radius)


def contact_radius(indenter: Indenter, penetration: float) -> float:
    """The ``a`` with ``G(a) = D`` for ``penetration >= 0`` (a flat punch is always in full contact)."""
    if penetration < 0.0:
        raise ValueError(f"no adhesionless contact at penetration {penetration:g}")
    if (law := indenter.power) is not None:
        return float((penetration / (law[1] * shape_factor(law[0]))) ** (1.0 / law[0]))
    if isinstance(indenter, FlatPunch):
        return indenter.radius
    return radius_at(lambda a: float(depth(indenter, a)), penetration)


def radius_at(rising: Callable[[float], float], target: float) -> float:
    """The radius at which a quantity that rises from 0 at the centre reaches ``target >= 0``."""
    from scipy.optimize import brentq

    high = 1.0
    while rising(high) < target:
        high *= 2.0
    return float(brentq(lambda a: rising(a) - target, 0.0, high, xtol=1e-300, rtol=1e-14))


def unit_force(indenter: Indenter, contact_radius: ArrayLike, penetration: ArrayLike) -> Array:
    """``F/E* = 2 (a D - H(a))``, an area, for any contact radius and penetration, adhesive or not."""
    a = np.asarray(contact_radius, float)
    return 2.0 * (a * np.asarray(penetration, float) - depth_integral(indenter, a))


def force(indenter: Indenter, contact_radius: ArrayLike, plane_modulus: float) -> Array:
    """``F(a) = 2 E* (a G(a) - H(a))``, the adhesionless force: ``2 E* n H(a)`` for a power ``n``."""
    if (law := indenter.power) is not None:
        with np.errstate(over="ignore"):
            return np.asarray(2.0 * plane_modulus * law[0] * depth_integral(indenter, contact_radius))
    return plane_modulus * unit_force(indenter, contact_radius, depth(indenter, contact_radius))


def stored_energy(
    indenter: Indenter, contact_radius: float, penetration: float, plane_modulus: float
) -> float:
    """``U = E* int_0^a (D - G(x))^2 dx`` at any contact radius and penetration.

    ``dU/dD = F`` and ``dU/da = E* (D - G(a))^2 = q(a)^2/E*``.
    """
    g = transform(indenter)
    strained = penetration * (penetration * contact_radius - 2.0 * g.integral(contact_radius))
    return plane_modulus * (strained + g.squared(contact_radius))


def pressure(indenter: Indenter, r: ArrayLike, contact_radius: float, plane_modulus: float) -> Array:
    """Adhesionless pressure under sphere, cone or power law, zero outside; same shape as ``r``.

    ``p = (E*/pi) int_r^a G'(x)/sqrt(x^2 - r^2) dx
    = (E* n c k_n/pi) a^(n-2) b 2F1(1, 1 - n/2; 3/2; b^2/a^2)``, ``b^2 = a^2 - r^2``;
    for the cone ``(E*/2) cot(alpha) arcosh(a/r)``, infinite at the tip.
    """
    from scipy.special import hyp2f1

    law = indenter.power
    if law is None:
        raise ValueError(f"no closed form for the pressure under a {indenter.shape}")
    n, c = law
    b = np.sqrt(np.maximum(1.0 - (np.asarray(r, float) / contact_radius) ** 2, 0.0))
    scale = plane_modulus * n * c * shape_factor(n) * contact_radius ** (n - 1.0) / np.pi
    return scale * b * hyp2f1(1.0, 1.0 - 0.5 * n, 1.5, b**2)
