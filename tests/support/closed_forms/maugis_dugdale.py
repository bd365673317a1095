"""Maugis (1992): sphere with a Dugdale (constant-stress) adhesive ring, between JKR and DMT.

D. Maugis, J. Colloid Interface Sci. 150, 243. Adhesive stress ``s0`` acts on ``a < r < c = m a``, out to the
gap ``dg/s0``. With ``K = 4 E*/3`` and Maugis's dimensionless load, radius, approach and parameter

    F' = F/(pi dg R),  a' = a/(pi dg R^2/K)^(1/3),  D' = D/(pi^2 dg^2 R/K^2)^(1/3),
    lambda = 2 s0/(pi dg K^2/R)^(1/3),

the contact obeys, with ``t = sqrt(m^2 - 1)``,

    (lambda a'^2/2) [t + (m^2 - 2) arctan t] + (4 lambda^2 a'/3) [t arctan t - m + 1] = 1,
    F' = a'^3 - lambda a'^2 [t + m^2 arctan t],      D' = a'^2 - (4/3) lambda a' t.

Below they are written in ``b' = a' t = sqrt(c'^2 - a'^2)``, regular at ``a = 0``. ``lambda -> inf`` is JKR,
``lambda -> 0`` DMT (``F = F_Hertz - 2 pi R dg``). ``F > 0`` presses, ``D > 0`` downwards.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq


@dataclass(frozen=True)
class MaugisDugdale:
    """Sphere of ``radius`` on a half-space of ``plane_modulus``; ``work`` and ``strength`` of adhesion."""

    radius: float
    plane_modulus: float
    work: float
    strength: float

    @property
    def transition(self) -> float:
        """Maugis's ``lambda`` (1.1570 times Tabor's parameter if ``s0`` is that of a Lennard-Jones law)."""
        stiffness = 4.0 * self.plane_modulus / 3.0
        return float(2.0 * self.strength / np.cbrt(np.pi * self.work * stiffness**2 / self.radius))

    @property
    def radius_unit(self) -> float:
        """``(pi dg R^2/K)^(1/3)``."""
        return float(np.cbrt(0.75 * np.pi * self.work * self.radius**2 / self.plane_modulus))

    @property
    def force_unit(self) -> float:
        """``pi dg R``."""
        return float(np.pi * self.work * self.radius)

    def ring_ratio(self, contact_radius: float) -> float:
        """``m = c/a`` for ``contact_radius > 0``."""
        a = contact_radius / self.radius_unit
        return float(np.hypot(1.0, self._ring(a) / a))

    def force(self, contact_radius: float) -> float:
        """``F`` at contact radius ``a >= 0``."""
        a = contact_radius / self.radius_unit
        b = self._ring(a)
        return self.force_unit * (a**3 - self.transition * (a * b + (a**2 + b**2) * np.arctan2(b, a)))

    def penetration(self, contact_radius: float) -> float:
        """``D`` at contact radius ``a >= 0``."""
        a = contact_radius / self.radius_unit
        unit = self.radius_unit**2 / self.radius
        return float(unit * (a**2 - 4.0 / 3.0 * self.transition * self._ring(a)))

    def _ring(self, a: float) -> float:
        """``b'`` at ``a'``: the condition that the gap at ``c`` is ``dg/s0``."""
        weight = self.transition

        def excess(b: float) -> float:
            angle = np.arctan2(b, a)
            ring = a * b + (b**2 - a**2) * angle
            edge = b * (angle - np.tan(0.5 * angle))  # t arctan t - m + 1 without cancellation
            return float(0.5 * weight * ring + 4.0 / 3.0 * weight**2 * edge - 1.0)

        high = 1.0
        while excess(high) < 0.0:
            high *= 2.0
        return float(brentq(excess, 0.0, high, xtol=1e-300, rtol=1e-14))
