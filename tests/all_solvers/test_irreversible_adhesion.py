"""Adhesion that knows direction and speed: every solver against closed forms on an elastic half-space."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.closed_forms.adhesion_hysteresis import AdhesionHysteresis

from contact_scene import (
    Adhesion,
    Branch,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    OutcomeKind,
    PowerRate,
    Ramp,
    RateTable,
    Scene,
    Sphere,
)
from validation.reference.finite_zone import FiniteZone
from validation.reference.rated_edge import RatedEdge, opening_speed
from validation.solvers import SOLVERS

WORK, CLOSING, ZONE = 5.0e-4, 2.0e-4, 0.013
ELASTIC = Material(0.75, 0.5)
"""Plane modulus 1."""
TOLERANCES = {"reference": 1e-3, "bem": 1e-3, "fem": 5e-3}
RESOLUTION = {"reference": 8, "bem": 8, "fem": 4}
RATES = {
    "power": PowerRate(1e-3, 0.5),
    "steep": PowerRate(1e-2, 1.5),
    "table": RateTable((1e-4, 1e-3, 1e-2, 1.0), (5.5e-4, 7.5e-4, 1.5e-3, 1e-2)),
}
each_solver = pytest.mark.parametrize("solver", TOLERANCES)


def branches(zone=ZONE):
    return AdhesionHysteresis(FiniteZone(1.0, 1.0, WORK, zone), FiniteZone(1.0, 1.0, CLOSING, zone), 1.0)


def scene(steps, adhesion, start=0.0, material=ELASTIC, indenter=Sphere(1.0), state="relaxed"):  # noqa: B008
    return Scene(material, indenter, Loading(state, start, tuple(steps)), adhesion)


def solved(solver, asked):
    return SOLVERS[solver].solve(asked, RESOLUTION[solver])


def loss_of_balance(trace):
    """What the balance leaves, from its columns."""
    stored = trace.stored_energy - trace.stored_energy[0]
    spent = trace.extra["separation_energy"]
    return trace.external_work - stored - spent - trace.dissipated_energy


FACES = [
    pytest.param(solver, state, material, id=f"{name}-{state}-{solver}")
    for name, material in (("elastic", ELASTIC), ("branch", Material(0.75, 0.5, (Branch(3.0, 1.0),))))
    for state in ("relaxed", "jump-in")
    for solver in TOLERANCES
]
SLOW_FACES = {"branch-jump-in-fem", "elastic-relaxed-fem"}
"""Beside others of the same solver, from which they differ in the state or in the material alone."""


@pytest.mark.parametrize(
    ("solver", "state", "material"),
    [
        pytest.param(*one.values, id=one.id, marks=pytest.mark.slow) if one.id in SLOW_FACES else one
        for one in FACES
    ],
)
def test_a_flat_face_starts_whole_where_it_could_not_close(solver, state, material):
    """Under a tension between those at which its edge closes and opens; G = D^2 E*/(2 pi a) is halfway."""
    modulus = material.relaxed_plane_modulus if state == "relaxed" else material.glassy_plane_modulus
    depth = -math.sqrt(math.pi * (WORK + CLOSING) * 0.1 / modulus)
    steps, law = [Ramp(0.0, 1e-2)], Adhesion(WORK, 0.002, CLOSING)
    trace = solved(solver, scene(steps, law, depth, material, FlatPunch(0.1), state))
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.contact_radius[0] == pytest.approx(0.1)
    assert trace.force[0] == pytest.approx(2.0 * modulus * 0.1 * depth, rel=5e-3)


@each_solver
def test_the_edge_is_pinned_between_two_branches(solver):
    depths = [0.01, 0.02, 0.01, 0.012, 0.006]
    trace = solved(solver, scene([Ramp(to, 1e-3) for to in depths[1:]], Adhesion(WORK, ZONE, CLOSING), 0.01))
    times = np.concatenate(([0.0], np.cumsum(1e3 * np.abs(np.diff(depths)))))
    states = branches().path(depths)
    rows = [int(np.argmin(np.abs(trace.time - time))) for time in times]
    radius = np.array([state.contact_radius for state in states])
    force = np.array([state.force for state in states])
    accuracy = TOLERANCES[solver]
    assert_allclose(trace.contact_radius[rows], radius, rtol=accuracy)
    assert_allclose(trace.force[rows], force, atol=accuracy * np.abs(force).max())
    assert radius[3] == radius[2]  # the fourth state lies on the vertical line above the third
    spent = np.array([CLOSING, WORK, 0.0, WORK]) * -np.pi * np.diff(radius**2)
    assert_allclose(
        trace.extra["separation_energy"][rows], [0.0, *np.cumsum(spent)], atol=accuracy * abs(spent[0])
    )
    assert np.abs(loss_of_balance(trace)).max() < 1e-14
    biased = abs(branches().opening.energy_release_rate(radius[2]) / WORK - 1.0) * np.abs(spent).sum()
    assert np.abs(trace.dissipated_energy).max() < 1.5 * biased  # of the finite zone; nothing relaxes


def test_a_pinned_edge_under_force_control_is_a_punch():
    steps = (Force(2e-3, 1.0), ForceRamp(1e-3, 1e-3), ForceRamp(1.5e-3, 1e-3))
    trace = solved("reference", scene(steps, Adhesion(WORK, ZONE, CLOSING)))
    radius, rows = trace.contact_radius, trace.time >= 1.0
    assert np.all(radius[rows] == radius[-1])
    assert radius[-1] > radius[0]
    slope = np.diff(trace.force[rows]) / np.diff(trace.penetration[rows])
    assert_allclose(slope, 2.0 * radius[-1], rtol=1e-9)


@pytest.mark.parametrize(
    ("solver", "law"),
    [
        ("reference", "power"),
        ("bem", "power"),
        pytest.param("fem", "power", marks=pytest.mark.slow),
        *(pytest.param(solver, "steep", marks=pytest.mark.slow) for solver in TOLERANCES),
        pytest.param("reference", "table", marks=pytest.mark.slow),
    ],
)
def test_an_opening_edge_follows_its_equation_of_motion(solver, law):
    adhesion, start, rate = Adhesion(WORK, ZONE, None, RATES[law]), 0.02, 2e-3
    trace = solved(solver, scene([Ramp(-0.025, rate)], adhesion, start))
    assert trace.outcome.finished
    contact = FiniteZone(1.0, 1.0, WORK, ZONE)
    first = contact.at_penetration(start)
    edge = RatedEdge(adhesion, contact.closure)
    radius = edge.radii(first.contact_radius, start, rate, trace.time, ZONE)
    near = radius > 4.0 * ZONE  # then it collapses within a ten-thousandth of the time
    force = 2.0 * (radius * trace.penetration - radius**3 / 3.0)
    accuracy = TOLERANCES[solver]
    pull_off = -np.nanmin(force)
    assert pull_off > 1.5 * 1.5 * math.pi * WORK
    assert_allclose(-trace.force.min(), pull_off, rtol=accuracy)
    assert_allclose(trace.force[near], force[near], atol=accuracy * pull_off)
    assert_allclose(trace.contact_radius[near], radius[near], atol=accuracy * radius[0])
    area = math.pi * radius[near] ** 2
    speed = np.array([opening_speed(adhesion, c) for c in map(contact.closure, radius, trace.penetration)])
    taken = np.array([adhesion.opening(v) for v in speed[near]])
    spent = np.sum(0.5 * (taken[1:] + taken[:-1]) * -np.diff(area))
    assert_allclose(trace.extra["separation_energy"][near][-1], spent, rtol=2.0 * accuracy)
    assert np.abs(loss_of_balance(trace)).max() < 1e-14


@pytest.mark.slow
def test_hysteresis_and_rate_agree_on_a_viscoelastic_half_space():
    """No closed form: three methods, an adhesion that jumps, pins, and slows the edge."""
    adhesion = Adhesion(WORK, ZONE, CLOSING, PowerRate(1e-3, 0.4))
    rubber = Material(0.75, 0.5, (Branch(6.75, 1.0),))
    steps = (Hold(5.0), Ramp(0.02, 1e3), Ramp(0.0, 1e3), Hold(3.0), Force(-1e-3, 5.0))
    traces = [solved(name, scene(steps, adhesion, 0.01, rubber, state="jump-in")) for name in TOLERANCES]
    truth = traces[0]
    for trace in traces[1:]:
        accuracy = 5e-3
        assert trace.outcome.finished
        assert_allclose(trace.contact_radius[-1], truth.contact_radius[-1], rtol=accuracy)
        assert_allclose(trace.force.min(), truth.force.min(), rtol=accuracy)
        largest = truth.dissipated_energy.max()
        assert_allclose(trace.dissipated_energy[-1], truth.dissipated_energy[-1], atol=2 * accuracy * largest)
        spent = np.abs(truth.extra["separation_energy"]).max()
        for name in ("separation_energy", "branch_dissipation"):
            scale = spent if name == "separation_energy" else largest
            assert_allclose(trace.extra[name][-1], truth.extra[name][-1], atol=2e-2 * scale)


HYSTERESIS, RATED = Adhesion(WORK, ZONE, CLOSING), Adhesion(WORK, ZONE, None, RATES["power"])


@pytest.mark.slow
@pytest.mark.parametrize("solver", ["bem", "fem"])
@pytest.mark.parametrize("adhesion", [HYSTERESIS, RATED], ids=["hysteresis", "rate"])
def test_contact_is_lost_on_a_spring(adhesion, solver):
    asked = scene([Ramp(-0.2, 1e-2)], adhesion, start=0.01)
    asked = replace(asked, loading=replace(asked.loading, machine=Machine(0.2)))
    trace, expected = SOLVERS[solver].solve(asked, 5), SOLVERS["reference"].solve(asked, 5)
    assert trace.outcome.kind is expected.outcome.kind
    assert trace.outcome.kind in (OutcomeKind.DETACHED, OutcomeKind.BELOW_ZONE)
    assert_allclose(trace.force.min(), expected.force.min(), rtol=5e-3)
    spent = expected.extra["separation_energy"][-1]
    assert_allclose(trace.extra["separation_energy"][-1], spent, rtol=1e-2)  # of the snap too
    lost = expected.extra["instability_loss"][-1]
    assert_allclose(trace.extra["instability_loss"][-1], lost, atol=1e-2 * abs(trace.external_work).max())


@each_solver
def test_a_pinned_edge_has_a_row_where_it_sets_off(solver):
    """By the closed form: on the turn the edge is pinned, and leaves on the line to its opening branch."""
    trace = solved(solver, scene([Ramp(0.02, 1e-3), Ramp(-0.1, 1e-3)], HYSTERESIS))
    turn = int(trace.penetration.argmax())
    pinned = np.isclose(trace.contact_radius[turn:], trace.contact_radius[turn], rtol=1e-7)
    last = turn + int(np.flatnonzero(pinned)[-1])
    opening = FiniteZone(1.0, 1.0, WORK, ZONE).state(float(trace.contact_radius[turn])).penetration
    assert_allclose(trace.penetration[last], opening, rtol=0.0, atol=1e-3 * trace.penetration[turn])
