"""Prony material seen by the half-space: plane-strain relaxation and creep, and their averages over time.

``E*(t) = E(t)/(1 - nu^2)`` and ``J*(t) = (1 - nu^2) J(t)``, with ``J* E* = 1`` at both ends. Averages over
``[0, t]`` are written with ``phi(y) = (1 - exp(-y))/y``, exact for any ratio of times. Valid for a constant
Poisson's ratio only, as are all closed forms of viscoelastic contact here.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Material, UnsupportedScene
from validation.reference.creep_compliance import creep_compliance

Array = NDArray[np.float64]


def plane_factor(material: Material) -> float:
    """``1/(1 - nu^2)``.

    Raises
    ------
    UnsupportedScene
        If shear and bulk relax separately: then Poisson's ratio depends on time.
    """
    if material.bulk is not None:
        raise UnsupportedScene(
            "material.bulk", "closed forms need a constant Poisson's ratio", "no bulk relaxation of its own"
        )
    return 1.0 / (1.0 - material.poisson**2)


def _phi(y: Array) -> Array:
    """``(1 - exp(-y))/y`` for ``y >= 0``, one at zero and zero at infinity."""
    safe = np.where(y > 0.0, y, 1.0)
    return np.where(y > 0.0, -np.expm1(-safe) / safe, 1.0)


def relaxation(material: Material, time: ArrayLike) -> Array:
    """``E*(t)``; same shape as ``time``."""
    return plane_factor(material) * material.relaxation_modulus(time)


def mean_relaxation(material: Material, time: ArrayLike) -> Array:
    """``(1/t) int_0^t E*(s) ds = E0* + sum_k E_k* phi(t/tau_k)``; ``time`` may be 0 or infinite."""
    moduli, times = material.spectrum
    t = np.asarray(time, float)[..., None]
    return plane_factor(material) * (material.modulus + _phi(t / times) @ moduli)


def relaxation_integral(material: Material, time: ArrayLike) -> Array:
    """``I(t) = int_0^t E*(s) ds`` for finite ``time >= 0``; zero before."""
    t = np.maximum(np.asarray(time, float), 0.0)
    return t * mean_relaxation(material, t)


def creep(material: Material, time: ArrayLike) -> Array:
    """``J*(t)``; same shape as ``time``."""
    return creep_compliance(material)(time) / plane_factor(material)


def mean_creep(material: Material, time: ArrayLike) -> Array:
    """``(1/t) int_0^t J*(s) ds = J*(0) + sum_k J_k* (1 - phi(t/theta_k))``; ``time`` may be 0 or infinite."""
    compliance = creep_compliance(material)
    t = np.asarray(time, float)[..., None]
    mean = compliance.glassy + (1.0 - _phi(t / compliance.times)) @ compliance.compliances
    return mean / plane_factor(material)


def creep_integral(material: Material, time: ArrayLike) -> Array:
    """``int_0^t J*(s) ds`` for finite ``time >= 0``; zero before."""
    t = np.maximum(np.asarray(time, float), 0.0)
    return t * mean_creep(material, t)
