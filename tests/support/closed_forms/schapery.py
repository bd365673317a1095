"""Schapery (1975): opening crack with a failure zone of length ``alpha``, for comparison only.

R.A. Schapery, Int. J. Fracture 11, 141, 369 and 549. The creep compliance within the failure zone is
replaced by its value at one effective time, a fraction (about a third, insensitive to the material) of the
time the crack takes to travel the zone:

    dg = (1/2) J*(alpha/(3 v)) K^2     =>     G/dg = J*(inf)/J*(alpha/(3 v)).

The fixed-zone closure has the *average* of ``J*`` over ``[0, da/v]`` instead. The two agree only at the ends
(1 and ``Einf/E0``) and, for a ramp-like ``J*``, not even then at the same effective time (1/2 instead of
1/3).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from support.closed_forms.fixed_stress import closed_at_fixed_stress

from contact_scene import Material
from validation.reference.creep_compliance import creep_compliance

Array = NDArray[np.float64]


def enhancement(material: Material, zone: float, speed: ArrayLike, fraction: float = 1.0 / 3.0) -> Array:
    """``G/dg`` of a receding edge at fixed zone length; same shape as ``speed``."""
    effective = fraction * zone / np.asarray(speed, float)
    return 1.0 / (material.modulus * creep_compliance(material)(effective))


def fixed_stress_enhancement(material: Material, zone: float, speed: ArrayLike) -> Array:
    """``G/dg`` at fixed failure stress: ``alpha = zone G/dg``, with ``zone`` its length at rest."""
    return np.vectorize(lambda v: closed_at_fixed_stress(enhancement, material, zone, v), otypes=[float])(
        speed
    )
