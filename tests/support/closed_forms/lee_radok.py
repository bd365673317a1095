"""Lee and Radok (1960): viscoelastic half-space under an indenter whose contact grows, without adhesion.

E.H. Lee, J.R.M. Radok, J. Appl. Mech. 27, 438 (sphere); T.C.T. Ting, J. Appl. Mech. 33, 845 (1966) (any
profile). While ``a`` grows it depends on the present penetration alone, ``D = G(a)``, and

    F(t) = int_0^t E*(t - s) 2 a(s) D'(s) ds,

the elastic force per unit modulus (whose derivative with respect to ``D`` is ``2 a``) under the relaxation
integral (:mod:`validation.reference.ting`). The dual holds with the force given: the elastic force per unit
modulus is ``int J*(t - s) dF(s)``. ``F > 0`` presses, ``D > 0`` downwards, ``t = 0`` at first touch.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Indenter, Material
from validation.reference import prony_integrals, sneddon

Array = NDArray[np.float64]


def radius_under_force_step(
    material: Material, indenter: Indenter, force: float, time: ArrayLike, preload: float = 0.0
) -> Array:
    """Contact radius at ``time >= 0`` under a dead load ``force > 0`` added at ``t = 0``.

    ``preload`` is a force carried since long before, fully relaxed."""
    crept = prony_integrals.creep(material, time) * force
    return _radius_of_unit_force(indenter, crept + preload / material.relaxed_plane_modulus)


def radius_under_force_ramp(
    material: Material, indenter: Indenter, rate: float, time: ArrayLike, preload: float = 0.0
) -> Array:
    """Contact radius at ``time >= 0`` under ``F = preload + rate * t``, the preload relaxed."""
    crept = prony_integrals.creep_integral(material, time) * rate
    return _radius_of_unit_force(indenter, crept + preload / material.relaxed_plane_modulus)


def _radius_of_unit_force(indenter: Indenter, unit_force: Array) -> Array:
    """The ``a`` whose adhesionless elastic force per unit modulus is ``2 (a G(a) - H(a))``."""
    law = indenter.power
    if law is not None:
        n, c = law
        unit = 2.0 * c * sneddon.shape_factor(n) * n / (n + 1.0)
        return (np.asarray(unit_force, float) / unit) ** (1.0 / (n + 1.0))

    def invert(target: float) -> float:
        return sneddon.radius_at(lambda a: float(sneddon.force(indenter, a, 1.0)), target)

    return np.vectorize(invert, otypes=[float])(unit_force)
