"""Elastic layer of finite thickness on a rigid base, under any axisymmetric indenter, adhesive or not.

Ya.S. Ufliand and N.N. Lebedev, PMM 22, 320 (1958): under the Abel transform a layer of thickness ``h`` is a
Fredholm equation of the second kind. With Sneddon's ``G`` (:mod:`validation.reference.sneddon`) and
``q = E* phi`` the transform of the pressure, ``F = 2 int_0^a q dx``,

    phi(x) - int_0^a M(x, s) phi(s) ds = D - G(x),                                              x < a,
    M(x, s) = (2/(pi h)) int_0^inf (1 - K(t)) cos(t x/h) cos(t s/h) dt,

``K`` the surface compliance in Hankel space over that of the half-space; bonded, with ``k = 3 - 4 nu``,

    K = (k sinh 2t - 2t)/(k cosh 2t + 2 t^2 + 5 - 12 nu + 8 nu^2),

and on a frictionless base ``K = (cosh 2t - 1)/(sinh 2t + 2t)``, whatever ``nu``. ``M`` is smooth: the edge is
that of the half-space, ``K_I = -q(a)/sqrt(pi a)``, and JKR's equilibrium ``phi(a) = -sqrt(2 pi a dg/E*)``.

Solved at Gauss points (Nystroem) for ``phi = D one - profile``, the responses to 1 and to ``G``.
``F > 0`` presses, ``D > 0`` downwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Indenter, Layer
from validation.reference import sneddon
from validation.reference.jkr import JKR, ElasticContact

Array = NDArray[np.float64]
LARGEST_WAVE = 22.0
"""``1 - K`` is of the order of ``t^2 exp(-2t)``: 1e-16 from here on."""
_gauss = lru_cache(maxsize=256)(np.polynomial.legendre.leggauss)


def _waves(panels: int) -> tuple[Array, Array]:
    """Points and weights for integrals over ``t``, by panels: weights of long rules have lost digits."""
    z, w = _gauss(16)
    half = 0.5 * LARGEST_WAVE / panels
    points = half * (2.0 * np.arange(panels)[:, None] + 1.0 + z)
    return points.ravel(), np.tile(half * w, panels)


def transfer(t: ArrayLike, poisson: float, base: str) -> Array:
    """``K``, surface compliance at the wave number ``t/h`` over that of the half-space; shape of ``t``."""
    t = np.asarray(t, float)
    e = np.exp(-2.0 * t)  # of numerator and denominator cosh 2t is taken out
    if base == "frictionless":
        return (1.0 - e) ** 2 / (1.0 - e * e + 4.0 * t * e)
    k, rest = 3.0 - 4.0 * poisson, 5.0 - 12.0 * poisson + 8.0 * poisson**2
    return (k * (1.0 - e * e) - 4.0 * t * e) / (k * (1.0 + e * e) + 2.0 * e * (2.0 * t * t + rest))


def moment(order: int, poisson: float, base: str) -> float:
    """``m_n = int_0^inf t^n (1 - K(t)) dt``: how much a layer is stiffer while it is thick."""
    t, weight = _waves(10)
    return float(weight @ (t**order * (1.0 - transfer(t, poisson, base))))


@dataclass(frozen=True)
class Response:
    """Of a contact of one radius, by unit plane modulus: force and edge value of ``phi``.

    For unit penetration, and for the profile as displacement.
    """

    radius: float
    stiffness: float
    edge: float
    profile_force: float
    profile_edge: float

    def penetration(self, stretch: float = 0.0) -> float:
        """``D`` at which the edge value is ``phi(a) = -stretch``; 0 without adhesion."""
        return (self.profile_edge - stretch) / self.edge

    def force(self, penetration: float) -> float:
        """``F/E*`` at any penetration."""
        return self.stiffness * penetration - self.profile_force


@dataclass(frozen=True)
class ElasticLayer:
    """Elastic contact on a layer, by unit plane modulus ``E* = E/(1 - nu^2)``."""

    layer: Layer
    poisson: float
    indenter: Indenter

    def solution(self, contact_radius: float, places: ArrayLike) -> tuple[Array, Array, Array]:
        """Weights (n,) of the integral over x, ``phi`` (n, 2) there and at more ``places`` (m, 2).

        ``phi`` is that of unit penetration, and of the profile as displacement.
        """
        a, thickness = contact_radius, self.layer.thickness
        ratio = a / thickness
        z, w = _gauss(24 + math.ceil(5.0 * ratio))
        wave, weight = _waves(10 + math.ceil(2.0 * ratio))
        x, w, count = np.append(0.5 * a * (z + 1.0), places), 0.5 * a * w, len(z)
        stiffening = 2.0 / (np.pi * thickness) * weight
        stiffening *= 1.0 - transfer(wave, self.poisson, self.layer.base)
        waves = np.cos(wave / thickness * x[:, None])
        kernel = (waves * stiffening) @ waves[:count].T * w
        given = np.stack((np.ones(len(x)), sneddon.depth(self.indenter, x)), 1)
        phi = np.linalg.solve(np.eye(count) - kernel[:count], given[:count])
        return w, phi, given[count:] + kernel[count:] @ phi

    def response(self, contact_radius: float) -> Response:
        """At a contact radius; for a smooth profile to 1e-11, relative, up to 30 thicknesses."""
        w, phi, (edge,) = self.solution(contact_radius, contact_radius)
        force = 2.0 * w @ phi
        return Response(
            contact_radius, *(float(one) for pair in zip(force, edge, strict=True) for one in pair)
        )

    def state(self, contact_radius: float, work: float = 0.0) -> ElasticContact:
        """JKR equilibrium, stable or not, with the force over ``E*``; ``work`` is ``dg/E*``, 0: pressed."""
        found = self.response(contact_radius)
        depth = found.penetration(math.sqrt(2.0 * math.pi * contact_radius * work))
        return ElasticContact(contact_radius, depth, found.force(depth))

    def pull_off(self, work: float, of: Literal["force", "penetration"]) -> ElasticContact:
        """The state where the force, or the penetration, is least: pull-off by a dead load, or a rigid grip.

        Raises
        ------
        UnsupportedScene
            For a flat punch and a tabulated profile.
        SceneError
            If that contact is too large for the layer.
        """
        from scipy.optimize import minimize_scalar  # a run on a half-space loads none of it

        free = JKR(self.indenter, 1.0, work).pull_off_force_control().contact_radius

        def value(radius: float) -> float:
            return float(getattr(self.state(radius, work), of))

        within, radius = 0.0, 1e-3 * min(free, self.layer.thickness)
        while value(wider := 1.2 * radius) < value(radius):  # from a point of contact on it falls, then rises
            within, radius = radius, wider
            if radius > self.layer.largest_contact:
                raise self.layer.outgrown
        found = minimize_scalar(
            value, bounds=(within, wider), method="bounded", options={"xatol": 1e-9 * free}
        )
        return self.state(float(found.x), work)

    def radius_at(self, penetration: float) -> float:
        """Contact radius without adhesion at a penetration > 0; that of a flat punch is its own."""
        from scipy.optimize import brentq

        start = sneddon.contact_radius(self.indenter, penetration)  # of the half-space, which is smaller
        if start == self.indenter.edge:  # a flat punch
            return start
        high = start
        while (found := self.state(high)).penetration < penetration:
            high *= 1.5
        if high == start:
            return found.contact_radius
        return float(
            brentq(lambda a: self.state(a).penetration - penetration, start, high, xtol=1e-15 * high)
        )


def force_ratio(chi: ArrayLike, poisson: float, base: str) -> Array:
    """Force of a sphere over Hertz's at one penetration to fourth order in ``chi = sqrt(R D)/h``.

    By iteration of the equation above, ``M`` expanded in powers of ``1/h``; ``x = 2 m0/pi``, ``y = m2/pi``:
    ``1 + x chi + (7/6) x^2 chi^2 + [(40/27) x^3 - (8/15) y] chi^3 + [(143/72) x^4 - (8/5) x y] chi^4``.
    """
    x, m2 = 2.0 / np.pi * moment(0, poisson, base), moment(2, poisson, base) / np.pi
    cubic, quartic = 40.0 / 27.0 * x**3 - 8.0 / 15.0 * m2, 143.0 / 72.0 * x**4 - 8.0 / 5.0 * x * m2
    return np.polynomial.polynomial.polyval(
        np.asarray(chi, float), (1.0, x, 7.0 / 6.0 * x * x, cubic, quartic)
    )
