"""Persson and Brener (2005): viscoelastic enhancement of an opening crack, for comparison only.

B.N.J. Persson, E.A. Brener, Phys. Rev. E 71, 036123. From the energy lost around a crack whose tip cuts the
singularity off at frequency ``wc = 2 pi v/r`` (``r``: tip radius), with ``1/E(w)`` the complex compliance,

    G/G0 = [1 - (2/pi) E0 int_0^wc sqrt(1 - (w/wc)^2) |Im(1/E(w))| dw/w]^(-1),

which for a Prony material is ``[1 - E0 sum_k J_k (sqrt(1 + b_k^2) - 1)/b_k]^(-1)``, ``b_k = wc theta_k``.
The tip radius may be fixed or may blunt with the enhancement, ``r = r0 G/G0``.

It agrees with the closure at a fixed process zone only at the ends (1 and ``Einf/E0``): in between the two
shift against each other in speed and differ in shape, and neither is an error measure of the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from contact_scene import Material
from validation.reference.creep_compliance import creep_compliance

Array = NDArray[np.float64]


def enhancement(material: Material, tip_radius: float, speed: ArrayLike) -> Array:
    """``G/G0`` at fixed tip radius."""
    compliance = creep_compliance(material)
    b = 2.0 * np.pi * np.asarray(speed, float)[..., None] / tip_radius * compliance.times
    weight = b / (np.sqrt(1.0 + b**2) + 1.0)  # (sqrt(1 + b^2) - 1)/b without cancellation
    return 1.0 / (1.0 - material.modulus * (weight @ compliance.compliances))


def blunting_enhancement(material: Material, tip_radius: float, speed: ArrayLike) -> Array:
    """``G/G0`` with ``r = tip_radius * G/G0``."""
    highest = material.glassy_modulus / material.modulus

    def solve(v: float) -> float:
        if highest == 1.0:
            return 1.0
        return float(brentq(lambda g: g - float(enhancement(material, tip_radius * g, v)), 1.0, highest))

    return np.vectorize(solve, otypes=[float])(speed)
