"""The mesh that follows the edge where bulk relaxes apart from shear: the modulus of the surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from support.closed_forms.separate_bulk import equivalent_material
from support.paper_scenes import WORK

import fem_solver
from contact_scene import Adhesion, Branch, BulkRelaxation, Loading, Material, Ramp, Scene, Sphere
from fem_solver.moduli import OneModulus, Prony, moduli
from fem_solver.volume import RelaxingField
from validation.solvers.finite_elements import FiniteElements
from validation.solvers.front_tracking import FrontTracking

BULK = BulkRelaxation(2.0, (Branch(5.0, 0.7), Branch(1.0, 40.0)))
APART = Material(0.75, 0.2, (Branch(4.0, 0.3), Branch(2.0, 3.0)), "elastic")
PULLED = Scene(APART, Sphere(1.0), Loading("relaxed", 0.02, (Ramp(0.015, 0.02),)), Adhesion(WORK, 2e-6))


def relaxing():
    part = st.tuples(st.floats(0.01, 100.0), st.floats(-3.0, 3.0))
    return st.builds(
        lambda relaxed, parts: Prony(
            relaxed,
            np.array([modulus for modulus, _ in parts]),
            10.0 ** np.array([decade for _, decade in parts]),
        ),
        st.floats(0.01, 100.0),
        st.lists(part, min_size=1, max_size=4),
    )


def complex_modulus(modulus, frequency):
    turns = 1j * frequency[:, None] * modulus.times
    return modulus.relaxed + (modulus.moduli * turns / (1.0 + turns)).sum(axis=1)


@settings(deadline=None, max_examples=60)
@given(relaxing(), relaxing())
def test_compliances_of_moduli_in_series_add_up(one, other):
    frequency = np.geomspace(1e-5, 1e5, 41)
    found = OneModulus(one, other).modulus
    compliance = 1.0 / complex_modulus(one, frequency) + 1.0 / complex_modulus(other, frequency)
    assert_allclose(complex_modulus(found, frequency) * compliance, 1.0, rtol=0.0, atol=1e-9)
    assert (found.moduli > 0.0).all()
    assert (found.times > 0.0).all()


def stored(part):
    springs = np.sum(part.branches**2 / part.modulus.moduli[:, None], axis=0)
    return 0.5 * (part.modulus.relaxed * part.x**2 + springs)


def test_energies_of_moduli_in_series_are_those_of_both():
    """Through jumps and ramps of the strain, the stored energy and with it the loss."""
    one, other = (
        Prony(1.0, np.array([2.0, 3.0]), np.array([0.1, 1.0])),
        Prony(0.5, np.array([4.0, 1.0]), np.array([0.1, 7.0])),
    )
    combined = OneModulus(one, other)
    joined = combined.modulus
    parts, whole = (
        [RelaxingField.at_rest(modulus, 1) for modulus in (one, other)],
        RelaxingField.at_rest(joined, 1),
    )
    depth, rates = 0.3, (1.0, -2.0, 0.0, 0.5)
    for dt, target in ((0.0, depth), *((1e-3, None) for _ in range(800))):
        if target is None:
            depth += rates[round(10.0 * abs(depth)) % 4] * dt
        (first, second), moduli_now = (
            (part.memory(dt) for part in parts),
            (m.increment(dt).modulus for m in (one, other)),
        )
        stiff, soft = moduli_now  # both bear the same stress, and share the depth
        share = (soft * depth + second - first) / (stiff + soft)
        parts = [part.advanced(dt, x) for part, x in zip(parts, (share, depth - share), strict=True)]
        whole = whole.advanced(dt, np.full(1, depth))
        assert_allclose(stored(whole), sum(stored(part) for part in parts), rtol=1e-4)
    strained = combined.parts(whole.x, whole.branches)
    for found, modulus, part in zip(strained, (one, other), parts, strict=True):
        assert_allclose(found.whole, part.x, rtol=1e-4)
        assert_allclose(found.springs * modulus.moduli[:, None], part.branches, rtol=1e-3, atol=1e-4)


@pytest.mark.parametrize("bulk", ["elastic", BULK], ids=["elastic", "relaxing"])
def test_the_surface_has_one_modulus(bulk):
    """``1/E* = 1/(4 G) + 3/(4 (3 K + G))`` at every frequency, in units of the glassy solid's."""
    material = moduli(replace(APART, bulk=bulk))
    frequency = np.geomspace(1e-4, 1e4, 33)
    shear, volume = (complex_modulus(one, frequency) for one in (material.shear, material.bulk))
    plane = material.unit_plane_modulus * complex_modulus(material.surface, frequency)
    assert_allclose(plane * (0.25 / shear + 0.75 / (3.0 * volume + shear)), 1.0, rtol=0.0, atol=1e-10)
    assert material.surface.glassy == pytest.approx(material.shear.glassy, rel=1e-12)
    assert moduli(replace(APART, bulk=None)).surface is not None


@pytest.mark.slow
def test_a_zone_of_a_hundred_thousandth_of_the_contact_is_that_of_front_tracking():
    scene = PULLED
    found = fem_solver.solve(scene, FiniteElements().mesh(scene, 6), fem_solver.Options())
    exact = FrontTracking().solve(replace(scene, material=equivalent_material(APART)))
    for name, allowed in (("force", 1e-3), ("contact_radius", 5e-4), ("stored_energy", 1e-3)):
        ends = found.columns()[name][-1], exact.columns()[name][-1]
        assert ends[0] == pytest.approx(ends[1], rel=allowed), name
    assert found.columns()["branch_dissipation"][-1] == pytest.approx(
        exact.columns()["dissipated_energy"][-1], rel=5e-3
    )
