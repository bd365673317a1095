"""Prony material seen by the half-space: plane-strain relaxation and creep, and their averages over time.

The surface knows one operator, ``1/E* = 1/(4 G) + 3/(4 (3 K + G))`` with the shear and the bulk modulus
(correspondence principle, Lee 1955): two creep compliances in series, whose sum is inverted. Where Poisson's
ratio does not depend on time it is ``E/(1 - nu^2)``. Averages over ``[0, t]`` are written with
``phi(y) = (1 - exp(-y))/y``, exact for any ratio of times.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import BulkRelaxation, Material
from validation.reference.creep_compliance import creep_spectrum, relaxation_spectrum

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-13
"""Branch modulus over the glassy one, and distance of two times, below which they are round-off of others."""


def plane_spectrum(material: Material) -> tuple[float, Array, Array]:
    """Relaxed plane modulus, and moduli and times of its branches, ascending in time."""
    moduli, times = material.spectrum
    bulk = material.bulk
    if bulk is None:
        return material.relaxed_plane_modulus, moduli / (1.0 - material.poisson**2), times
    twice = 2.0 * (1.0 + material.poisson)
    shear, own = material.modulus / twice, bulk.modulus if isinstance(bulk, BulkRelaxation) else None
    stiffness = own or material.modulus / (3.0 * (1.0 - 2.0 * material.poisson))
    branches = bulk.branches if isinstance(bulk, BulkRelaxation) else ()
    volume, slow = Material(stiffness, 0.0, branches).spectrum
    mixed = _joined(np.concatenate((times, slow)), np.concatenate((moduli / twice, 3.0 * volume)))
    series = (
        (4.0 * shear, 4.0 * moduli / twice, times),
        (4.0 * stiffness + 4.0 / 3.0 * shear, 4.0 / 3.0 * mixed[1], mixed[0]),
    )
    creep = [creep_spectrum(*one) for one in series]
    glassy = sum(1.0 / (one[0] + float(one[1].sum())) for one in series)
    retardation, compliances = _joined(*(np.concatenate([one[k] for one in creep]) for k in (1, 0)))
    return relaxation_spectrum(glassy, compliances, retardation)


def _joined(times: Array, strengths: Array) -> tuple[Array, Array]:
    """Times that rise, each once, and the sums of what belongs to them."""
    if not times.size:
        return times, strengths
    order = times.argsort()
    times, strengths = times[order], strengths[order]
    first = np.flatnonzero(np.append(True, np.diff(times) > NEGLIGIBLE * times[1:]))
    return times[first], np.add.reduceat(strengths, first)


@lru_cache(maxsize=64)
def plane_creep(material: Material) -> tuple[float, Array, Array]:
    """Glassy plane compliance, and compliances and retardation times of the units, ascending in time."""
    relaxed, moduli, times = plane_spectrum(material)
    return 1.0 / (relaxed + float(moduli.sum())), *creep_spectrum(relaxed, moduli, times)[:2]


def _phi(y: Array) -> Array:
    """``(1 - exp(-y))/y`` for ``y >= 0``, one at zero and zero at infinity."""
    safe = np.where(y > 0.0, y, 1.0)
    return np.where(y > 0.0, -np.expm1(-safe) / safe, 1.0)


def relaxation(material: Material, time: ArrayLike) -> Array:
    """``E*(t)``; same shape as ``time``."""
    relaxed, moduli, times = plane_spectrum(material)
    return np.asarray(relaxed + np.exp(-np.asarray(time, float)[..., None] / times) @ moduli)


def mean_relaxation(material: Material, time: ArrayLike) -> Array:
    """``(1/t) int_0^t E*(s) ds = E0* + sum_k E_k* phi(t/tau_k)``; ``time`` may be 0 or infinite."""
    relaxed, moduli, times = plane_spectrum(material)
    return np.asarray(relaxed + _phi(np.asarray(time, float)[..., None] / times) @ moduli)


def relaxation_integral(material: Material, time: ArrayLike) -> Array:
    """``I(t) = int_0^t E*(s) ds`` for finite ``time >= 0``; zero before."""
    t = np.maximum(np.asarray(time, float), 0.0)
    return t * mean_relaxation(material, t)


def creep(material: Material, time: ArrayLike) -> Array:
    """``J*(t)`` for ``time >= 0``; same shape as ``time``."""
    glassy, compliances, times = plane_creep(material)
    return np.asarray(glassy - np.expm1(-np.asarray(time, float)[..., None] / times) @ compliances)


def mean_creep(material: Material, time: ArrayLike) -> Array:
    """``(1/t) int_0^t J*(s) ds = J*(0) + sum_k J_k* (1 - phi(t/theta_k))``; ``time`` may be 0 or infinite."""
    glassy, compliances, times = plane_creep(material)
    return np.asarray(glassy + (1.0 - _phi(np.asarray(time, float)[..., None] / times)) @ compliances)


def creep_integral(material: Material, time: ArrayLike) -> Array:
    """``int_0^t J*(s) ds`` for finite ``time >= 0``; zero before."""
    t = np.maximum(np.asarray(time, float), 0.0)
    return t * mean_creep(material, t)
