r"""Process zone of fixed cohesive stress: elastic sphere, and the steady opening edge.

The zone ``da`` is the length over which the tension of the sharp edge has the mean ``(4/pi) s`` (see
:mod:`contact_scene.adhesion`).

**Elastic sphere** (:mod:`validation.reference.finite_zone`): with ``T = a^2/R - D``, ``b = a - da``,

    int_b^a sigma dr = (E*/pi) [T arccos(b/a) - (1/R) (a^2 arccos(b/a) - b sqrt(a^2 - b^2))].

**Steady opening** (:mod:`validation.reference.steady_crack`): tractions follow the moving elastic field, so
that ``da = (pi/8) (K/s)^2 = da_0 G/dg`` with the width at rest ``da_0 = pi E0* dg/(4 s^2)``, and the law at
fixed length holds at that length: ``G/dg = f(da_0 (G/dg)/v)``.
"""

from __future__ import annotations

import math
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


def opening(material: Material, zone: float, speed: ArrayLike) -> Array:
    """``G/dg`` of an edge that recedes at ``speed > 0`` at fixed stress; ``zone`` is its length at rest."""
    highest = material.glassy_modulus / material.modulus

    def closed(v: float) -> float:
        """``G/dg = f(zone G/dg)``: the zone grows with what the edge takes up."""
        return float(brentq(lambda g: g - float(steady_crack.opening(material, zone * g, v)), 1.0, highest))

    return np.vectorize(closed, otypes=[float])(speed)
