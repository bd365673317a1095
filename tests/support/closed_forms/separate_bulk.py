"""The material of constant Poisson's ratio whose surface answers as one whose bulk and shear relax apart."""

from __future__ import annotations

from dataclasses import replace

from contact_scene import Branch, Material
from validation.reference.prony_integrals import plane_spectrum


def equivalent_material(material: Material) -> Material:
    """The material with the same plane modulus at all times, without a bulk of its own."""
    relaxed, moduli, times = plane_spectrum(material)
    plane = 1.0 - material.poisson**2
    branches = tuple(map(Branch, (plane * moduli).tolist(), times.tolist()))
    return replace(material, modulus=plane * relaxed, branches=branches, bulk=None)
