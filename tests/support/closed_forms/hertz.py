"""Hertz (1882): sphere on an elastic half-space, without adhesion.

As in Johnson, *Contact Mechanics* (1985), section 4.2: paraboloid of radius ``R``, contact radius ``a``,
penetration ``D`` positive downwards, force ``F`` and pressure ``p`` positive in compression, displacement
``u`` of the surface positive downwards, ``E* = E/(1 - nu^2)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def stored_energy(contact_radius: ArrayLike, radius: float, plane_modulus: float) -> Array:
    """``U = 8 E* a^5/(15 R^2)``, the work ``int F dD`` of loading."""
    return 8.0 * plane_modulus * np.asarray(contact_radius, float) ** 5 / (15.0 * radius**2)


def pressure(r: ArrayLike, contact_radius: float, radius: float, plane_modulus: float) -> Array:
    """``p(r) = (2 E*/(pi R)) sqrt(a^2 - r^2)`` inside, zero outside; same shape as ``r``."""
    inside = np.maximum(contact_radius**2 - np.asarray(r, float) ** 2, 0.0)
    return 2.0 * plane_modulus / (np.pi * radius) * np.sqrt(inside)


def displacement(r: ArrayLike, contact_radius: float, radius: float) -> Array:
    """Surface displacement: ``D - r^2/(2R)`` inside and, outside,

    ``u = (1/(pi R)) [(2 a^2 - r^2) arcsin(a/r) + a sqrt(r^2 - a^2)]``; same shape as ``r``."""
    a, r = contact_radius, np.asarray(r, float)
    outer = np.maximum(r, a)
    outside = ((2.0 * a**2 - outer**2) * np.arcsin(a / outer) + a * np.sqrt(outer**2 - a**2)) / np.pi
    return np.where(r < a, a**2 - 0.5 * r**2, outside) / radius
