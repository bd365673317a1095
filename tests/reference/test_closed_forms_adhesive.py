"""Frozen retraction and the finite process zone: check values, limits, both branches of the frozen law."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.closed_forms import punch
from support.paper_scenes import ONE, PULL, WORK, ZONE

from contact_scene import Cone, FlatPunch, Material, PowerLaw, Sphere, TabulatedProfile
from validation.reference import jkr, sneddon
from validation.reference.finite_zone import FiniteZone
from validation.reference.frozen import FrozenRetraction


def test_frozen_check_values():
    case = FrozenRetraction(ONE, Sphere(1.0), WORK, 0.032)
    assert_allclose(case.relaxed.contact_radius, 0.2445, atol=5e-5)
    assert_allclose(case.relaxed.force / np.pi, 1.879e-3, atol=5e-7)
    assert_allclose(-case.pull_off().force / PULL, 9.9138, atol=5e-5)
    # a_B falls short of (9 pi dg R^2 Einf/(8 E0* E0))^(1/3), so the edge never gets to the plateau.
    assert case.pull_off() == case.release()


def test_frozen_plateau_is_the_ratio_of_moduli():
    least = np.cbrt(9 * np.pi * WORK * 10.0 / 8.0)
    for start in (0.05, 0.08):
        case = FrozenRetraction(ONE, Sphere(1.0), WORK, start)
        assert case.relaxed.contact_radius > least
        assert_allclose(case.pull_off().contact_radius, least, rtol=1e-12)
        assert_allclose(-case.pull_off().force / PULL, 10.0, rtol=1e-12)


@pytest.mark.parametrize("indenter", [Sphere(1.0), Cone(80.0), PowerLaw(1.5, 0.4), FlatPunch(0.2)])
def test_frozen_line_meets_the_release_branch(indenter):
    case = FrozenRetraction(ONE, indenter, WORK, 0.03)
    release = case.release()
    assert_allclose(case.force_while_frozen(release.penetration), release.force, rtol=1e-12)
    assert_allclose(case.force_while_frozen(0.03), case.relaxed.force, rtol=1e-14)
    a = release.contact_radius
    # Griffith with the glassy modulus, from the transform at the edge.
    edge = 1.0 * (0.03 - float(sneddon.depth(indenter, a))) + 10.0 * (release.penetration - 0.03)
    assert_allclose(edge**2 / (np.pi * a) / 20.0, WORK, rtol=1e-11)


def test_frozen_elastic_material_is_jkr():
    elastic = Material(0.75, 0.5)
    law = jkr.JKR(Sphere(1.0), 1.0, WORK)
    case = FrozenRetraction(elastic, Sphere(1.0), WORK, 0.032)
    a = np.linspace(0.05, case.relaxed.contact_radius, 7)
    assert_allclose(case.force(a), law.force(a), rtol=1e-12)
    assert_allclose(case.penetration(a), law.penetration(a), rtol=1e-11, atol=1e-15)
    assert_allclose(case.pull_off().force, -PULL, rtol=1e-12)


def test_frozen_punch_is_kendall_with_what_is_stored():
    """Pulled from zero penetration there is nothing stored: Kendall's fast bound."""
    case = FrozenRetraction(ONE, FlatPunch(0.2), WORK, 0.0)
    assert_allclose(-case.pull_off().force, punch.viscoelastic_bounds(ONE, 0.2, WORK)[1], rtol=1e-12)


@pytest.mark.parametrize("start", [0.032, 0.08])
def test_frozen_table_follows_the_sphere_it_samples(start):
    radii = np.linspace(0.0, 0.6, 301)
    sampled = TabulatedProfile(tuple(radii), tuple(0.5 * radii**2))
    exact = FrozenRetraction(ONE, Sphere(1.0), WORK, start).pull_off()
    got = FrozenRetraction(ONE, sampled, WORK, start).pull_off()
    assert_allclose(got.force, exact.force, rtol=1e-5)
    assert_allclose(got.contact_radius, exact.contact_radius, rtol=1e-3)


def test_frozen_needs_a_relaxed_contact():
    radii = np.linspace(0.0, 0.6, 61)
    for indenter in (Sphere(1.0), TabulatedProfile(tuple(radii), tuple(0.5 * radii**2))):
        with pytest.raises(jkr.NoEquilibrium):
            FrozenRetraction(ONE, indenter, WORK, -0.1).pull_off()


@pytest.mark.parametrize(("modulus", "enhancement"), [(1.0, 1.02693), (10.0, 1.05837)])
def test_finite_zone_check_values(modulus, enhancement):
    case = FiniteZone(1.0, modulus, WORK, ZONE)
    assert_allclose(-case.pull_off_force_control().force / PULL, enhancement, atol=5e-6)


def test_finite_zone_relaxed_equilibrium():
    state = FiniteZone(1.0, 1.0, WORK, ZONE).at_penetration(0.032)
    assert_allclose(state.contact_radius, 0.245149, atol=5e-7)
    # The force is a function of a and D alone, whatever the closure: 2 E* (a D - a^3/(3R)).
    assert_allclose(state.force / np.pi, 1.86770e-3, atol=5e-9)


def test_finite_zone_closure_is_the_integral_it_claims():
    case, a, depth = FiniteZone(0.8, 2.0, WORK, 0.02), 0.15, 0.01
    shape = Sphere(0.8)
    stretch = a**2 / 0.8 - depth

    def transform(x):
        return depth - x**2 / 0.8

    def gap(r):
        lifted = quad(lambda b: transform(r * np.sin(b)), 0, np.arcsin(a / r), epsrel=1e-12)[0]
        return float(shape.height(r)) - depth + 2 / np.pi * lifted

    def tension(r):
        return 2.0 * stretch / (np.pi * np.sqrt(a**2 - r**2)) - float(sneddon.pressure(shape, r, a, 2.0))

    def integrand(angle):  # r = a - 0.02 sin^2 lifts both square roots
        r = a - 0.02 * np.sin(angle) ** 2
        return tension(r) * gap(r + 0.02) * 0.04 * np.sin(angle) * np.cos(angle)

    direct = quad(integrand, 1e-6, np.pi / 2, epsabs=0.0, epsrel=1e-9)[0] / 0.04
    assert_allclose(case.closure(a, depth), direct, rtol=1e-5)


def test_finite_zone_vanishing_is_jkr_at_first_order():
    law = jkr.JKR(Sphere(1.0), 1.0, WORK)
    biases = [
        FiniteZone(1.0, 1.0, WORK, zone).energy_release_rate(0.2) / WORK - 1 for zone in (4e-3, 2e-3, 1e-3)
    ]
    order = -np.diff(np.log2(biases))
    assert 1.0 < order[1] < order[0] < 1.06
    assert_allclose(biases[-1], 1e-3 / (4.0 * 0.2), rtol=0.04)  # a quarter of the zone over the radius
    state = FiniteZone(1.0, 1.0, WORK, 1e-7).at_penetration(0.032)
    assert_allclose(state.contact_radius, law.at_penetration(0.032).contact_radius, rtol=1e-6)
    with pytest.raises(jkr.NoEquilibrium):
        FiniteZone(1.0, 1.0, WORK, ZONE).at_penetration(-0.02)
