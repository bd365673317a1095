"""Johnson, Kendall and Roberts (1971) for any axisymmetric indenter.

K.L. Johnson, K. Kendall, A.D. Roberts, Proc. R. Soc. A 324, 301 (sphere); D. Maugis and M. Barquins,
J. Phys. D 11, 1989 (1978) (energy release rate) and J. Phys. Lett. 42, L95 (1981) (cone). With Sneddon's
``G`` and ``H`` (:mod:`validation.reference.sneddon`) and ``q(a) = E* (D - G(a))``:

    K = -q(a)/sqrt(pi a),   energy release rate K^2/(2 E*) = E* (D - G(a))^2/(2 pi a),
    equilibrium:  D = G(a) - S(a),  F = 2 E* (a D - H(a)),  S(a) = sqrt(2 pi a dg/E*).

For ``f = c r^n`` both stability limits are ``a G'(a) = m S(a)``, that is ``a^(n-1/2) = m s/(n c k_n)`` with
``s = sqrt(2 pi dg/E*)``: ``m = 3/2`` under force, ``m = 1/2`` under displacement control. ``F > 0`` presses,
``D > 0`` downwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Indenter, UnsupportedScene
from validation.reference import sneddon

Array = NDArray[np.float64]


class NoEquilibrium(ValueError):
    """No contact radius balances the work of adhesion at the load asked for."""


@dataclass(frozen=True)
class ElasticContact:
    """A contact: ``contact_radius``, ``penetration``, ``force``."""

    contact_radius: float
    penetration: float
    force: float


@dataclass(frozen=True)
class JKR:
    """Elastic contact with an adhesive edge of vanishing extent; ``work``: of adhesion, ``dg``."""

    indenter: Indenter
    plane_modulus: float
    work: float

    def penetration(self, contact_radius: ArrayLike) -> Array:
        """``D = G(a) - sqrt(2 pi a dg/E*)``."""
        a = np.asarray(contact_radius, float)
        return sneddon.depth(self.indenter, a) - np.sqrt(2.0 * np.pi * a * self.work / self.plane_modulus)

    def force(self, contact_radius: ArrayLike) -> Array:
        """``F = F_Hertz(a) - sqrt(8 pi a^3 E* dg)``."""
        a = np.asarray(contact_radius, float)
        pull = np.sqrt(8.0 * np.pi * a**3 * self.plane_modulus * self.work)
        return sneddon.force(self.indenter, a, self.plane_modulus) - pull

    def energy_release_rate(self, contact_radius: ArrayLike, penetration: ArrayLike) -> Array:
        """``E* (D - G(a))^2/(2 pi a)`` for any radius and penetration."""
        a = np.asarray(contact_radius, float)
        stretch = np.asarray(penetration, float) - sneddon.depth(self.indenter, a)
        return self.plane_modulus * stretch**2 / (2.0 * np.pi * a)

    def energy_release_rate_from_force(self, contact_radius: ArrayLike, force: ArrayLike) -> Array:
        """``(F_Hertz(a) - F)^2/(8 pi a^3 E*)`` for any radius and force."""
        a = np.asarray(contact_radius, float)
        lack = sneddon.force(self.indenter, a, self.plane_modulus) - np.asarray(force, float)
        return lack**2 / (8.0 * np.pi * a**3 * self.plane_modulus)

    def pressure(self, r: ArrayLike, contact_radius: float) -> Array:
        """Adhesionless pressure of the same ``a`` minus ``(E* S(a)/pi)/sqrt(a^2 - r^2)``; ``r < a``."""
        a, r = contact_radius, np.asarray(r, float)
        stretch = float(sneddon.depth(self.indenter, a) - self.penetration(a))
        singular = self.plane_modulus * stretch / (np.pi * np.sqrt(a**2 - r**2))
        return sneddon.pressure(self.indenter, r, a, self.plane_modulus) - singular

    def state(self, contact_radius: float) -> ElasticContact:
        """Equilibrium at a given contact radius, stable or not."""
        a = float(contact_radius)
        return ElasticContact(a, float(self.penetration(a)), float(self.force(a)))

    def pull_off_force_control(self) -> ElasticContact:
        """The state of largest tension: ``F = -2 E* s a^(3/2) (2n-1)/(2n+2)``; sphere ``-(3/2) pi R dg``."""
        return self.state(self._limit(1.5))

    def pull_off_penetration_control(self) -> ElasticContact:
        """The state of least penetration; sphere: ``F = -(5/6) pi R dg``."""
        return self.state(self._limit(0.5))

    def at_penetration(self, penetration: float) -> ElasticContact:
        """The stable state (largest radius) at a given penetration.

        Raises
        ------
        NoEquilibrium
            Beyond the pull-off of :meth:`pull_off_penetration_control`.
        """
        return self.state(largest_radius(self.penetration, penetration, self._limit(0.5)))

    def at_force(self, force: float) -> ElasticContact:
        """The state stable under a dead load (largest radius).

        Raises
        ------
        NoEquilibrium
            Beyond the pull-off of :meth:`pull_off_force_control`.
        """
        return self.state(largest_radius(self.force, force, self._limit(1.5)))

    def _limit(self, multiple: float) -> float:
        """``a`` with ``a G'(a) = multiple * S(a)``."""
        law = self.indenter.power
        if law is None:
            raise UnsupportedScene(
                "indenter.shape", f"no closed form for a {self.indenter.shape}", "sphere, cone or power-law"
            )
        n, c = law
        s = np.sqrt(2.0 * np.pi * self.work / self.plane_modulus)
        return float((multiple * s / (n * c * sneddon.shape_factor(n))) ** (1.0 / (n - 0.5)))


def largest_radius(curve: Callable[[float], Array | float], target: float, low: float) -> float:
    """Radius at which a curve of equilibria reaches its target, on the rising branch that starts at ``low``.

    Raises
    ------
    NoEquilibrium
        If the target is below the least possible.
    """
    from scipy.optimize import brentq

    least = float(curve(low))
    if target < least:
        raise NoEquilibrium(f"no equilibrium at {target:g}, the least possible is {least:g}")
    if target == least:
        return low
    high = max(2.0 * low, 1e-300)
    while curve(high) < target:
        high *= 2.0
    return float(brentq(lambda a: float(curve(a)) - target, low, high, xtol=1e-300, rtol=1e-15))
