"""Elastic closed forms: Hertz, Sneddon, JKR and Kendall against each other, energies, limits, constants."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.closed_forms import hertz

from contact_scene import (
    Cone,
    FlatPunch,
    PowerLaw,
    Sphere,
    TabulatedProfile,
    UnsupportedScene,
)
from validation.reference import jkr, sneddon

R, MODULUS, WORK = 0.7, 3.0, 2e-3
SHAPES = [Sphere(R), Cone(70.0), PowerLaw(1.0, 0.4), PowerLaw(1.5, 0.3), PowerLaw(4.0, 2.0)]
ids = [f"{s.shape}-{i}" for i, s in enumerate(SHAPES)]


def table(indenter, reach=2.0, points=400):
    radii = np.linspace(0.0, reach, points)
    return TabulatedProfile(tuple(radii), tuple(indenter.height(radii)))


@pytest.mark.parametrize("indenter", SHAPES, ids=ids)
def test_sneddon_transform_is_the_integral_of_the_slope(indenter):
    x = 0.37
    direct = quad(lambda b: x * indenter.slope(x * np.sin(b)), 0, np.pi / 2, epsrel=1e-12)[0]
    assert_allclose(sneddon.depth(indenter, x), direct, rtol=1e-10)
    swept = quad(lambda y: float(sneddon.depth(indenter, y)), 0, x, epsrel=1e-12)[0]
    assert_allclose(sneddon.depth_integral(indenter, x), swept, rtol=1e-9)


def test_sneddon_of_a_sphere_is_hertz():
    a, sphere = np.array([0.01, 0.1, 0.3]), Sphere(R)
    assert_allclose(sneddon.depth(sphere, a), a**2 / R, rtol=1e-14)
    assert_allclose(sneddon.force(sphere, a, MODULUS), 4.0 * MODULUS * a**3 / (3.0 * R), rtol=1e-14)
    r = np.linspace(0.0, 0.3, 7)
    assert_allclose(sneddon.pressure(sphere, r, 0.3, MODULUS), hertz.pressure(r, 0.3, R, MODULUS), atol=1e-15)
    energy = sneddon.stored_energy(sphere, 0.3, 0.3**2 / R, MODULUS)
    assert_allclose(energy, hertz.stored_energy(0.3, R, MODULUS), rtol=1e-13)


def test_sneddon_of_a_cone_has_the_published_force_and_pressure():
    a, cone = 0.3, Cone(65.0)
    slope = 1.0 / np.tan(np.radians(65.0))
    depth = float(sneddon.depth(cone, a))
    assert_allclose(sneddon.force(cone, a, MODULUS), 2.0 * MODULUS * depth**2 / (np.pi * slope), rtol=1e-14)
    r = np.array([0.01, 0.1, 0.29])
    assert_allclose(
        sneddon.pressure(cone, r, a, MODULUS), 0.5 * MODULUS * slope * np.arccosh(a / r), rtol=1e-12
    )


@pytest.mark.parametrize("indenter", SHAPES, ids=ids)
def test_sneddon_pressure_carries_the_force(indenter):
    a = 0.3
    total = quad(
        lambda b: (
            2 * np.pi * a**2 * np.sin(b) * np.cos(b) * sneddon.pressure(indenter, a * np.sin(b), a, MODULUS)
        ),
        0,
        np.pi / 2,
        epsrel=1e-11,
    )[0]
    assert_allclose(total, sneddon.force(indenter, a, MODULUS), rtol=1e-9)


@pytest.mark.parametrize("indenter", SHAPES, ids=ids)
def test_a_tabulated_profile_converges_to_the_shape_it_samples(indenter):
    x = 0.8123
    errors = [
        abs(float(sneddon.depth(table(indenter, points=n), x) / sneddon.depth(indenter, x)) - 1)
        for n in (41, 161)
    ]
    assert errors[1] <= max(errors[0] / 8.0, 1e-14)
    assert errors[1] < 1e-3
    fine = table(indenter, points=161)
    ends = [r for r in fine.radii if r < x] + [x]
    swept = sum(quad(lambda y: float(sneddon.depth(fine, y)), a, b)[0] for a, b in pairwise(ends))
    assert_allclose(sneddon.depth_integral(fine, x), swept, rtol=1e-9)
    depth = float(sneddon.depth(fine, x))
    assert_allclose(sneddon.contact_radius(fine, depth), x, rtol=1e-12)


@pytest.mark.parametrize("times", [2.9, 3.1, 1e3, 1e6])
def test_far_from_a_kinked_table_its_transform_is_as_exact_as_near(times):
    """At a million of its radii ``G`` was twice as large, ``H`` 2,800 times: what rows add cancels."""
    radii, heights = np.array([0.0, 1e-5, 2e-5, 1e-4]), (0.0, 1e-6, 1.2e-5, 2e-5)
    tip = TabulatedProfile(tuple(radii), heights)
    points, weights = np.polynomial.legendre.leggauss(40)
    width, x = np.diff(radii)[:, None], times * radii[-1]
    r = radii[:-1, None] + 0.5 * width * (1.0 + points)
    rise = 0.5 * width * weights * tip.slope(r)
    assert_allclose(sneddon.depth(tip, x), (rise / np.sqrt(1.0 - (r / x) ** 2)).sum(), rtol=1e-9)
    assert_allclose(sneddon.depth_integral(tip, x), (rise * np.sqrt(x**2 - r**2)).sum(), rtol=1e-9)


@pytest.mark.parametrize("indenter", SHAPES, ids=ids)
def test_round_trips(indenter):
    law = jkr.JKR(indenter, MODULUS, WORK)
    assert_allclose(sneddon.contact_radius(indenter, float(sneddon.depth(indenter, 0.2))), 0.2, rtol=1e-13)
    low = law.pull_off_force_control().contact_radius
    for a in (1.01 * low, 3.0 * low):
        state = law.state(a)
        assert_allclose(law.at_penetration(state.penetration).contact_radius, a, rtol=1e-10)
        assert_allclose(law.at_force(state.force).contact_radius, a, rtol=1e-8)
        assert_allclose(law.energy_release_rate(a, state.penetration), WORK, rtol=1e-12)
        assert_allclose(law.energy_release_rate_from_force(a, state.force), WORK, rtol=1e-12)


@pytest.mark.parametrize("indenter", [*SHAPES, table(Sphere(R)), FlatPunch(0.3)], ids=[*ids, "table", "flat"])
def test_energy_derivatives_are_force_and_energy_release_rate(indenter):
    a, depth, step = 0.3, 0.05, 1e-5

    def energy(radius, penetration):
        return sneddon.stored_energy(indenter, radius, penetration, MODULUS)

    slope = (energy(a, depth + step) - energy(a, depth - step)) / (2 * step)
    assert_allclose(slope, MODULUS * sneddon.unit_force(indenter, a, depth), rtol=1e-6)
    release = (energy(a + step, depth) - energy(a - step, depth)) / (2 * step) / (2 * np.pi * a)
    expected = jkr.JKR(indenter, MODULUS, WORK).energy_release_rate(a, depth)
    assert_allclose(release, expected, rtol=1e-5)
    if isinstance(indenter, FlatPunch):
        assert_allclose(release, MODULUS * depth**2 / (2.0 * np.pi * a), rtol=1e-5)
        assert_allclose(slope, 2.0 * a * MODULUS * depth, rtol=1e-6)


def test_jkr_sphere_constants():
    law = jkr.JKR(Sphere(R), MODULUS, WORK)
    dead, fixed = law.pull_off_force_control(), law.pull_off_penetration_control()
    assert_allclose(dead.force, -1.5 * np.pi * WORK * R, rtol=1e-13)
    assert_allclose(dead.contact_radius, np.cbrt(9 * np.pi * WORK * R**2 / (8 * MODULUS)), rtol=1e-13)
    assert_allclose(fixed.force, -5.0 / 6.0 * np.pi * WORK * R, rtol=1e-13)
    assert_allclose(fixed.penetration, -0.75 * np.cbrt(np.pi**2 * WORK**2 * R / MODULUS**2), rtol=1e-13)
    assert_allclose(
        law.at_force(0.0).contact_radius, np.cbrt(9 * np.pi * WORK * R**2 / (2 * MODULUS)), rtol=1e-12
    )
    # K.L. Johnson et al.: a^3 = (3R/4E*) [F + 3 pi dg R + sqrt(6 pi dg R F + (3 pi dg R)^2)]
    load, pull = 0.02, 3 * np.pi * WORK * R
    cube = 3 * R / (4 * MODULUS) * (load + pull + np.sqrt(2 * pull * load + pull**2))
    assert_allclose(law.at_force(load).contact_radius, np.cbrt(cube), rtol=1e-12)


def test_jkr_cone_pull_off_is_that_of_maugis_and_barquins():
    half_angle = 75.0
    dead = jkr.JKR(Cone(half_angle), MODULUS, WORK).pull_off_force_control()
    tangent = np.tan(np.radians(half_angle))
    assert_allclose(dead.force, -54.0 * WORK**2 * tangent**3 / (np.pi * MODULUS), rtol=1e-12)


@pytest.mark.parametrize("indenter", SHAPES, ids=ids)
def test_pull_off_states_are_the_extremes_of_the_curves(indenter):
    law = jkr.JKR(indenter, MODULUS, WORK)
    for curve, state, value in (
        (law.force, law.pull_off_force_control(), "force"),
        (law.penetration, law.pull_off_penetration_control(), "penetration"),
    ):
        a = state.contact_radius * np.linspace(0.5, 2.0, 601)
        assert np.min(curve(a)) >= getattr(state, value) * (1 + 1e-14)
        assert_allclose(np.min(curve(a)), getattr(state, value), rtol=1e-4)
    n = indenter.power[0]
    a = law.pull_off_force_control().contact_radius
    s = np.sqrt(2 * np.pi * WORK / MODULUS)
    expected = -2 * MODULUS * s * a**1.5 * (2 * n - 1) / (2 * n + 2)
    assert_allclose(law.pull_off_force_control().force, expected, rtol=1e-12)
    with pytest.raises(jkr.NoEquilibrium, match="least possible"):
        law.at_force(1.001 * law.pull_off_force_control().force)
    with pytest.raises(jkr.NoEquilibrium, match="least possible"):
        law.at_penetration(1.001 * law.pull_off_penetration_control().penetration)


def test_jkr_of_a_table_has_curves_but_no_closed_pull_off():
    law = jkr.JKR(table(Sphere(R)), MODULUS, WORK)
    exact = jkr.JKR(Sphere(R), MODULUS, WORK)
    assert_allclose(law.force(0.2), exact.force(0.2), rtol=1e-5)
    with pytest.raises(UnsupportedScene, match="no closed form"):
        law.pull_off_force_control()
    with pytest.raises(ValueError, match="no closed form for the pressure"):
        law.pressure(0.1, 0.2)


def test_no_contact_is_refused():
    with pytest.raises(ValueError, match="no adhesionless contact"):
        sneddon.contact_radius(Sphere(R), -1e-3)
