"""Half-space whose shear relaxes while its bulk modulus is constant: the plane modulus as a Prony series.

Frictionless normal contact sees one operator, ``E* = 4 mu (3K + mu)/(3K + 4 mu)``, whatever Poisson's ratio
does in time (correspondence principle, Lee 1955). With ``M = 3K + 4 mu`` it is

    E* = M/4 + 3K/2 - 27 K^2/(4 M),

so that ``E*(t) = 9K/4 + mu(t) - (27 K^2/4) N(t)`` with ``N`` the creep compliance that belongs to ``M(t)``: a
Prony series with the relaxation times of shear and the retardation times of ``M``. A material of constant
Poisson's ratio with that series has the same forces, radii and displacements of the surface.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from contact_scene import Branch, BulkRelaxation, Material, UnsupportedScene
from validation.reference.creep_compliance import creep_spectrum

Array = NDArray[np.float64]


def plane_relaxation(material: Material, time: ArrayLike) -> Array:
    """``E*(t)`` where the bulk does not relax; same shape as ``time``."""
    relaxed, moduli, times = plane_spectrum(material)
    return np.asarray(relaxed + np.exp(-np.asarray(time, float)[..., None] / times) @ moduli)


def plane_spectrum(material: Material) -> tuple[float, Array, Array]:
    """Relaxed plane modulus, and moduli and times of its branches, (2n,) for n branches in shear."""
    bulk = material.bulk
    if bulk is None or (isinstance(bulk, BulkRelaxation) and bulk.branches):
        raise UnsupportedScene("material.bulk", "the bulk modulus has to be constant", 'bulk = "elastic"')
    shear = material.modulus / (2.0 * (1.0 + material.poisson))
    each = np.array([branch.modulus for branch in material.branches]) / (2.0 * (1.0 + material.poisson))
    times = np.array([branch.time for branch in material.branches])
    order = np.argsort(times)
    each, times = each[order], times[order]
    given = bulk.modulus if isinstance(bulk, BulkRelaxation) else None
    stiff = given if given is not None else material.modulus / (3.0 * (1.0 - 2.0 * material.poisson))
    compliances, retardation, _ = creep_spectrum(3.0 * stiff + 4.0 * shear, 4.0 * each, times)
    relaxed = 4.0 * shear * (3.0 * stiff + shear) / (3.0 * stiff + 4.0 * shear)
    return (
        relaxed,
        np.concatenate((each, 6.75 * stiff**2 * compliances)),
        np.concatenate((times, retardation)),
    )


def equivalent_material(material: Material) -> Material:
    """The material of constant Poisson's ratio with the same plane modulus at all times."""
    relaxed, moduli, times = plane_spectrum(material)
    plane = 1.0 - material.poisson**2
    branches = tuple(
        Branch(plane * modulus, time) for modulus, time in zip(moduli.tolist(), times.tolist(), strict=True)
    )
    return replace(material, modulus=plane * relaxed, branches=branches, bulk=None)
