"""Kendall (1971): flat punch of radius ``a`` pulled from a half-space, and its viscoelastic bounds.

K. Kendall, J. Phys. D 4, 1186. ``F = 2 a E* D`` and ``K^2/(2 E*) = E* D^2/(2 pi a)``; the whole contact lets
go at ``F = -sqrt(8 pi a^3 E* dg)``, for the energy released grows as the contact shrinks.

A viscoelastic half-space brackets that between its two ends: pulled infinitely slowly the relaxed modulus
``E0*`` decides, from a relaxed state and infinitely fast the glassy ``Einf*``. Under a dead load a tension
below the slow bound is carried for ever, one above the fast bound is not carried at all.
``F > 0`` presses, ``D > 0`` downwards.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Material

Array = NDArray[np.float64]


def pressure(r: ArrayLike, penetration: float, radius: float, plane_modulus: float) -> Array:
    """``p = (E* D/pi)/sqrt(a^2 - r^2)`` for ``r < a`` (Boussinesq); same shape as ``r``."""
    return plane_modulus * penetration / (np.pi * np.sqrt(radius**2 - np.asarray(r, float) ** 2))


def pull_off_force(radius: float, plane_modulus: float, work: float) -> float:
    """Tension at detachment, positive: ``sqrt(8 pi a^3 E* dg)``."""
    return float(np.sqrt(8.0 * np.pi * radius**3 * plane_modulus * work))


def viscoelastic_bounds(material: Material, radius: float, work: float) -> tuple[float, float]:
    """Pull-off force of infinitely slow and of infinitely fast retraction, both positive.

    Their ratio is ``sqrt(Einf/E0)``."""
    return (
        pull_off_force(radius, material.relaxed_plane_modulus, work),
        pull_off_force(radius, material.glassy_plane_modulus, work),
    )
