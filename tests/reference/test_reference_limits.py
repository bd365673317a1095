"""The solvers in the limits where a closed form answers, each closed form used at least once."""

from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from support.closed_forms import hertz, lee_radok, punch
from support.closed_forms.maugis_dugdale import MaugisDugdale
from support.paper_scenes import ELASTIC, ONE, PULL, STICKY, THREE, WORK, ZONE

import bem_solver
from contact_scene import (
    Adhesion,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
    TabulatedProfile,
)
from validation.reference import jkr, punch_oscillation, sneddon
from validation.reference import path as reference
from validation.reference.finite_zone import FiniteZone
from validation.reference.frozen import FrozenRetraction
from validation.reference.ting import Ting

GRID = np.linspace(0.0, 1.0, 21)
TABLE = TabulatedProfile(tuple(GRID), tuple(0.5 * GRID**2 + GRID**4))
PUNCH = FlatPunch(0.2)
POWERS = [Sphere(1.0), Cone(80.0), PowerLaw(1.5, 0.5), PowerLaw(3.0, 1.5)]
# Solver and the relative error it may have at its default settings in smooth elastic states.
SOLVERS = [pytest.param(reference, 1e-8, id="front-tracking"), pytest.param(bem_solver, 2e-5, id="bem")]
solvers = pytest.mark.parametrize(("solver", "accuracy"), SOLVERS)


def shapes(*indenters, slow=()):
    return pytest.mark.parametrize(
        "indenter",
        [
            pytest.param(shape, id=f"{shape.shape}-{i}", marks=[pytest.mark.slow] if shape in slow else [])
            for i, shape in enumerate(indenters)
        ],
    )


@solvers
@shapes(*POWERS, TABLE)
def test_adhesionless_elastic_contact_is_sneddons(solver, accuracy, indenter):
    scene = Scene(ELASTIC, indenter, Loading("relaxed", 0.03, (Hold(0.1),)))
    trace = solver.solve(scene, solver.Options(profile_times=(0.05,)))
    a = sneddon.contact_radius(indenter, 0.03)
    assert_allclose(trace.contact_radius, a, rtol=accuracy)
    assert_allclose(trace.force, sneddon.force(indenter, a, 1.0), rtol=accuracy)
    (profile,) = trace.profiles
    if indenter == Sphere(1.0):
        outside = hertz.displacement(profile.radius, a, 1.0)
        assert_allclose(profile.displacement, outside, atol=max(accuracy, 1e-5) * 0.03)
        well_inside = profile.radius < 0.9 * a
        pressure = hertz.pressure(profile.radius[well_inside], a, 1.0, 1.0)
        assert_allclose(profile.pressure[well_inside], pressure, rtol=max(50 * accuracy, 1e-3))


@solvers
@shapes(*POWERS)
def test_adhesive_equilibrium_tends_to_jkr_with_the_process_zone(solver, accuracy, indenter):
    exact = jkr.JKR(indenter, 1.0, WORK).at_penetration(0.03)
    radii, forces = [], []
    for zone in (2e-3, 1e-3):
        scene = Scene(ELASTIC, indenter, Loading("relaxed", 0.03), Adhesion(WORK, zone))
        trace = solver.solve(scene)
        radii.append(trace.contact_radius[0] / exact.contact_radius - 1)
        forces.append(trace.force[0] / exact.force - 1)
    # What is left after taking out the first order in the zone is of second order.
    for errors in (radii, forces):
        assert abs(errors[1]) < 1e-2
        assert_allclose(errors[0] / errors[1], 2.0, rtol=0.06)
        assert abs(2 * errors[1] - errors[0]) < 3e-4


@cache
def dugdale_with_ring(plane_modulus, width):
    """Maugis's sphere whose adhesive ring is ``width`` wide at its pull-off."""

    def contact(strength):
        return MaugisDugdale(1.0, plane_modulus, WORK, strength)

    def excess(strength):
        radii = contact(strength).radius_unit * np.linspace(0.5, 1.4, 91)
        a = radii[int(np.argmin([contact(strength).force(a) for a in radii]))]
        return a * (contact(strength).ring_ratio(a) - 1) - width

    return contact(brentq(excess, 1e-2, 1e2, rtol=1e-3))


