r"""Process zone of fixed cohesive stress: elastic sphere, and the steady opening edge.

The zone ``da`` is the length over which the tension of the sharp edge has the mean ``(4/pi) s`` (see
:mod:`contact_scene.adhesion`).

**Elastic sphere** (:mod:`validation.reference.finite_zone`): with ``T = a^2/R - D``, ``b = a - da``,

    int_b^a sigma dr = (E*/pi) [T arccos(b/a) - (1/R) (a^2 arccos(b/a) - b sqrt(a^2 - b^2))].

**Steady opening** (:mod:`validation.reference.steady_crack`): tractions follow the moving elastic field, so
that ``da = (pi/8) (K/s)^2 = da_0 G/dg`` with the width at rest ``da_0 = pi E0* dg/(4 s^2)``, and the law at
fixed length holds at that length: ``G/dg = f(da_0 (G/dg)/v)``. R.A. Schapery (Int. J. Fracture 11, 141, 1975)
and B.N.J. Persson, E.A. Brener (Phys. Rev. E 71, 036123, 2005) close their laws in the same way:
:func:`support.closed_forms.schapery.fixed_stress_enhancement` and
:func:`support.closed_forms.persson_brener.blunting_enhancement`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from contact_scene import Material
from validation.reference import steady_crack
from validation.reference.finite_zone import FiniteZone

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FixedStressContact(FiniteZone):
    """Elastic sphere whose process zone has a fixed ``stress``; ``zone`` is the shortest that is followed."""

    stress: float

    def zone_at(self, contact_radius: float, penetration: float) -> float:
        """Length of the process zone at any contact radius and penetration; at most the radius."""
        a = contact_radius
        stretch = a**2 / self.radius - penetration

        def excess(zone: float) -> float:
            b = a - zone
            angle = math.acos(b / a)
            bulge = a**2 * angle - b * math.sqrt((a - b) * (a + b))
            tension = self.plane_modulus / math.pi * (stretch * angle - bulge / self.radius)
            return tension - 4.0 / math.pi * self.stress * zone

        if excess(self.zone) <= 0.0:
            return self.zone
        if excess(a) >= 0.0:
            return a
        return float(brentq(excess, self.zone, a, xtol=1e-300, rtol=1e-14))

    def closure(self, contact_radius: float, penetration: float) -> float:
        """The closure integral over the zone that belongs to ``a`` and ``D``."""
        zone = self.zone_at(contact_radius, penetration)
        fixed = FiniteZone(self.radius, self.plane_modulus, self.work, zone)
        return fixed.closure(contact_radius, penetration)


def closed_at_fixed_stress(
    enhancement: Callable[[Material, float, float], ArrayLike], material: Material, zone: float, speed: float
) -> float:
    """``G/dg = f(zone G/dg)`` of an opening edge whose zone grows with what it takes up."""
    highest = material.glassy_modulus / material.modulus
    if highest == 1.0:
        return 1.0
    return float(
        brentq(lambda g: g - float(np.asarray(enhancement(material, zone * g, speed))), 1.0, highest)
    )


def opening(material: Material, zone: float, speed: ArrayLike) -> Array:
    """``G/dg`` of an edge that recedes at ``speed > 0`` at fixed stress; ``zone`` is its length at rest."""
    return np.vectorize(
        lambda v: closed_at_fixed_stress(steady_crack.opening, material, zone, v), otypes=[float]
    )(speed)
