"""A short zone that opens steadily: a law of the rate, or a fixed stress, and the enhancement of the crack.

The scenes' check values worked out again, and every row of every solver against the law.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.closed_forms import fixed_stress

import bem_solver
from benchmarks.steady_edge import relaxed_contact, steady_edge, steady_rows
from contact_scene import (
    Adhesion,
    Hold,
    Loading,
    Material,
    OutcomeKind,
    PowerRate,
    Ramp,
    Scene,
    Sphere,
)
from validation.cases import load
from validation.measure.scaling import unit_sizes
from validation.reference import steady_crack
from validation.reference.rated_edge import RatedEdge
from validation.solvers import SOLVERS

RATED, STRESS = "steady-rate-si", "steady-stress-si"
ACCURACY = {"reference": 5e-4, "bem": 1e-3, "fem": 5e-3}
each_scene = pytest.mark.parametrize("name", [RATED, STRESS])


@each_scene
def test_check_values_are_those_of_the_equation_of_motion(name):
    case = load(name)
    scene, law, motion, units = (
        case.scene,
        relaxed_contact(case.scene),
        steady_edge(case.scene),
        unit_sizes(case.scene),
    )
    depth, step = scene.loading.penetration, scene.loading.steps[0]
    times = np.linspace(0.0, (depth - step.to) / step.rate, 1001)
    start = law.at_penetration(depth).contact_radius
    radius = motion.radii(start, depth, step.rate, times)
    depths = depth - step.rate * times
    force = 2.0 * law.plane_modulus * (radius * depths - radius**3 / (3.0 * scene.indenter.radius))
    release = [float(law.energy_release_rate(a, d)) for a, d in zip(radius, depths, strict=True)]
    taken = np.array([scene.adhesion.opening(motion.speed(g)) for g in release])
    spent = -np.cumsum(0.5 * (taken[1:] + taken[:-1]) * np.pi * np.diff(radius**2))
    last = round(0.96 * (len(times) - 1))
    found = {
        "start_radius": start,
        "pull_off_force": -force.min(),
        "contact_radius": radius[last],
        "separation_energy": spent[last - 1],
        "loop_energy": np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(depths)),
    }
    for check in case.expected:
        assert check.at_time in (None, pytest.approx(times[last]))
        assert check.value * units[check.unit] == pytest.approx(found.pop(check.observable), rel=2e-5)
    assert found == {}


@each_scene
def test_the_speed_is_the_one_at_which_so_much_is_taken(name):
    scene = load(name).scene
    motion, work, zone = steady_edge(scene), scene.adhesion.work, scene.adhesion.zone
    for release in work * np.array([1.1, 2.0, 5.0]):
        speed = motion.speed(release)
        taken = scene.adhesion.opening(speed)
        if scene.adhesion.stress is None:
            closed = steady_crack.opening(scene.material, zone, speed)
        else:
            closed = fixed_stress.opening(scene.material, zone * taken / work, speed)
        assert release == pytest.approx(taken * float(closed), rel=1e-9)
    assert motion.speed(work) == 0.0


def test_without_a_rate_nothing_takes_more_than_a_glassy_edge():
    motion = steady_edge(load(STRESS).scene)
    assert motion.speed(9.999 * motion.adhesion.work) > 1e3 * motion.speed(9.0 * motion.adhesion.work)
    assert motion.speed(10.001 * motion.adhesion.work) == np.inf


def test_a_half_space_that_relaxes_at_once_leaves_the_law_of_the_rate():
    scene = load(RATED).scene
    quick = replace(scene.material, branches=tuple(replace(b, time=1e-12) for b in scene.material.branches))
    edge = steady_edge(scene)
    motion, elastic = replace(edge, material=quick), RatedEdge(scene.adhesion, edge.release_rate)
    for release in (0.6, 0.8):
        assert motion.speed(release) == pytest.approx(elastic.speed(release), rel=1e-6)


def assert_law_holds(scene, trace, accuracy):
    """The energy release rate of every steady row is the law at the speed of the row."""
    rows = steady_rows(scene, trace)
    assert len(rows.speed) > 5
    assert_allclose(rows.release_rate, rows.law, rtol=accuracy)
    assert rows.enhancement.min() > 1.5
    return rows.law / rows.enhancement / scene.adhesion.work


@pytest.mark.slow
@pytest.mark.parametrize("solver", ACCURACY)
@each_scene
def test_every_row_follows_the_law(solver, name):
    scene = load(name).scene
    assert_law_holds(scene, SOLVERS[solver].solve(scene, None), ACCURACY[solver])


@pytest.mark.slow
def test_boundary_elements_follow_the_law_in_few_steps():
    """Steps over many zones: at a twelfth of a zone each they would be a hundred thousand."""
    scene = load(RATED).scene
    brisk = replace(scene, loading=replace(scene.loading, steps=(Ramp(-1.2e-5, 2e-9),)))
    trace = bem_solver.solve(brisk, bem_solver.Options(resolution=6))
    rate = assert_law_holds(brisk, trace, ACCURACY["bem"])
    assert 1.2 < rate.min() < rate.max() < 1.5
    assert trace.counters.steps < 100
    assert (trace.contact_radius[0] - trace.contact_radius[-1]) / scene.adhesion.zone > 2000.0


def test_a_rated_edge_that_collapses_within_the_rounding_of_time_ends_the_run():
    """After a long rest the time tells no steps short enough for the last of the collapse."""
    adhesion = Adhesion(5e-4, 1e-3, None, PowerRate(1e-2, 0.4))
    loading = Loading("relaxed", 0.01, (Hold(1e11), Ramp(-1.0, 1e-2)))
    scene = Scene(Material(0.75, 0.5), Sphere(1.0), loading, adhesion)
    trace = bem_solver.solve(scene, bem_solver.Options(resolution=4, max_steps=1000))
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert np.all(np.diff(trace.contact_radius)[-50:] < 0.0)
    assert trace.contact_radius[-1] == pytest.approx(adhesion.zone)
