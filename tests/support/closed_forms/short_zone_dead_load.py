r"""A relaxed sphere with a short process zone under a dead load: its time to detachment is one integral.

As long as the edge only recedes, ``q`` (:mod:`..short_zone`) differs from that of the relaxed contact by a
constant over the contact, so that the force alone says what it is at the edge,

    q(a) = F/(2 a) - 2 E0* a^2/(3 R),

and the speed is a function of the radius: ``t = int_a^(a_1) da/v(a)``, in proportion to ``1/da``. The load
comes on at once; if the edge does not hold then, it jumps to the radius ``a_1`` where it does. Contact is
lost where it holds no longer. The penetration is the creep under that constant.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar
from support.closed_forms.short_zone import LOST
from support.closed_forms.short_zone_edge import ShortZoneEdge

from contact_scene import Sphere
from validation.reference.jkr import JKR
from validation.reference.prony_integrals import creep

_PLACES = np.linspace(0.0, 1.0, 2001)


@dataclass(frozen=True)
class DeadLoad:
    """A relaxed contact under a force applied at once and kept."""

    radius: float
    penetration: float
    detachment_time: float
    detachment_radius: float
    detachment_penetration: float


def dead_load(law: ShortZoneEdge, start: float, force: float) -> DeadLoad:
    """The relaxed contact at the penetration ``start`` under a tension (negative) until it is lost."""
    material, radius = law.material, law.radius
    relaxed, glassy = material.relaxed_plane_modulus, material.glassy_plane_modulus
    first = JKR(Sphere(radius), relaxed, law.work).at_penetration(start).contact_radius

    def load(a: float) -> float:
        return 0.5 * force / a - 2.0 * relaxed * a * a / (3.0 * radius)

    def added(a: float) -> float:
        """What ``q`` has in addition to that of the start, at every point in contact."""
        return load(a) - relaxed * (start - a * a / radius)

    def added_slope(a: float) -> float:
        return -0.5 * force / a**2 + 2.0 * relaxed * a / (3.0 * radius)

    def excess(a: float) -> float:
        return law.compliance_needed(a, load(a)) * glassy - 1.0

    bounds = (LOST * first, first)
    weakest = float(minimize_scalar(lambda a: -excess(a), bounds=bounds, method="bounded").x)
    if excess(weakest) <= 0.0 or excess(weakest) >= glassy / relaxed - 1.0:
        raise ValueError(f"a force of {force:g} is no delayed loss of contact")
    after = first if excess(first) >= 0.0 else float(brentq(excess, weakest, first, rtol=1e-14))
    last = float(brentq(excess, LOST * weakest, weakest, rtol=1e-14))
    radii = after + (last - after) * 0.5 * (1.0 - np.cos(math.pi * _PLACES))  # both ends are square roots
    crossing = np.array([law.crossing_time(a, load(a)) / law.zone for a in radii])
    slowness = CubicSpline(_PLACES, crossing * 0.5 * math.pi * (after - last) * np.sin(math.pi * _PLACES))
    times = slowness.antiderivative()(_PLACES)
    lost = float(times[-1])
    freed = creep(material, lost - times)
    slopes = np.array([added_slope(a) for a in radii])
    stretch = 0.5 * math.pi * (last - after) * np.sin(math.pi * _PLACES)
    crept = added(after) * freed[0] + CubicSpline(_PLACES, freed * slopes * stretch).integrate(0.0, 1.0)
    return DeadLoad(after, start + added(after) / glassy, lost, last, start + float(crept))
