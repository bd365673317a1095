"""Elastic adhesive sphere whose closure has a process zone of finite length.

The closure of Mandriota, Menga and Carbone, ``(1/(2 da)) int_(a-da)^a sigma(r) g(r + da) dr = dg``, on the
exact elastic field of a sphere held at ``a`` and ``D`` (:mod:`validation.reference.jkr`, any ``D``),
``T = a^2/R - D``:

    sigma(r) = (E*/pi) [T/sqrt(a^2 - r^2) - (2/R) sqrt(a^2 - r^2)],
    g(r) = (1/pi) [2 T arccos(a/r) + (1/R) ((r^2 - 2 a^2) arccos(a/r) + a sqrt(r^2 - a^2))].

As ``da -> 0`` it is JKR; at finite ``da`` it differs by terms of the order of ``da/a``. That difference is a
property of the model and stays at zero speed: comparisons with vanishing-zone formulas are made modulo it.
The root on which the closure integral rises with ``a`` is the stable one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from scipy.special import roots_jacobi

from contact_scene import Sphere
from validation.reference.jkr import JKR, ElasticContact, largest_radius

_NODES, _WEIGHTS = roots_jacobi(24, 0.5, -0.5)  # weight (1 - x)^(1/2) (1 + x)^(-1/2)


@dataclass(frozen=True)
class FiniteZone:
    """Elastic sphere of ``radius``; ``plane_modulus``, ``work`` and ``zone`` as everywhere."""

    radius: float
    plane_modulus: float
    work: float
    zone: float

    def closure(self, contact_radius: float, penetration: float) -> float:
        """The closure integral for any ``a > zone`` and ``D``.

        Gauss-Jacobi carries both square roots: with ``r = a - da z``, ``sigma`` is smooth over ``sqrt(z)``
        and ``g(r + da)`` smooth times ``sqrt(1 - z)``.
        """
        a, d = contact_radius, self.zone
        z = 0.5 * (1.0 + _NODES)
        stretch = a**2 / self.radius - penetration
        inner = a - d * z
        outer = inner + d
        chord = np.sqrt((a - inner) * (a + inner))
        stress = self.plane_modulus / np.pi * (stretch / chord - 2.0 / self.radius * chord)
        rise = np.sqrt((outer - a) * (outer + a))
        angle = np.arctan2(rise, a)
        bulge = (outer**2 - 2.0 * a**2) * angle + a * rise
        gap = (2.0 * stretch * angle + bulge / self.radius) / np.pi
        smooth = stress * np.sqrt(z) * gap / np.sqrt(1.0 - z)
        return float(0.25 * np.sum(_WEIGHTS * smooth))

    def stretch(self, contact_radius: float) -> float:
        """``T = a^2/R - D > 0`` at equilibrium."""
        rest = contact_radius**2 / self.radius
        guess = np.sqrt(2.0 * np.pi * contact_radius * self.work / self.plane_modulus)

        def excess(stretch: float) -> float:
            return self.closure(contact_radius, rest - stretch) - self.work

        high = guess
        while excess(high) < 0.0:
            high *= 2.0
        return float(brentq(excess, 0.0, high, xtol=1e-300, rtol=1e-14))

    def state(self, contact_radius: float) -> ElasticContact:
        """Equilibrium at a given contact radius, stable or not."""
        a = contact_radius
        penetration = a**2 / self.radius - self.stretch(a)
        force = 2.0 * self.plane_modulus * (a * penetration - a**3 / (3.0 * self.radius))
        return ElasticContact(a, penetration, force)

    def energy_release_rate(self, contact_radius: float) -> float:
        """``K^2/(2 E*)`` at equilibrium; over ``dg``, the elastic bias of the finite zone."""
        stretch = self.stretch(contact_radius)
        return self.plane_modulus * stretch**2 / (2.0 * np.pi * contact_radius)

    def at_penetration(self, penetration: float) -> ElasticContact:
        """The stable state at a given penetration.

        Raises
        ------
        NoEquilibrium
            If the penetration is below the least possible.
        """
        low = self.pull_off_penetration_control().contact_radius
        return self.state(largest_radius(lambda a: self.state(a).penetration, penetration, low))

    def pull_off_force_control(self) -> ElasticContact:
        """The state of largest tension."""
        return self._least(lambda a: self.state(a).force, self._vanishing.pull_off_force_control())

    def pull_off_penetration_control(self) -> ElasticContact:
        """The state of least penetration."""
        return self._least(
            lambda a: self.state(a).penetration, self._vanishing.pull_off_penetration_control()
        )

    def shrinks_to_its_zone(self) -> bool:
        """Whether a contact that is withdrawn is stable until it is no longer than its process zone."""
        shortest = 1.001 * self.zone
        return self.state(shortest).penetration < self.state(1.001 * shortest).penetration

    @property
    def _vanishing(self) -> JKR:
        return JKR(Sphere(self.radius), self.plane_modulus, self.work)

    def _least(self, curve: Callable[[float], float], near: ElasticContact) -> ElasticContact:
        low = max(0.25 * near.contact_radius, 1.001 * self.zone)
        bounds = (low, max(4.0 * near.contact_radius, 4.0 * low))
        least = minimize_scalar(curve, bounds=bounds, method="bounded", options={"xatol": 1e-12 * bounds[1]})
        return self.state(float(least.x))
