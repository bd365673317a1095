"""Sneddon (1965): any axisymmetric indenter ``f(r)`` on an elastic half-space, without adhesion.

I.N. Sneddon, Int. J. Engng Sci. 3, 47: the contact follows from one transform of the profile,

    G(x) = x int_0^x f'(r)/sqrt(x^2 - r^2) dr = x int_0^(pi/2) f'(x sin b) db,
    H(a) = int_0^a G(x) dx = int_0^a f'(r) sqrt(a^2 - r^2) dr.

A punch held at contact radius ``a`` and penetration ``D`` carries ``q(x) = E* (D - G(x))`` for ``x < a`` and
the force ``F = 2 int_0^a q dx = 2 E* (a D - H(a))``; without adhesion ``q(a) = 0``, so ``D = G(a)``.
For ``f = c r^n``: ``G = c k_n x^n`` with ``k_n = (sqrt(pi)/2) n Gamma(n/2)/Gamma((n+1)/2)``:
sphere ``x^2/R``, cone ``(pi/2) x cot(alpha)``. Signs: ``D``, ``F``, pressure positive when pressed in.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Cone, FlatPunch, Indenter, PowerLaw, Sphere, TabulatedProfile

Array = NDArray[np.float64]
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


def power_law(indenter: Indenter) -> tuple[float, float] | None:
    """``(n, c)`` of ``f = c r^n`` for sphere, cone and power law; ``None`` for any other shape."""
    if isinstance(indenter, Sphere):
        return 2.0, 0.5 / indenter.radius
    if isinstance(indenter, Cone):
        return 1.0, indenter.cotangent
    if isinstance(indenter, PowerLaw):
        return indenter.exponent, indenter.coefficient
    return None


def shape_factor(exponent: float) -> float:
    """``k_n = (sqrt(pi)/2) n Gamma(n/2)/Gamma((n+1)/2)``."""
    gammas = math.gamma(0.5 * exponent) / math.gamma(0.5 * (exponent + 1.0))
    return 0.5 * math.sqrt(math.pi) * exponent * gammas


def depth(indenter: Indenter, x: ArrayLike) -> Array:
    """``G(x)``, the penetration at which an adhesionless contact has radius ``x``; same shape as ``x``.

    Infinite where a power law is beyond floating point; so are :func:`depth_integral` and :func:`force`.
    """
    x = np.asarray(x, float)
    if (law := power_law(indenter)) is not None:
        with np.errstate(over="ignore"):
            return np.asarray(law[1] * shape_factor(law[0]) * x ** law[0])
    if isinstance(indenter, FlatPunch):
        return np.zeros_like(x)
    return np.vectorize(lambda at: at * _angular(indenter, at, 0), otypes=[float])(x)


def depth_integral(indenter: Indenter, contact_radius: ArrayLike) -> Array:
    """``H(a) = int_0^a G(x) dx``; same shape as ``contact_radius``."""
    a = np.asarray(contact_radius, float)
    if (law := power_law(indenter)) is not None:
        with np.errstate(over="ignore"):
            return np.asarray(a * depth(indenter, a) / (law[0] + 1.0))
    if isinstance(indenter, FlatPunch):
        return np.zeros_like(a)
    return np.vectorize(lambda at: at**2 * _angular(indenter, at, 2), otypes=[float])(a)


def _angular(indenter: Indenter, x: float, power: int) -> float:
    """``int_0^(pi/2) f'(x sin b) cos(b)^power db``, Gauss-Legendre between the knots of a table."""
    knots = indenter.radii if isinstance(indenter, TabulatedProfile) else ()
    ends = np.arcsin([0.0, *(r / x for r in knots if 0.0 < r < x), 1.0])
    half = 0.5 * np.diff(ends)[:, None]
    angle = ends[:-1, None] + half * (1.0 + _NODES)
    values = indenter.slope(x * np.sin(angle)) * np.cos(angle) ** power
    return float(np.sum(half * _WEIGHTS * values))


