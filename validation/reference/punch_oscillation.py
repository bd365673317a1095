"""Flat punch in full contact: its force for an oscillating penetration.

The contact does not change, so the half-space is one linear element (Boussinesq's punch and the
correspondence principle; Sneddon 1965): ``F(w) = 2 a E*(w) D(w)`` with the complex modulus ``E*(w)``.
For ``D = A sin(w t)`` switched on at ``t = 0`` from rest, branch ``k`` carries

    b_k = E_k* A y/(1 + y^2) [cos(w t) + y sin(w t) - exp(-t/tau_k)],   y = w tau_k,

and ``F = 2 a [E0* A sin(w t) + sum_k b_k]``. ``F > 0`` presses, ``D > 0`` downwards.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Material
from validation.reference.prony_integrals import plane_spectrum

Array = NDArray[np.float64]


def dynamic_stiffness(
    material: Material, radius: float, angular_frequency: ArrayLike
) -> NDArray[np.complex128]:
    """``2 a E*(w)``, storage + i loss, of the shape of ``angular_frequency``."""
    relaxed, moduli, times = plane_spectrum(material)
    lag = 1j * np.asarray(angular_frequency, float)[..., None] * times
    return np.asarray(2.0 * radius * (relaxed + lag / (1.0 + lag) @ moduli))


def loss_per_cycle(material: Material, radius: float, angular_frequency: float, amplitude: float) -> float:
    """Work lost in a steady cycle, ``pi A^2 Im(2 a E*(w))``."""
    return float(np.pi * amplitude**2 * dynamic_stiffness(material, radius, angular_frequency).imag)


def force(
    material: Material, radius: float, angular_frequency: float, amplitude: float, time: ArrayLike
) -> Array:
    """``F(t)`` of ``D = A sin(w t)`` from rest at ``t = 0``; same shape as ``time``."""
    relaxed, moduli, times = plane_spectrum(material)
    t = np.asarray(time, float)
    phase = angular_frequency * t
    y = angular_frequency * times
    swing = np.cos(phase)[..., None] + y * np.sin(phase)[..., None] - np.exp(-t[..., None] / times)
    stress = relaxed * np.sin(phase) + swing @ (moduli * y / (1.0 + y**2))
    return 2.0 * radius * amplitude * stress
