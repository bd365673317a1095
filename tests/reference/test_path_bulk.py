"""A bulk modulus that relaxes by itself: the plane modulus as a Prony series, and what runs make of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.closed_forms.separate_bulk import equivalent_material

from contact_scene import Branch, BulkRelaxation, Material
from validation.cases import load
from validation.reference.path.solver import DEFAULT_TOLERANCE, solve
from validation.reference.prony_integrals import plane_spectrum

SHEAR = (Branch(1.0, 1.0), Branch(4.0, 30.0))


@pytest.mark.parametrize(
    ("poisson", "branches", "bulk"),
    [
        (0.3, SHEAR, "elastic"),
        (0.2, SHEAR, BulkRelaxation(None, (Branch(1.5, 0.5),))),
        (0.2, SHEAR, BulkRelaxation(7.0, (Branch(1.5, 1.0), Branch(0.3, 1e-6)))),
        (0.5, (), BulkRelaxation(2.0, (Branch(9.0, 1e5),))),
        (0.3, SHEAR, BulkRelaxation(None, tuple(replace(b, modulus=b.modulus / 1.2) for b in SHEAR))),
    ],
)
def test_the_series_is_that_of_shear_and_bulk_at_every_frequency(poisson, branches, bulk):
    material = Material(0.75, poisson, branches, bulk)
    relaxed, moduli, times = plane_spectrum(material)
    own = bulk if isinstance(bulk, BulkRelaxation) else BulkRelaxation()
    volume = own.modulus or 0.75 / (3.0 * (1.0 - 2.0 * poisson))
    assert (np.diff(times) > 0.0).all()
    assert (moduli > 0.0).all()
    for s in np.geomspace(1e-7, 1e8, 16):
        shear = 0.5 * (0.75 + sum(b.modulus * s * b.time / (1.0 + s * b.time) for b in branches))
        shear /= 1.0 + poisson
        three = 3.0 * (volume + sum(b.modulus * s * b.time / (1.0 + s * b.time) for b in own.branches))
        expected = 1.0 / (1.0 / (4.0 * shear) + 3.0 / (4.0 * (three + shear)))
        assert relaxed + moduli @ (s * times / (1.0 + s * times)) == pytest.approx(expected, rel=1e-12)


def test_bulk_that_relaxes_like_shear_is_a_constant_poisson_ratio():
    alike = BulkRelaxation(None, tuple(replace(b, modulus=b.modulus / 1.2) for b in SHEAR))
    relaxed, moduli, times = plane_spectrum(Material(0.75, 0.3, SHEAR, alike))
    expected = plane_spectrum(Material(0.75, 0.3, SHEAR))
    assert relaxed == pytest.approx(expected[0], rel=1e-13)
    significant = moduli > 1e-13 * moduli.max()
    assert moduli[significant] == pytest.approx(expected[1], rel=1e-12)
    assert times[significant] == pytest.approx(expected[2], rel=1e-12)


def test_a_run_is_that_of_the_closed_form_of_constant_bulk():
    scene = load("bulk-retraction-100nm").scene
    run, same = solve(scene), solve(replace(scene, material=equivalent_material(scene.material)))
    for name in ("time", "force", "stored_energy", "dissipated_energy"):
        assert getattr(run, name)[-2] == pytest.approx(getattr(same, name)[-2], rel=DEFAULT_TOLERANCE)