def contact_radius(indenter: Indenter, penetration: float) -> float:
    """The ``a`` with ``G(a) = D`` for ``penetration >= 0`` (a flat punch is always in full contact)."""
    if penetration < 0.0:
        raise ValueError(f"no adhesionless contact at penetration {penetration:g}")
    if (law := power_law(indenter)) is not None:
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
    """``F/E* = 2 (a D - H(a))`` for any contact radius and penetration, adhesive or not.

    Parameters
    ----------
    indenter : Indenter
    contact_radius, penetration : array_like

    Returns
    -------
    ndarray
        Area, of the broadcast shape of the two.
    """
    a = np.asarray(contact_radius, float)
    return 2.0 * (a * np.asarray(penetration, float) - depth_integral(indenter, a))


def force(indenter: Indenter, contact_radius: ArrayLike, plane_modulus: float) -> Array:
    """``F(a) = 2 E* (a G(a) - H(a))``, the adhesionless force: ``2 E* n H(a)`` for a power ``n``.

    Parameters
    ----------
    indenter : Indenter
    contact_radius : array_like
    plane_modulus : float
        ``E* = E/(1 - nu^2)``.

    Returns
    -------
    ndarray
        Force, of the shape of ``contact_radius``.
    """
    if (law := power_law(indenter)) is not None:
        with np.errstate(over="ignore"):
            return np.asarray(2.0 * plane_modulus * law[0] * depth_integral(indenter, contact_radius))
    return plane_modulus * unit_force(indenter, contact_radius, depth(indenter, contact_radius))


def stored_energy(
    indenter: Indenter, contact_radius: float, penetration: float, plane_modulus: float
) -> float:
    """``U = E* int_0^a (D - G(x))^2 dx`` at any contact radius and penetration.

    ``dU/dD = F`` and ``dU/da = E* (D - G(a))^2 = q(a)^2/E*``.

    Parameters
    ----------
    indenter : Indenter
    contact_radius : float
    penetration : float
    plane_modulus : float
        ``E* = E/(1 - nu^2)``.

    Returns
    -------
    float
        Energy.
    """
    ends = np.linspace(0.0, contact_radius, 9)
    if isinstance(indenter, TabulatedProfile):
        ends = np.unique([0.0, *(r for r in indenter.radii if r < contact_radius), contact_radius])
    half = 0.5 * np.diff(ends)[:, None]
    x = ends[:-1, None] + half * (1.0 + _NODES)
    return float(plane_modulus * np.sum(half * _WEIGHTS * (penetration - depth(indenter, x)) ** 2))


def pressure(indenter: Indenter, r: ArrayLike, contact_radius: float, plane_modulus: float) -> Array:
    """Adhesionless pressure under sphere, cone or power law, zero outside; same shape as ``r``.

    ``p = (E*/pi) int_r^a G'(x)/sqrt(x^2 - r^2) dx
    = (E* n c k_n/pi) a^(n-2) b 2F1(1, 1 - n/2; 3/2; b^2/a^2)``, ``b^2 = a^2 - r^2``;
    for the cone ``(E*/2) cot(alpha) arcosh(a/r)``, infinite at the tip.

    Parameters
    ----------
    indenter : Indenter
    r : ndarray
        Radius of the points.
    contact_radius : float
    plane_modulus : float
        ``E* = E/(1 - nu^2)``.

    Returns
    -------
    ndarray
        Pressure, of the shape of ``r``.
    """
    from scipy.special import hyp2f1

    law = power_law(indenter)
    if law is None:
        raise ValueError(f"no closed form for the pressure under a {indenter.shape}")
    n, c = law
    b = np.sqrt(np.maximum(1.0 - (np.asarray(r, float) / contact_radius) ** 2, 0.0))
    scale = plane_modulus * n * c * shape_factor(n) * contact_radius ** (n - 1.0) / np.pi
    return scale * b * hyp2f1(1.0, 1.0 - 0.5 * n, 1.5, b**2)
