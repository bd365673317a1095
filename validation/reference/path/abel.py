"""Abel transform of the indenter: ``G(x) = x int_0^x f'(r)/sqrt(x^2 - r^2) dr`` (Sneddon), and its integral.

In contact ``w(x) = D - G(x)``. Power laws (sphere, cone, flat punch included) in closed form,

    f = c r^n:   G = c n (sqrt(pi)/2) Gamma(n/2)/Gamma((n+1)/2) x^n,

tabulated profiles too, because their slope is a parabola between table points:
``int r^m/sqrt(x^2-r^2) dr`` and ``int r^m sqrt(x^2-r^2) dr`` are elementary for m = 0, 1, 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from contact_scene import Cone, FlatPunch, Indenter, PowerLaw, Sphere, TabulatedProfile

Array = NDArray[np.float64]


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


@dataclass(frozen=True)
class PiecewiseTransform:
    """Transform of a slope ``c0 + c1 r + c2 r^2``, whose coefficients change at each of the knots.

    ``knots`` has shape (m,) and rises from 0, ``changes`` (3, m). Both transforms are sums over the knots
    within ``x`` of what a change from there on contributes.
    """

    knots: Array
    changes: Array

    def __call__(self, x: Array) -> Array:
        at = np.asarray(x, float)
        safe = np.where(at > 0.0, at, 1.0)
        within = int(np.searchsorted(self.knots, safe.max(initial=0.0)))
        knots, (c0, c1, c2) = self.knots[:within], self.changes[:, :within]
        r = np.minimum(knots, safe[..., None])
        angle, root = self._beyond(r, safe[..., None])
        total = angle @ c0 + root @ (c1 + 0.5 * c2 * knots) + 0.5 * safe**2 * (angle @ c2)
        return np.where(at > 0.0, at * total, 0.0)

    def integral(self, x: float) -> float:
        if x <= 0.0:
            return 0.0
        r = np.minimum(self.knots, x)
        angle, root = self._beyond(r, x)
        c0, c1, c2 = self.changes
        total = 0.5 * c0 @ (x * x * angle - r * root) + c1 @ root**3 / 3.0
        return float(total + 0.125 * c2 @ (x**4 * angle - r * (2.0 * r * r - x * x) * root))

    @staticmethod
    def _beyond(r: Array, x: Array | float) -> tuple[Array, Array]:
        """Integrals of ``1/sqrt(x^2 - r^2)`` and of r times it from ``r`` to ``x``."""
        return np.arccos(r / x), np.sqrt((x - r) * (x + r))


def transform(indenter: Indenter) -> Transform:
    """Transform of any indenter a scene can hold."""
    match indenter:
        case Sphere():
            return PowerTransform(1.0 / indenter.radius, 2.0)
        case Cone():
            return PowerTransform(0.5 * math.pi * indenter.cotangent, 1.0)
        case FlatPunch():
            return PowerTransform(0.0, 1.0)
        case PowerLaw():
            n = indenter.exponent
            gammas = math.exp(math.lgamma(0.5 * n) - math.lgamma(0.5 * (n + 1.0)))
            return PowerTransform(indenter.coefficient * n * 0.5 * math.sqrt(math.pi) * gammas, n)
        case TabulatedProfile():
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
    beyond = np.array([[float(indenter.slope(right[-1]))], [0.0], [0.0]])
    before = np.hstack((np.zeros((3, 1)), parabola))
    return PiecewiseTransform(np.array(indenter.radii), np.hstack((parabola, beyond)) - before)
