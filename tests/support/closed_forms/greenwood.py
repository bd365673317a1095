"""Greenwood (2004): opening crack with a Dugdale zone in a viscoelastic solid, for comparison only.

J.A. Greenwood, J. Phys. D 37, 2557 (see also K.L. Johnson in *Microstructure and Microtribology of Polymer
Surfaces*, 2000). Constant stress ``s0`` acts over the zone of length ``b``; the zone moves with the crack.
Its elastic opening has the slope ``(4 s0/(pi E*)) m(z)``, ``m = (1/2) ln((1 + sqrt z)/(1 - sqrt z))``, at the
fraction ``z`` of the zone from its leading edge, and ``int_0^1 m dz = 1``. The creep answer at the trailing
edge must reach the gap ``dg/s0``; with ``K = s0 sqrt(8 b/pi)``,

    dg = (K^2/2) int_0^1 J*((1 - z) b/v) m(z) dz    =>    G/dg = J*(inf) / int_0^1 J*((1 - z) b/v) m(z) dz.

At fixed stress the zone lengthens with ``G``: ``b = b0 G/dg``, ``b0 = pi E0* dg/(4 s0^2)``. It agrees with
the fixed-zone closure only at the ends (1 and ``Einf/E0``), whichever of the two lengths is held.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import quad
from scipy.optimize import brentq

from contact_scene import Material
from validation.reference.creep_compliance import creep_compliance

Array = NDArray[np.float64]


def enhancement(material: Material, zone: float, speed: ArrayLike) -> Array:
    """``G/dg`` of a receding edge at fixed zone length ``b``."""
    return np.vectorize(lambda v: _at_zone(material, zone, v), otypes=[float])(speed)


def fixed_stress_enhancement(material: Material, zone: float, speed: ArrayLike) -> Array:
    """``G/dg`` with ``b = zone * G/dg`` (``zone``: length at rest)."""
    highest = material.glassy_modulus / material.modulus

    def solve(v: float) -> float:
        if highest == 1.0:
            return 1.0
        return float(brentq(lambda g: g - _at_zone(material, zone * g, v), 1.0, highest))

    return np.vectorize(solve, otypes=[float])(speed)


def _at_zone(material: Material, zone: float, speed: float) -> float:
    compliance = creep_compliance(material)

    def weighted(y: float) -> float:
        # z = 1 - y^2: the logarithm at z = 1 becomes y log y, harmless to the quadrature.
        root = np.sqrt(1.0 - y * y)
        slope = np.log((1.0 + root) / y)
        return float(compliance(y * y * zone / speed)) * slope * 2.0 * y

    mean = quad(weighted, 0.0, 1.0, epsabs=0.0, epsrel=1e-10, limit=200)[0]
    return 1.0 / (material.modulus * float(mean))
