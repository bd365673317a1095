"""Bulk and shear that relax apart: the plane modulus in closed form, and contacts solved with it."""

import numpy as np
import pytest
from support.closed_forms.separate_bulk import equivalent_material, plane_relaxation, plane_spectrum

from contact_scene import Branch, BulkRelaxation, Material, UnsupportedScene
from validation.reference import prony_integrals

APART = Material(0.75, 0.4, (Branch(3.0, 0.1), Branch(3.75, 1.0)), "elastic")
SOFT = Material(1e6, 0.3, (Branch(9e6, 0.5),), BulkRelaxation(5e5))


def _plane(material: Material, ratio: float) -> float:
    """``E*`` where shear is ``ratio`` times as stiff as relaxed."""
    shear = ratio * material.modulus / (2.0 * (1.0 + material.poisson))
    bulk = material.modulus / (3.0 * (1.0 - 2.0 * material.poisson))
    if isinstance(material.bulk, BulkRelaxation) and material.bulk.modulus is not None:
        bulk = material.bulk.modulus
    young, poisson = 9.0 * bulk * shear / (3.0 * bulk + shear), 0.5 - 1.5 * shear / (3.0 * bulk + shear)
    return young / (1.0 - poisson**2)


@pytest.mark.parametrize("material", [APART, SOFT])
def test_plane_modulus_is_elastic_at_both_ends_and_its_transform_in_between(material: Material) -> None:
    total = sum(branch.modulus for branch in material.branches)
    assert plane_relaxation(material, 0.0) == pytest.approx(_plane(material, 1.0 + total / material.modulus))
    assert plane_relaxation(material, 1e9) == pytest.approx(_plane(material, 1.0))
    relaxed, moduli, times = plane_spectrum(material)
    for s in (0.1, 1.0, 10.0, 1e3):  # Carson transform
        shear = material.modulus + sum(b.modulus * s * b.time / (1.0 + s * b.time) for b in material.branches)
        got = relaxed + float((moduli * s * times / (1.0 + s * times)).sum())
        assert got == pytest.approx(_plane(material, shear / material.modulus), rel=1e-12)


def test_a_material_that_keeps_its_volume_has_four_times_its_shear_modulus() -> None:
    rubber = Material(0.75, 0.5, (Branch(6.75, 1.0),), BulkRelaxation(1e9))
    time = np.linspace(0.0, 5.0, 7)
    shear = rubber.relaxation_modulus(time) / 3.0
    np.testing.assert_allclose(plane_relaxation(rubber, time), 4.0 * shear, rtol=2e-8)


def test_the_equivalent_material_has_the_same_plane_modulus() -> None:
    time = np.geomspace(1e-3, 1e2, 30)
    same = equivalent_material(APART)
    np.testing.assert_allclose(
        prony_integrals.relaxation(same, time), plane_relaxation(APART, time), rtol=1e-13
    )
    alike = prony_integrals.relaxation(Material(APART.modulus, APART.poisson, APART.branches), 0.0)
    assert abs(plane_relaxation(APART, 0.0) / alike - 1.0) > 0.1  # taken to relax alike: a tenth off or more


def test_a_bulk_that_relaxes_too_is_refused() -> None:
    both = Material(1.0, 0.3, (Branch(1.0, 1.0),), BulkRelaxation(1.0, (Branch(1.0, 1.0),)))
    for material in (both, Material(1.0, 0.3, (Branch(1.0, 1.0),))):
        with pytest.raises(UnsupportedScene, match="constant"):
            plane_spectrum(material)
