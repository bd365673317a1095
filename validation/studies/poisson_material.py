"""Materials of one shear relaxation and different compressibility, and their modulus at the surface.

With shear modulus ``G(t)`` and bulk modulus ``K(t)`` apart, Poisson's ratio depends on time. Yet the surface
of the half-space feels one modulus only. The Laplace transform (marked ^) of its compliance under normal load
is that of an elastic half-space, which depends on ``E* = E/(1 - nu^2)`` alone; hence it depends on

    E*^ = 4 G^ (3 K^ + G^)/(3 K^ + 4 G^),      1/E*^ = 1/(4 G^) + 3/(4 (3 K^ + G^)),

so the creep compliance of the plane modulus is ``J*(t) = J_G(t)/4 + (3/4) J_(3K + G)(t)``, from two ordinary
Prony series. Any solver made for a constant ratio then gives force, contact radius and the shape of the
surface without further error, with this E*(t). Only the stress in the body (rr and tt) depends
on Poisson's ratio itself.
"""

from __future__ import annotations

import numpy as np

from contact_scene import Branch, BulkRelaxation, Material
from validation.reference.creep_compliance import creep_compliance, relaxation_spectrum

_SAME = 1e-12
"""Relative difference below which two retardation times are the same but for round-off."""


def shear_of(material: Material) -> Material:
    """The shear modulus ``G(t) = E(t)/(2 (1 + nu))``, written as a Young's modulus."""
    return _scaled(material, 0.5 / (1.0 + material.poisson), 0.0)


def with_bulk(material: Material, ratio: float) -> Material:
    """The same ``G(t)`` with elastic bulk of ``K = ratio * G(infinity)``, ``ratio > 2/3``."""
    poisson = (3.0 * ratio - 2.0) / (2.0 * (3.0 * ratio + 1.0))
    young = _scaled(shear_of(material), 2.0 * (1.0 + poisson), poisson)
    return Material(young.modulus, poisson, young.branches, "elastic")


def constant(material: Material) -> Material:
    """The same ``G(t)`` with the Poisson's ratio of the relaxed solid at all times: bulk relaxes alike."""
    return Material(material.modulus, material.poisson, material.branches)


def incompressible(material: Material) -> Material:
    """The same ``G(t)`` with Poisson's ratio 0.5."""
    return _scaled(shear_of(material), 3.0, 0.5)


def poisson_range(material: Material) -> tuple[float, float]:
    """Initial (glassy) and final (relaxed) Poisson's ratio of shear and bulk that relax apart."""
    shear, bulk = shear_of(material), _bulk(material)
    pairs = ((shear.glassy_modulus, bulk.glassy_modulus), (shear.modulus, bulk.modulus))
    glassy, relaxed = ((3.0 * k - 2.0 * g) / (2.0 * (3.0 * k + g)) for g, k in pairs)
    return glassy, relaxed


def on_the_surface(material: Material) -> Material:
    """Material of constant Poisson's ratio whose half-space has the same surface: ``E*(t)`` of the head.

    ``material`` has ``bulk``; the answer has its relaxed Poisson's ratio and up to twice the branches.
    """
    shear, bulk = shear_of(material), _bulk(material)
    _, poisson = poisson_range(material)
    plane = _in_series((0.25, shear), (0.75, _beside(shear, bulk)))
    return _scaled(plane, 1.0 - poisson**2, poisson)


def tension(material: Material) -> Material:
    """The modulus that a tensile test measures, ``1/E^ = 1/(3 G^) + 1/(9 K^)``, and a constant ratio.

    Poisson's ratio is the relaxed one.
    """
    shear, bulk = shear_of(material), _bulk(material)
    return _scaled(_in_series((1.0 / 3.0, shear), (1.0 / 9.0, bulk)), 1.0, poisson_range(material)[1])


def _beside(shear: Material, bulk: Material) -> Material:
    """``3 K + G``."""
    tripled = _scaled(bulk, 3.0, 0.0)
    return Material(tripled.modulus + shear.modulus, 0.0, (*tripled.branches, *shear.branches))


def _in_series(*parts: tuple[float, Material]) -> Material:
    """Modulus whose creep compliance is the weighted sum of those of the parts."""
    retarding: dict[float, float] = {}
    for weight, part in parts:
        creep = creep_compliance(part)
        for time, compliance in zip(creep.times.tolist(), creep.compliances.tolist(), strict=True):
            same = next((t for t in retarding if abs(t - time) < _SAME * time), time)
            retarding[same] = retarding.get(same, 0.0) + weight * compliance
    times = np.array(sorted(retarding), float)
    relaxed, moduli, relaxation = relaxation_spectrum(
        sum(weight * creep_compliance(part).glassy for weight, part in parts),
        np.array([retarding[time] for time in times.tolist()], float),
        times,
    )
    branches = zip(moduli.tolist(), relaxation.tolist(), strict=True)
    return Material(relaxed, 0.0, tuple(Branch(modulus, time) for modulus, time in branches))


def _scaled(material: Material, factor: float, poisson: float) -> Material:
    branches = tuple(Branch(factor * branch.modulus, branch.time) for branch in material.branches)
    return Material(factor * material.modulus, poisson, branches)


def _bulk(material: Material) -> Material:
    """The bulk modulus ``K(t)``, written as a Young's modulus."""
    if material.bulk is None:
        raise ValueError("bulk and shear relax alike: Poisson's ratio is constant")
    implied = material.modulus / (3.0 * (1.0 - 2.0 * material.poisson)) if material.poisson < 0.5 else None
    if isinstance(material.bulk, BulkRelaxation):
        modulus = material.bulk.modulus or implied
        return Material(float(modulus or 0.0), 0.0, material.bulk.branches)
    return Material(float(implied or 0.0), 0.0)
