"""Press, hold and release without adhesion by all three solvers: points, plane tips, forces, springs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.invariants.coarse_solvers import SOLVERS

import bem_solver
from contact_scene import (
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    Outcome,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
    TabulatedProfile,
)
from contact_scene.run_control import outcome_of_loss
from validation.measure.observables import observe
from validation.reference import path as reference

GEL, SOFT = Material(2e4, 0.45, (Branch(1e4, 0.3),)), Material(1e3, 0.49, (Branch(2e4, 1.0),))
PUNCH, BALL, BLUNT = FlatPunch(1e-3), Sphere(5e-3), PowerLaw(4.0, 5e7)
WORN = TabulatedProfile((0.0, 1e-4, 2e-4, 4e-4, 1e-3, 3e-3), (0.0, 0.0, 0.0, 1e-5, 4e-5, 1.4e-4))
"""A plane face, a ball, a paraboloid of fourth order, and a cone whose tip has been worn plane."""
PRESSED, RELEASED = Ramp(1e-4, 1e-3), Ramp(-2e-5, 1e-3)


def slow(value, **more):
    return pytest.param(value, marks=pytest.mark.slow, **more)


def solvers(*slowly):
    """A row of a table for every solver, some of them with the slow tests."""
    rows = [(slow if name in slowly else pytest.param)(one, id=name) for name, one in SOLVERS.items()]
    return pytest.mark.parametrize("solver", rows)


every_solver = solvers()


def scene(indenter, *steps, start=0.0, material=GEL, machine=None):
    return Scene(material, indenter, Loading("relaxed", start, steps, machine))


@every_solver
@pytest.mark.parametrize("indenter", [pytest.param(BALL, id="ball"), slow(Cone(70.0), id="cone")])
def test_the_edge_of_a_contact_that_relaxes_is_at_rest(solver, indenter):
    """Lee and Radok: pressed in, the radius is that of an elastic contact, whatever relaxes."""
    trace = solver.solve(scene(indenter, PRESSED, Hold(3.0), start=1e-5))
    depth, radius = trace.penetration, trace.contact_radius
    exact = np.sqrt(5e-3 * depth) if indenter is BALL else depth / (0.5 * math.pi * indenter.cotangent)
    held = trace.time > trace.time[-1] - 2.9
    assert held.sum() > 3
    accuracy = {"reference": 1e-8, "bem": 3e-4, "fem": 1e-4}[solver.name]
    assert radius[held] == pytest.approx(exact[held], rel=accuracy)
    if solver.name != "bem":  # its annuli follow the pressure
        assert np.ptp(radius[held]) <= 1e-7 * radius[-1]


PLANE = {
    "from above": scene(PUNCH, PRESSED, Hold(1.0), RELEASED, start=-2e-5),
    "touching": scene(PUNCH, PRESSED, Hold(1.0), RELEASED),
    "under a force": scene(PUNCH, ForceRamp(4e-3, 4e-3), ForceRamp(-1e-3, 4e-3)),
    "a force from above": scene(PUNCH, Force(4e-3, 1.0), ForceRamp(0.0, 4e-3), start=-1e-5),
    "on a spring": scene(PUNCH, PRESSED, Hold(1.0), RELEASED, machine=Machine(100.0)),
    "an elastic one": scene(PUNCH, PRESSED, RELEASED, start=-2e-5, material=Material(2e4, 0.45)),
    "worn": scene(WORN, PRESSED, Hold(1.0), RELEASED, start=-2e-5),
}
LATER = "touching", "an elastic one", "worn"


@every_solver
@pytest.mark.parametrize("name", [slow(name) if name in LATER else name for name in PLANE])
def test_a_plane_tip_touches_and_is_let_go_as_a_whole(solver, name):
    asked = PLANE[name]
    trace, tip = solver.solve(asked), asked.indenter.plane_tip
    near = 1e-9
    assert trace.outcome.kind is OutcomeKind.DETACHED
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    first, last = touching[0], touching[-1]
    hardest = trace.force.max()
    start, end = trace.contact_radius[[first, last]]
    assert start == pytest.approx(tip, rel=near)
    node = 1e-5 if solver.name == "fem" else 1e-9  # in part beyond the rim of the tip
    assert trace.force[first] == pytest.approx(0.0, abs=node * hardest)
    assert trace.time[first] == trace.time[first - 1]  # the row of the touch, without contact
    assert trace.penetration[first - 1 : first + 1] == pytest.approx(0.0, abs=1e-12)
    assert end == pytest.approx(tip, rel=near)
    assert trace.force[last] == pytest.approx(0.0, abs=1e-5 * hardest)
    found = observe(trace, loading=asked.loading)
    assert found.detachment_radius == pytest.approx(tip, rel=near)
    assert found.final_radius == 0.0


POINTS = {
    "ball": scene(BALL, PRESSED, Hold(1.0), RELEASED),
    "cone": scene(Cone(75.0), PRESSED, Hold(1.0), RELEASED, start=-2e-5),
    "blunt": scene(BLUNT, PRESSED, Hold(1.0), RELEASED, start=5e-5),
    "force": scene(Cone(75.0), Force(1e-3, 3.0), ForceRamp(0.0, 1e-3), start=-1e-5),
    "force on a ball": scene(BALL, ForceRamp(1e-3, 1e-3), ForceRamp(-1e-3, 1e-3), start=-1e-5),
    "force back to zero": scene(PowerLaw(4.0, 1e5), ForceRamp(3e-3, 0.05), ForceRamp(0.0, 7e-3)),
}


DEFAULT_POINTS = ("blunt",)


@solvers("bem", "reference")
@pytest.mark.parametrize("name", [name if name in DEFAULT_POINTS else slow(name) for name in POINTS])
def test_any_other_contact_ends_in_a_point(solver, name):
    asked = POINTS[name]
    trace, exact = solver.solve(asked), SOLVERS["reference"].solve(asked)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert (trace.contact_radius[-1], trace.force[-1]) == (0.0, 0.0)
    found, expected = (observe(one, loading=asked.loading, ends_in_a_point=True) for one in (trace, exact))
    assert found.detachment_radius == expected.detachment_radius == 0.0
    assert found.detachment_force == pytest.approx(0.0, abs=1e-12)
    assert found.detachment_time == pytest.approx(expected.detachment_time, rel=1e-3)
    deepest = exact.penetration.max()
    assert found.detachment_penetration == pytest.approx(expected.detachment_penetration, abs=1e-3 * deepest)


@every_solver
@pytest.mark.parametrize(
    "indenter", [Sphere(5e-6), slow(Cone(60.0)), FlatPunch(1e-6)], ids=lambda one: one.shape
)
def test_a_contact_that_comes_back_to_the_surface_exactly_is_over(solver, indenter):
    """Front tracking stood on a radius of rounding, or on a face without force, and went on with it."""
    there_and_back = Ramp(5e-7, 5e-6), Ramp(0.0, 5e-6), Ramp(1e-6, 5e-6), Ramp(-5e-7, 5e-6)
    trace = solver.solve(scene(indenter, *there_and_back, start=5e-8, material=Material(1e5, 0.45)))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(0.19, rel=1e-6)
    assert abs(trace.force[-1]) < (1e-5 if solver.name == "fem" else 1e-9) * trace.force.max()


@solvers("bem")
@pytest.mark.parametrize("indenter", [BALL, PUNCH], ids=["ball", "punch"])
def test_a_dead_load_taken_off_at_once_ends_the_contact(solver, indenter):
    """A ball leaves in a point: finite elements kept a root of the last part of the jump.

    A punch bears nothing over its whole face, by which front tracking divided.
    """
    asked = scene(indenter, Force(1e-3, 0.1), Force(0.0, 0.1))
    trace = solver.solve(asked)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == 0.1
    assert abs(trace.force[-1]) < 1e-9 * trace.force.max()
    found = observe(trace, loading=asked.loading, ends_in_a_point=indenter is BALL)
    assert found.detachment_radius == (0.0 if indenter is BALL else 1e-3)


@solvers("bem")
def test_a_force_that_lowers_an_indenter_does_no_work_on_the_way(solver):
    """It is as if the indenter had touched from the start."""
    above, touching = (solver.solve(scene(BALL, Force(1e-3, 0.05), start=start)) for start in (-1e-4, 0.0))
    assert above.external_work[-1] == pytest.approx(touching.external_work[-1], rel=1e-3)


@pytest.mark.parametrize("steps", [(Force(1e-2, 0.1), Force(1e-3, 0.1)), slow((ForceRamp(1e-2, 1e-3),))])
def test_front_tracking_keeps_a_given_force(steps):
    material = Material(1.8e6, 0.5, (Branch(2e6, 0.1), Branch(1e6, 2.0)))
    asked = scene(Sphere(2e-3), *steps, start=1e-6, material=material)
    trace = reference.solve(asked, reference.Options(4))
    given = np.where(trace.time < 0.1, 1e-2, 1e-3) if len(steps) == 2 else trace.force[0] + 1e-3 * trace.time
    smooth = (trace.time > 0.0) & (trace.time != 0.1)
    assert trace.force[smooth] == pytest.approx(given[smooth], rel=1e-11)


@pytest.mark.parametrize(
    ("indenter", "material"),
    [
        pytest.param(BALL, GEL, id="ball-gel"),
        pytest.param(BLUNT, Material(2e4, 0.45), id="blunt-elastic", marks=pytest.mark.slow),
        pytest.param(BALL, Material(2e4, 0.45), id="ball-elastic", marks=pytest.mark.slow),
        pytest.param(BLUNT, GEL, id="blunt-gel", marks=pytest.mark.slow),
    ],
)
def test_front_tracking_follows_a_new_contact_from_its_first_moment(indenter, material):
    """The radius goes as a root of the time, which a long first step draws as a chord."""
    options = reference.Options(6)
    trace = reference.solve(scene(indenter, PRESSED, material=material), options)
    assert 0.0 < trace.time[1] <= 1e-4 * trace.time[-1]
    exponent = 2.0 if indenter is BALL else 4.0
    middle = 0.5 * (trace.time[1:] + trace.time[:-1])
    exact = trace.contact_radius[-1] * (middle / trace.time[-1]) ** (1.0 / exponent)
    chord = 0.5 * (trace.contact_radius[1:] + trace.contact_radius[:-1])
    missed = np.sqrt(np.sum(np.diff(trace.time) * (chord - exact) ** 2) / trace.time[-1])
    assert missed <= options.step_tolerance * trace.contact_radius[-1]


@pytest.mark.parametrize("resolution", [4, slow(8)])
def test_boundary_elements_lose_a_blunt_tip_on_a_soft_rubber_in_a_point(resolution):
    """Where its edge runs away at last: no contact without adhesion is unstable before it is a point."""
    steps = Ramp(1e-3, 1e-4, until_force=3e-5), Hold(1.0), Ramp(-2e-5, 1e-4)
    asked = scene(PowerLaw(3.0, 3e4), *steps, start=-1e-5, material=SOFT)
    trace = bem_solver.solve(asked, bem_solver.Options(resolution))
    (event,) = trace.events
    assert (event.contact_radius, event.force) == (0.0, 0.0)
    assert event.penetration == pytest.approx(1.3917e-6, rel=1e-3)  # by front tracking


@every_solver
def test_a_force_on_a_tip_that_rises_steeply(solver):
    """Boundary elements divided by the change of a force that was lost in it, far outside of the contact."""
    ramps = ForceRamp(1.0, 0.5), ForceRamp(0.0, 0.5)
    trace = solver.solve(scene(PowerLaw(8.0, 1e20), *ramps, material=Material(5e5, 0.5)))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(4.0, rel=1e-6)
    assert trace.force.max() == pytest.approx(1.0, rel=1e-9)


def test_the_tips_that_are_plane():
    assert [PUNCH.plane_tip, WORN.plane_tip, BALL.plane_tip, Cone(60.0).plane_tip] == [1e-3, 2e-4, 0.0, 0.0]
    raised = replace(WORN, heights=tuple(height + 1e-6 for height in WORN.heights))
    assert raised.plane_tip == 2e-4


MODULES = {
    "bem": "bem_solver.solver",
    "fem": "fem_solver.solver",
    "reference": "validation.reference.path.run",
}


@every_solver
def test_every_solver_asks_whether_the_contact_it_lost_can_have_been_lost(solver, monkeypatch):
    broken = Outcome(OutcomeKind.BREAKDOWN, "lost while pressed in", 0.0)
    monkeypatch.setattr(MODULES[solver.name] + ".outcome_of_loss", lambda *_: broken)
    assert solver.solve(scene(BALL, Ramp(1.1e-4, 1e-3))).outcome is broken
    assert not broken.finished


@pytest.mark.parametrize(
    ("penetration", "radius", "kind"),
    [
        ([0.0, 1e-15, 2e-15], [0.0, 1e-8, 0.0], OutcomeKind.BREAKDOWN),  # in the first steps of a press
        ([0.0, 1.0, 2.0, 2.0], [0.0, 0.3, 0.0, 0.0], OutcomeKind.BREAKDOWN),  # later in it
        ([0.0, 1.0, 1.0], [0.0, 0.3, 0.0], OutcomeKind.BREAKDOWN),  # in a hold
        ([-1.0, 0.2, 0.1, 0.3], [0.0, 0.2, 0.1, 0.2], OutcomeKind.BREAKDOWN),  # pressed in again
        ([0.0, 1.0, 0.9, 0.9], [0.0, 0.3, 0.1, 0.0], OutcomeKind.DETACHED),  # a surface that recovers slowly
        ([0.0, 1.0, 0.9], [0.0, 0.3, 0.0], OutcomeKind.DETACHED),  # the same, in one step
        ([0.0, -1.0], [0.0, 0.0], OutcomeKind.DETACHED),  # never in contact
        ([-1.0, 0.0, 0.0, -0.1], [0.0, 0.0, 0.3, 0.0], OutcomeKind.DETACHED),  # a plane tip that touches
    ],
)
def test_losses_without_adhesion_that_can_be(penetration, radius, kind):
    lost = Outcome(OutcomeKind.DETACHED, "no stable contact is left", 1.0)
    assert outcome_of_loss(lost, False, penetration, radius).kind is kind
