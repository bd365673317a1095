"""A process zone of fixed cohesive stress: elastic closed form, the steady opening edge, three solvers."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.closed_forms import fixed_stress
from support.closed_forms.fixed_stress import FixedStressContact
from support.paper_scenes import ONE, WORK

from contact_scene import (
    Adhesion,
    Branch,
    FlatPunch,
    Loading,
    Machine,
    Material,
    OutcomeKind,
    PowerLaw,
    PowerRate,
    Ramp,
    Scene,
    SceneError,
    Sphere,
)
from validation.reference import steady_crack
from validation.reference.jkr import JKR
from validation.reference.spring import SpringContact
from validation.solvers import SOLVERS

ELASTIC = Material(0.75, 0.5)
"""Plane modulus 1."""
STRESS = 0.2
TOLERANCES = {"reference": 1e-3, "bem": 1e-3, "fem": 5e-3}
ELASTIC_TOLERANCES = {"reference": 1e-9, "bem": 6e-5, "fem": 1.2e-4}
"""Of the radius; of the force twice that. A zone one per cent too short makes 1e-4 in boundary elements,
one two per cent too long 1.7e-4 in finite elements."""
RESOLUTION = {"reference": None, "bem": None, "fem": 6}


def scene(steps, adhesion, start, material=ELASTIC, state="relaxed", indenter=Sphere(1.0)):  # noqa: B008
    return Scene(material, indenter, Loading(state, start, tuple(steps)), adhesion)


def solved(solver, asked):
    return SOLVERS[solver].solve(asked, RESOLUTION[solver])


@pytest.mark.parametrize("solver", TOLERANCES)
def test_an_elastic_contact_has_the_zone_its_tension_asks_for(solver):
    asked = scene([Ramp(0.006, 1e-3)], Adhesion(WORK, stress=STRESS), 0.0)
    trace = solved(solver, asked)
    at_rest = asked.adhesion.zone
    law = FixedStressContact(1.0, 1.0, WORK, 1e-3 * at_rest, STRESS)
    for row, depth in ((0, 0.0), (-1, 0.006)):
        state = law.at_penetration(depth)
        zone = law.zone_at(state.contact_radius, depth)
        assert 0.8 * at_rest < zone < 0.9 * at_rest  # pressure farther inside shortens it
        allowed = ELASTIC_TOLERANCES[solver]
        assert_allclose(trace.contact_radius[row], state.contact_radius, rtol=allowed)
        assert_allclose(trace.force[row], state.force, atol=2.0 * allowed * 1.5 * math.pi * WORK)


@pytest.mark.slow
@pytest.mark.parametrize("solver", TOLERANCES)
def test_it_is_lost_where_the_closed_form_says(solver):
    trace = solved(solver, scene([Ramp(-0.5, 1e-3)], Adhesion(WORK, stress=STRESS), 0.0))
    law = FixedStressContact(1.0, 1.0, WORK, 1e-6, STRESS)
    assert_allclose(-trace.force.min(), -law.pull_off_force_control().force, rtol=TOLERANCES[solver])
    least = law.pull_off_penetration_control().penetration
    assert_allclose(trace.penetration[-1], least, rtol=TOLERANCES[solver])


@pytest.mark.parametrize(
    "solver", ["bem", *(pytest.param(name, marks=pytest.mark.slow) for name in ("reference", "fem"))]
)
def test_on_a_spring_it_is_lost_where_the_stage_is_least(solver):
    """The free state after the snap has no zone, and ends no run as one shorter than it."""
    law, stiffness = FixedStressContact(1.0, 1.0, WORK, 1e-6, STRESS), 0.3
    limit = SpringContact(law, stiffness)
    least = limit.stage(limit.pull_off())
    asked = scene([Ramp(2.0 * least, 1e-2)], Adhesion(WORK, stress=STRESS), 0.0)
    asked = replace(asked, loading=replace(asked.loading, machine=Machine(stiffness)))
    trace = solved(solver, asked)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert_allclose(trace.extra["stage"].min(), least, rtol=TOLERANCES[solver])
    assert_allclose(-trace.force.min(), -law.pull_off_force_control().force, rtol=TOLERANCES[solver])


@pytest.mark.slow
@pytest.mark.parametrize("solver", TOLERANCES)
def test_a_contact_that_its_zone_fills_is_no_place_to_arrest(solver):
    """Elsewhere on the way of the jump the residual rises through zero only where the zone is cut."""
    material = Material(0.75, 0.5, (Branch(0.34, 0.034), Branch(4.3, 84.0)))
    loading = Loading("snap-in", 1.2e-4, (Ramp(0.02, 0.048), Ramp(-0.08, 0.033)))
    trace = solved(solver, Scene(material, PowerLaw(6.86, 1260.0), loading, Adhesion(4.3e-4, stress=0.101)))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.contact_radius[trace.contact_radius > 0.0].min() > 0.097


def test_a_large_stress_is_jkr_and_the_zone_that_of_dugdale():
    law = FixedStressContact(1.0, 1.0, WORK, 1e-9, 10.0)
    state, sharp = law.at_penetration(0.01), JKR(Sphere(1.0), 1.0, WORK).at_penetration(0.01)
    assert_allclose(state.force, sharp.force, rtol=2e-3)
    zone = law.zone_at(state.contact_radius, 0.01)
    assert_allclose(zone, math.pi * WORK / (4.0 * 10.0**2), rtol=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("law", [None, PowerRate(1e-4, 0.5)], ids=["fixed work", "rated"])
def test_the_steady_edge_opens_as_the_closed_law_at_fixed_stress(law):
    """The zone is so short that nothing but the edge sees it; with a rate law the enhancements multiply."""
    zone = 5e-5
    stress = math.sqrt(math.pi * WORK / (4.0 * zone))
    adhesion = Adhesion(WORK, stress=stress, rate=law)
    trace = solved("reference", scene([Ramp(0.05, 1e-5)], adhesion, 0.25, ONE))
    radius = trace.contact_radius
    rows = [int(np.argmin(np.abs(radius - a))) for a in np.linspace(0.75, 0.9, 4) * radius[0]]
    speed = np.abs(np.gradient(radius, trace.time))[rows]
    taken = np.array([adhesion.opening(v) for v in speed]) / WORK
    release = JKR(Sphere(1.0), 1.0, WORK).energy_release_rate_from_force(radius, trace.force)[rows] / WORK
    closed = [w * float(fixed_stress.opening(ONE, zone * w, v)) for w, v in zip(taken, speed, strict=True)]
    assert_allclose(release, closed, rtol=1.5e-3)
    assert min(closed) > 2.0
    fixed_length = taken * steady_crack.opening(ONE, zone, speed)
    assert np.all(np.abs(release / fixed_length - 1.0) > 0.1)


@pytest.mark.parametrize("solver", TOLERANCES)
def test_a_zone_longer_than_the_contact_is_refused(solver):
    asked = scene([Ramp(0.006, 1e-3)], Adhesion(WORK, stress=0.02), 0.0)
    with pytest.raises(SceneError, match="process zone"):
        solved(solver, asked)


def test_a_zone_wider_than_a_punch_is_refused():
    with pytest.raises(SceneError, match="process zone"):
        scene([], Adhesion(WORK, stress=0.02), 0.0, indenter=FlatPunch(0.2))
