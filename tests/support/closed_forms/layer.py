"""Viscoelastic layer of one Poisson's ratio where its history is known: growing contact, frozen retraction.

In the transform of the pressure a layer is ``q - M q = int E* dw``, without time in ``M``: see
:mod:`validation.reference.elastic_layer`.

**Growing contact without adhesion** (Lee and Radok): the contact radius is the elastic one at the present
penetration, and ``F = int E*(t - s) d[F_el(D(s))/E*]``; the stiffness is ``dF_el/dD = stiffness(a)``.

**Frozen retraction**: a relaxed contact at ``D_B``, ``a_B``, pulled faster than it relaxes. In a contact of
``a <= a_B`` then ``q - M q = E0* (D_B - G) + Einf* (D - D_B)``, and the edge is at the limit where
``q(a) = -sqrt(2 pi a Einf* dg)``.

**Thin limits** of the flat punch, ``F/(2 E* a D)`` for ``a/h -> inf``: uniform strain under the punch with
the modulus of a layer that cannot move sideways (bonded) or can (frictionless), and lubrication where it is
incompressible and bonded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from scipy.integrate import quad
from scipy.optimize import brentq

from contact_scene import Material
from validation.reference import prony_integrals
from validation.reference.elastic_layer import ElasticLayer
from validation.reference.jkr import ElasticContact


def growing_force(material: Material, layer: ElasticLayer, rate: float, time: float) -> float:
    """Force at a time of a ramp from the first touch, the roots of the time as abscissa."""

    def integrand(root: float) -> float:
        since = time * root * root
        stiffness = layer.response(layer.radius_at(rate * since)).stiffness
        return (
            float(prony_integrals.relaxation(material, time - since)) * stiffness * rate * 2.0 * time * root
        )

    return float(quad(integrand, 0.0, 1.0, epsabs=0.0, epsrel=1e-9)[0])


@dataclass(frozen=True)
class FrozenLayer:
    """Instant retraction from the relaxed equilibrium at penetration ``start``; ``work`` of adhesion."""

    material: Material
    layer: ElasticLayer
    work: float
    start: float

    @property
    def relaxed(self) -> ElasticContact:
        """The outermost equilibrium at the start."""
        modulus = self.material.relaxed_plane_modulus

        def excess(radius: float) -> float:
            return self.layer.state(radius, self.work / modulus).penetration - self.start

        high = self.layer.radius_at(self.start)
        low = high  # adhesion only adds to the contact
        while excess(high) < 0.0:
            high *= 1.2
        found = self.layer.state(float(brentq(excess, low, high, xtol=1e-15)), self.work / modulus)
        return ElasticContact(found.contact_radius, found.penetration, modulus * found.force)

    def release(self, radius: float) -> ElasticContact:
        """Where the edge is at a radius that is at most that of the relaxed contact."""
        soft, stiff = self.material.relaxed_plane_modulus, self.material.glassy_plane_modulus
        found = self.layer.response(radius)
        pull = math.sqrt(2.0 * math.pi * radius * stiff * self.work)
        relaxed = soft * (self.start * found.edge - found.profile_edge)
        depth = self.start - (relaxed + pull) / (stiff * found.edge)
        force = soft * found.force(self.start) + stiff * found.stiffness * (depth - self.start)
        return ElasticContact(radius, depth, force)


def thin_punch(ratio: float, poisson: float, base: str) -> float:
    """Stiffness of a flat punch of ``ratio`` thicknesses over that on a half-space, to leading order."""
    if base == "frictionless":
        return 0.5 * math.pi * ratio
    if poisson == 0.5:
        return 3.0 * math.pi / 64.0 * ratio**3
    return 0.5 * math.pi * ratio * (1.0 - poisson) ** 2 / (1.0 - 2.0 * poisson)
