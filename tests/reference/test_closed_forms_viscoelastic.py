"""Adhesionless viscoelastic closed forms: Lee-Radok, Ting, the oscillating punch, and Prony averages."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad, solve_ivp
from support.closed_forms.separate_bulk import equivalent_material
from support.paper_scenes import ONE

from contact_scene import (
    Branch,
    BulkRelaxation,
    Cone,
    FlatPunch,
    Material,
    PowerLaw,
    Sphere,
    TabulatedProfile,
)
from validation.reference import prony_integrals, punch_oscillation, sneddon
from validation.reference.ting import Ting

WIDE = Material(
    1.2, 0.3, (Branch(3.0, 1e-3), Branch(2.0, 0.1), Branch(0.5, 0.7), Branch(4.0, 30.0), Branch(1.0, 1e5))
)
ELASTIC = Material(2.0, 0.4)
TABLE = TabulatedProfile(
    tuple(np.linspace(0, 1, 13)), tuple(0.5 * np.linspace(0, 1, 13) ** 2 + np.linspace(0, 1, 13) ** 4)
)
SHAPES = [Sphere(1.0), Cone(80.0), PowerLaw(3.0, 1.5), FlatPunch(0.2), TABLE]
shapes = pytest.mark.parametrize("indenter", SHAPES, ids=lambda s: s.shape)
shapes_table_slow = pytest.mark.parametrize(
    "indenter",
    [*SHAPES[:-1], pytest.param(TABLE, marks=pytest.mark.slow)],
    ids=lambda s: s.shape,
)
materials = pytest.mark.parametrize("material", [ONE, WIDE, ELASTIC], ids=["one", "five", "elastic"])


@materials
@pytest.mark.parametrize("time", [1e-6, 1e-2, 1.0, 1e3])
def test_prony_averages(material, time):
    edges = np.concatenate([[0.0], np.geomspace(1e-9, 1.0, 40) * time])
    for function, mean, integral in (
        (prony_integrals.relaxation, prony_integrals.mean_relaxation, prony_integrals.relaxation_integral),
        (prony_integrals.creep, prony_integrals.mean_creep, prony_integrals.creep_integral),
    ):
        pieces = pairwise(edges)
        direct = sum(quad(lambda s: float(function(material, s)), a, b)[0] for a, b in pieces)  # noqa: B023
        assert_allclose(integral(material, time), direct, rtol=1e-11)
        assert_allclose(mean(material, time), direct / time, rtol=1e-11)
        assert_allclose(mean(material, 0.0), function(material, 0.0), rtol=1e-14)
        assert_allclose(mean(material, np.inf), function(material, 1e12), rtol=1e-12)


def test_a_poisson_ratio_that_varies_enters_by_the_plane_modulus():
    separate = Material(1.0, 0.3, (Branch(1.0, 1.0),), BulkRelaxation(2.0))
    time = np.array([0.5, 1.2])
    force, same = (
        Ting(material, Sphere(1.0), 0.05, 1.0, 0.05).force(time)
        for material in (separate, equivalent_material(separate))
    )
    assert_allclose(force, same, rtol=1e-12)
    assert np.all(force != Ting(replace(separate, bulk=None), Sphere(1.0), 0.05, 1.0, 0.05).force(time))


def test_check_values_of_the_one_branch_cycle():
    cycle = Ting(ONE, Sphere(1.0), 0.05, 1.0, 0.05)
    time = np.array([0.5, 1.0, 1.2710490])
    assert_allclose(cycle.contact_radius(time), [0.1581139, 0.2236068, 0.1795367], atol=5.1e-8)
    assert_allclose(cycle.force(time), [0.04443517, 0.10786683, 0.03680143], atol=5.1e-9)
    assert_allclose(cycle.detachment(), 1.5420981, atol=5.1e-8)
    assert_allclose(cycle.penetration(cycle.detachment()), 0.0228951, atol=5.1e-8)


@pytest.mark.parametrize(
    ("material", "indenter"),
    [
        *((WIDE, one) for one in SHAPES[:-1]),
        (ONE, SHAPES[0]),
        pytest.param(ONE, TABLE, marks=pytest.mark.slow),
    ],
)
def test_a_ramp_is_its_convolution(material, indenter):
    """Lee and Radok (1960), as long as the contact grows."""
    time, rate = 0.9, 0.05
    cycle = Ting(material, indenter, rate, 1.0, rate)
    assert_allclose(cycle.contact_radius(time), sneddon.contact_radius(indenter, rate * time), rtol=1e-13)

    def integrand(s):
        grown = 2.0 * sneddon.contact_radius(indenter, rate * s) * rate
        return float(prony_integrals.relaxation(material, time - s)) * grown

    direct = quad(integrand, 0.0, time, epsabs=0.0, epsrel=1e-11, limit=400)[0]
    assert_allclose(cycle.force(time), direct, rtol=1e-9)


@shapes_table_slow
@pytest.mark.parametrize("hold", [0.0, 0.4])
def test_ting_satisfies_its_two_integrals(indenter, hold):
    cycle = Ting(WIDE, indenter, 0.05, 1.0, 0.08, hold)
    time = 1.0 + hold + 0.3 * (cycle.detachment() - 1.0 - hold)
    first = cycle.arrival(time)
    assert 0.0 < first < 1.0

    def kernel(s):
        return float(prony_integrals.relaxation(WIDE, time - s))

    def integral(function, low, high):
        recent = time - np.geomspace(1.0, 1e-6, 30)
        marks = np.unique([low, *recent[(recent > low) & (recent < high)], high])
        return sum(quad(function, a, b, epsabs=0.0, epsrel=1e-10)[0] for a, b in pairwise(marks))

    rise, fall = integral(kernel, first, 1.0), integral(kernel, 1.0 + hold, time)
    assert_allclose(0.05 * rise, 0.08 * fall, rtol=1e-9)
    direct = integral(lambda s: 2 * 0.05 * sneddon.contact_radius(indenter, 0.05 * s) * kernel(s), 0.0, first)
    if not isinstance(indenter, FlatPunch):  # whose whole face is one point of the transform
        assert_allclose(cycle.force(time), direct, rtol=1e-8)
    assert_allclose(cycle.contact_radius(time), sneddon.contact_radius(indenter, 0.05 * first), rtol=1e-12)


@shapes
def test_ting_force_is_continuous_and_ends_at_zero(indenter):
    cycle = Ting(WIDE, indenter, 0.05, 1.0, 0.08, 0.2)
    before, after = cycle.force([1.2 - 1e-9, 1.2 + 1e-9])
    assert_allclose(before, after, rtol=1e-6)
    end = cycle.detachment()
    peak = float(cycle.force(1.0))
    assert abs(float(cycle.force(end * (1 - 1e-9)))) < 1e-6 * peak
    assert float(cycle.force(end * (1 + 1e-9))) == 0.0
    assert float(cycle.contact_radius(end * (1 + 1e-9))) == 0.0
    assert cycle.penetration(end) > 0.0


@materials
def test_oscillating_punch_is_the_solution_of_its_branch_equations(material):
    radius, frequency, amplitude, end = 0.3, 2.3, 0.01, 1.7
    moduli, times = material.spectrum

    def rates(t, stress):
        return moduli * amplitude * frequency * np.cos(frequency * t) - stress / times

    branches = 0.0
    if len(moduli):
        run = solve_ivp(rates, (0, end), np.zeros(len(moduli)), method="Radau", rtol=1e-10, atol=1e-14)
        branches = run.y[:, -1].sum()
    plane = 1 / (1 - material.poisson**2)
    expected = 2 * radius * plane * (material.modulus * amplitude * np.sin(frequency * end) + branches)
    force = punch_oscillation.force(material, radius, frequency, amplitude, end)
    assert_allclose(force, expected, rtol=1e-7)


def test_oscillating_punch_settles_to_the_complex_modulus():
    radius, frequency, amplitude = 0.3, 2.3, 0.01
    period = 2 * np.pi / frequency
    time = 40.0 + np.linspace(0, period, 2000, endpoint=False)
    force = punch_oscillation.force(ONE, radius, frequency, amplitude, time)
    stiffness = complex(punch_oscillation.dynamic_stiffness(ONE, radius, frequency))
    assert_allclose(force, (stiffness * amplitude * np.exp(1j * frequency * time)).imag, atol=1e-14)
    loss = np.mean(force * amplitude * frequency * np.cos(frequency * time)) * period
    assert_allclose(loss, punch_oscillation.loss_per_cycle(ONE, radius, frequency, amplitude), rtol=1e-12)
    slow, fast = punch_oscillation.dynamic_stiffness(ONE, radius, [1e-9, 1e9])
    assert_allclose([slow, fast], [0.6, 6.0], rtol=1e-7)