@pytest.mark.parametrize("modulus", [0.75, pytest.param(7.5, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("solver", "accuracy"),
    [pytest.param(reference, 1e-6, id="front-tracking"), pytest.param(bem_solver, 1e-3, id="bem")],
)
def test_elastic_pull_off_is_that_of_the_finite_zone(solver, accuracy, modulus):
    """And a Dugdale ring as long as the process zone has two thirds of its excess over JKR."""
    exact = FiniteZone(1.0, modulus / 0.75, WORK, ZONE)
    scene = Scene(
        Material(modulus, 0.5),
        Sphere(1.0),
        Loading("relaxed", 0.01, (Ramp(-0.05, 0.01),)),
        STICKY,
    )
    trace = solver.solve(scene, solver.Options(resolution=8))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert_allclose(trace.force[0], exact.at_penetration(0.01).force, rtol=accuracy)
    assert_allclose(trace.force.min(), exact.pull_off_force_control().force, rtol=accuracy)
    lost = exact.pull_off_penetration_control().penetration
    assert_allclose(trace.outcome.time, (0.01 - lost) / 0.01, rtol=accuracy)

    ring = dugdale_with_ring(modulus / 0.75, 0.013)
    assert 1.3 < (-trace.force.min() / PULL - 1) / (ring.pull_off_force() / PULL - 1) < 1.6


def test_elastic_punch_lets_go_at_kendalls_force():
    excess = []
    for zone in (8e-3, 4e-3):
        scene = Scene(ELASTIC, PUNCH, Loading("relaxed", 0.0, (Ramp(-0.5, 1e-3),)), Adhesion(WORK, zone))
        trace = reference.solve(scene, reference.Options(resolution=6))
        excess.append(-trace.force.min() / punch.pull_off_force(0.2, 1.0, WORK) - 1)
    assert 0.0 < excess[1] < 3e-3
    assert_allclose(excess[0] / excess[1], 2.0, rtol=0.02)


@pytest.mark.slow
def test_viscoelastic_punch_lets_go_between_its_bounds():
    slow, fast = punch.viscoelastic_bounds(ONE, 0.2, WORK)
    forces = []
    for rate in (1e-5, 1e-2, 1e1):
        scene = Scene(ONE, PUNCH, Loading("relaxed", 0.0, (Ramp(-0.5, rate),)), Adhesion(WORK, 8e-3))
        forces.append(-reference.solve(scene, reference.Options(resolution=4)).force.min())
    assert np.all(np.diff(forces) > 0)
    assert 0.0 < forces[0] / slow - 1 < 0.025
    assert_allclose(forces[-1] / fast, 1.0, atol=6e-3)  # the excess of the elastic punch at this zone: 0.5 %


@pytest.mark.parametrize(
    ("material", "indenter"),
    [
        pytest.param(ONE, Sphere(1.0), id="one-sphere"),
        pytest.param(THREE, Cone(80.0), id="three-cone", marks=pytest.mark.slow),
        pytest.param(ONE, TABLE, id="one-profile", marks=pytest.mark.slow),
        pytest.param(ONE, Cone(80.0), id="one-cone", marks=pytest.mark.exhaustive),
        pytest.param(THREE, Sphere(1.0), id="three-sphere", marks=pytest.mark.exhaustive),
        pytest.param(THREE, TABLE, id="three-profile", marks=pytest.mark.exhaustive),
    ],
)
def test_adhesionless_cycle_is_lee_radoks_and_tings(material, indenter):
    scene = Scene(
        material, indenter, Loading("relaxed", 0.0, (Ramp(0.04, 0.05), Hold(0.2), Ramp(-0.05, 0.08)))
    )
    exact = Ting(material, indenter, 0.05, 0.8, 0.08, 0.2)
    trace = reference.solve(scene)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert_allclose(trace.outcome.time, exact.detachment(), rtol=1e-6)
    time, radius, force = trace.time[::50], trace.contact_radius[::50], trace.force[::50]
    assert_allclose(force, exact.force(time), atol=2e-6 * force.max())
    # The radius vanishes as a root of the time both at first touch and at the end.
    middle = (time > 0.01) & (time < 0.99 * exact.detachment())
    assert_allclose(radius[middle], exact.contact_radius(time[middle]), atol=1e-5 * radius.max())
    growing = (time > 0.0) & (time <= 0.8)
    assert np.count_nonzero(growing) >= 5
    _, loading = lee_radok.ramp(material, indenter, 0.05, time[growing])
    assert_allclose(force[growing], loading, atol=2e-6 * force.max())


@shapes(Sphere(1.0), Cone(80.0), TABLE, slow=(Cone(80.0), TABLE))
def test_creep_under_a_growing_force_is_the_dual_of_lee_radok(indenter):
    preload = float(sneddon.force(indenter, sneddon.contact_radius(indenter, 0.01), 1.0))
    steps = (ForceRamp(10 * preload, 2 * preload),)
    trace = reference.solve(Scene(THREE, indenter, Loading("relaxed", 0.01, steps)))
    expected = lee_radok.radius_under_force_ramp(THREE, indenter, 2 * preload, trace.time, preload)
    assert_allclose(trace.contact_radius, expected, rtol=1e-5)


@shapes(Sphere(1.0), Cone(80.0), TABLE, slow=(Cone(80.0), TABLE))
def test_creep_under_a_dead_load_is_the_dual_of_lee_radok(indenter):
    preload = float(sneddon.force(indenter, sneddon.contact_radius(indenter, 0.01), 1.0))
    steps = (Force(3 * preload, 4.0),)
    trace = reference.solve(Scene(THREE, indenter, Loading("relaxed", 0.01, steps)))
    after = trace.time > 0.0
    expected = lee_radok.radius_under_force_step(THREE, indenter, 2 * preload, trace.time[after], preload)
    # The glassy jump itself costs the front tracking up to 6e-4 of the radius (cone).
    assert_allclose(trace.contact_radius[after], expected, rtol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("zone", [4e-3, 1e-3])
def test_fast_retraction_tends_to_the_frozen_limit(zone):
    exact = FrozenRetraction(ONE, Sphere(1.0), WORK, 0.032)
    scene = Scene(ONE, Sphere(1.0), Loading("relaxed", 0.032, (Ramp(-0.5, 1e3),)), Adhesion(WORK, zone))
    trace = reference.solve(scene, reference.Options(resolution=4))
    pull = exact.pull_off()
    assert_allclose(trace.force.min(), pull.force, rtol=0.6 * zone)
    best = int(np.argmin(trace.force))
    assert_allclose(trace.penetration[best], pull.penetration, atol=0.06 * zone)
    # While frozen: the straight line of slope 2 a_B Einf*, but for an edge that recedes by up to one zone.
    frozen = trace.penetration > pull.penetration + 0.003
    line = exact.force_while_frozen(trace.penetration[frozen])
    assert_allclose(
        trace.force[frozen] - trace.force[0], line - exact.relaxed.force, rtol=6.0 * zone, atol=1e-12
    )


@pytest.mark.slow
@shapes(Cone(80.0), PowerLaw(3.0, 1.5))
def test_fast_retraction_of_other_shapes_tends_to_the_frozen_limit(indenter):
    scene = Scene(ONE, indenter, Loading("relaxed", 0.032, (Ramp(-0.5, 1e3),)), Adhesion(WORK, 2e-3))
    exact = FrozenRetraction(ONE, indenter, WORK, 0.032).pull_off()
    assert_allclose(reference.solve(scene).force.min(), exact.force, rtol=0.012)


def test_oscillating_punch_is_one_linear_element():
    scene = Scene(THREE, PUNCH, Loading("relaxed", 0.01, (Oscillate(1e-3, 2.0, 12.0),)))
    trace = reference.solve(scene)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    expected = 0.4 * 0.01 + punch_oscillation.force(THREE, 0.2, 2.0, 1e-3, trace.time)
    assert_allclose(trace.force, expected, rtol=2e-5)  # rows between steps are interpolated
    assert_allclose(trace.contact_radius, 0.2, rtol=1e-15)
