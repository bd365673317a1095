"""A machine with a spring, and steps that end at a level, by all three solvers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.invariants.checks import differences_in_units
from support.invariants.coarse_solvers import SOLVERS

import crosscontact as cc
from benchmarks.strategies import in_units
from contact_scene import (
    Adhesion,
    Approach,
    Branch,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    OutcomeKind,
    Ramp,
    Scene,
    Sphere,
    Table,
)
from validation.reference.finite_zone import FiniteZone
from validation.reference.spring import SpringContact

WORK, ZONE = 5.026548e-4, 0.03
ELASTIC, RELAXING = Material(0.75, 0.5), Material(0.75, 0.5, (Branch(0.75, 1.0),))
LAW = FiniteZone(1.0, 1.0, WORK, ZONE)
STIFFNESS = 2.0 * LAW.pull_off_force_control().contact_radius  # of the contact at pull-off
every_solver = pytest.mark.parametrize("solver", SOLVERS.values(), ids=list(SOLVERS))


def scene(material, *steps, machine=None):
    return Scene(material, Sphere(1.0), Loading("jump-in", 0.0, steps, machine), Adhesion(WORK, ZONE))


def pulled(stiffness):
    """From the start state until contact is lost, on an elastic half-space."""
    spring = SpringContact(LAW, stiffness)
    lost = 1.2 * spring.stage(spring.pull_off()) - 0.2 * spring.stage(LAW.at_penetration(0.0))
    return scene(ELASTIC, Ramp(lost, 1.0), machine=Machine(stiffness)), spring


@every_solver
@pytest.mark.parametrize("share", [pytest.param(0.03, marks=pytest.mark.slow), 1.0])
def test_contact_is_lost_at_the_limit_point_of_the_stage(solver, share):
    asked, spring = pulled(share * STIFFNESS)
    trace, limit = solver.solve(asked), spring.pull_off()
    assert trace.outcome.kind is OutcomeKind.DETACHED
    (event,) = trace.events
    accuracy = {"reference": 1e-4, "bem": 1e-3, "fem": 5e-3}[solver.name]
    stage, columns = spring.stage(limit), trace.columns()
    assert columns["stage"].min() == pytest.approx(stage, rel=accuracy)
    assert event.penetration + event.force / asked.machine.stiffness == pytest.approx(stage, rel=accuracy)
    # where the stage is least it is flat: an error of it moves the point by its root
    assert event.force == pytest.approx(limit.force, rel=math.sqrt(accuracy))
    assert trace.force.min() == pytest.approx(spring.largest_tension().force, rel=accuracy)
    assert columns["instability_loss"][-1] == pytest.approx(spring.lost_in_snap(), rel=3 * accuracy, abs=0.0)
    assert (trace.force[-1], trace.contact_radius[-1]) == (0.0, 0.0)
    assert trace.penetration[-1] == pytest.approx(columns["stage"][-2], abs=1e-12)  # at constant stage
    assert columns["machine_energy"][-1] == 0.0
    # work of the stage, by itself: nothing at constant stage, straight lines where rows are dense
    along = np.sum(0.5 * (trace.force[1:] + trace.force[:-1]) * np.diff(columns["stage"]))
    assert trace.external_work[-1] == pytest.approx(along, rel=2e-2)


@pytest.mark.parametrize("name", SOLVERS)
def test_a_given_force_takes_the_stage_along_where_it_tears_the_contact(name):
    """At constant stage this one would not tear: energy would be gained. The last row is in contact."""
    limit = LAW.pull_off_force_control()
    pull = ForceRamp(1.5 * limit.force, 1e-3)
    trace = SOLVERS[name].solve(scene(ELASTIC, pull, machine=Machine(3.0 * STIFFNESS)))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.force[-1] == pytest.approx(limit.force, rel=5e-3)
    assert trace.contact_radius[-1] > 0.9 * limit.contact_radius
    assert trace.columns()["instability_loss"][-1] == 0.0


@every_solver
def test_rigid_spring_is_no_spring_bit_for_bit(solver):
    plain = scene(RELAXING, Ramp(0.004, 0.1))
    rigid = replace(plain, loading=replace(plain.loading, machine=Machine(math.inf)))
    one, two = (solver.solve(asked).columns() for asked in (plain, rigid))
    assert list(one) == list(two)
    assert all(np.array_equal(one[name], two[name]) for name in one)


@every_solver
def test_steps_end_where_the_level_is_reached(solver):
    steps = (
        Ramp(0.05, 0.1, until_force=0.001),
        Hold(9.0, until_force=0.0009),
        Ramp(-0.1, 0.1, until_radius=0.13),
        Force(0.0012, 9.0, until_penetration=0.0125),
    )
    trace = solver.solve(scene(RELAXING, *steps))
    assert trace.outcome.kind is OutcomeKind.COMPLETED, trace.outcome.reason
    depth, force, radius = trace.penetration, trace.force, trace.contact_radius
    reached = [
        np.abs(column - level).min() / level
        for column, level in ((force, 0.001), (force, 0.0009), (radius, 0.13))
    ]
    assert max(reached) < 1e-9
    assert depth[-1] == pytest.approx(0.0125, rel=1e-9)
    assert force[-1] == pytest.approx(0.0012, rel=1e-9)
    assert np.all(depth[force > 0.00100001] <= 0.0125 * (1.0 + 1e-9))


@every_solver
def test_level_that_is_not_reached_ends_the_run_and_says_so(solver):
    trace = solver.solve(scene(ELASTIC, Ramp(0.002, 0.1, until_force=1.0), Hold(1.0)))
    assert trace.outcome.kind is OutcomeKind.TRIGGER_NOT_REACHED
    assert not trace.outcome.finished
    assert "force was 1" in trace.outcome.reason
    assert trace.penetration[-1] == pytest.approx(0.002)


@every_solver
def test_an_approach_without_a_bound_goes_on_until_its_force(solver):
    """A punch of ``F = D`` on a spring of 2, pressed until 0.6 and as far up as the bound is down."""
    loading = Loading("relaxed", 0.1, (Approach(1.0, 0.6, dwell=0.5),), Machine(2.0))
    trace = solver.solve(Scene(ELASTIC, FlatPunch(0.5), loading))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.force.max() == pytest.approx(0.6, rel=1e-9)
    dwelt = trace.time[np.flatnonzero(trace.force > 0.6 * (1.0 - 1e-9))]
    assert dwelt[-1] - dwelt[0] == pytest.approx(0.5, rel=1e-3)


@pytest.mark.parametrize("name", ["reference", "bem", "fem"])
def test_an_approach_retracts_until_contact_is_lost(name):
    """A punch in SI units that its relaxing edge holds to twice the bound of the approach."""
    gel, adhesion = Material(2e4, 0.5, (Branch(1.8e5, 0.1),)), Adhesion(1.0, 2e-5)
    test = Loading("jump-in", 0.0, (Approach(1e-4, 5e-3, retract=1e-4),))
    found = cc.solve(Scene(gel, FlatPunch(5e-4), test, adhesion), name, resolution=7)
    assert found.outcome.kind is OutcomeKind.DETACHED
    assert found.pull_off.force == pytest.approx(0.0148137, rel=5e-4)
    assert found.detachment.penetration == pytest.approx(-6.6864e-4, rel=2e-3)


@pytest.mark.parametrize("name", ["reference", "fem", "bem"])
def test_a_level_that_a_load_jump_passes_ends_the_step_after_the_jump(name):
    """A punch of ``F = 2 D`` at once: the force is put on whole, then the penetration stays."""
    steps = (Force(0.6, 5.0, until_penetration=0.2), Hold(0.5))
    trace = SOLVERS[name].solve(Scene(RELAXING, FlatPunch(0.5), Loading("relaxed", 0.1, steps)))
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.force.max() == pytest.approx(0.6, rel=1e-9)
    assert trace.time[-1] == pytest.approx(0.5)
    assert trace.penetration[-1] == pytest.approx(0.1 + 0.5 / 2.0, rel=1e-3)


ALSO_SLOWLY = [pytest.param(name, marks=pytest.mark.slow) for name in ("bem", "fem")]


@pytest.mark.parametrize("name", ["reference", *ALSO_SLOWLY])
def test_soft_spring_is_a_dead_load(name):
    """A stage at the speed ``rate/k`` on a spring of ``k``, against a force that falls at ``rate``."""
    solver, rate, soft = SOLVERS[name], 0.01, 1e-7
    loaded = solver.solve(scene(RELAXING, ForceRamp(-1.0, rate)))
    sprung = solver.solve(scene(RELAXING, Ramp(-1.0 / soft, rate / soft), machine=Machine(soft)))
    (one,), (two,) = loaded.events, sprung.events
    accuracy = 2.0 * solver.declared(scene(RELAXING))
    assert two.force == pytest.approx(one.force, rel=accuracy)
    assert two.time == pytest.approx(one.time, rel=accuracy)


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLVERS)
def test_table_of_forces_is_a_force_ramp(name):
    """By straight lines, and by cubics, which are straight through three rows on a line."""
    ramp = scene(RELAXING, Force(-0.0005, 0.0), ForceRamp(0.001, 0.01))
    wanted = SOLVERS[name].solve(ramp)
    for how in ("linear", "cubic"):
        table = Table((0.0, 0.05, 0.15), (-0.0005, 0.0, 0.001), quantity="force", interpolation=how)
        found = SOLVERS[name].solve(scene(RELAXING, table))
        assert found.outcome.kind is OutcomeKind.COMPLETED
        assert found.force[-1] == pytest.approx(0.001, rel=1e-9)
        for column in ("time", "penetration", "contact_radius"):
            last = getattr(wanted, column)[-1]
            assert getattr(found, column)[-1] == pytest.approx(last, rel=SOLVERS[name].declared(ramp))


@pytest.mark.parametrize("name", ["reference", *ALSO_SLOWLY])
def test_copies_in_other_units_agree(name):
    """Pressed to a force and pulled off; units are powers of two, which leave the digits alone."""
    steps = (Ramp(0.05, 0.5, until_force=0.001), Hold(0.1), Ramp(-0.5, 0.5))
    asked = scene(RELAXING, *steps, machine=Machine(STIFFNESS))
    copy, units = in_units(asked, 2.0**-20, 2.0**10, 2.0**-3)
    assert differences_in_units(SOLVERS[name], asked, copy, units) == []


@pytest.mark.parametrize("share", [0.1, pytest.param(1.0, marks=pytest.mark.slow)])
def test_slow_approach_on_a_spring_while_the_half_space_relaxes(share):
    """Stage and penetration are two things: a step that takes one for the other loses its way slowly."""
    material = Material(0.75, 0.5, (Branch(1.5, 1.0),))
    slow = scene(material, Ramp(0.03, 0.01), machine=Machine(share * STIFFNESS))
    exact = SOLVERS["reference"].solve(slow)
    for name in ("bem", "fem"):
        trace = SOLVERS[name].solve(slow)
        for column in ("contact_radius", "force", "penetration"):
            ours, theirs = getattr(trace, column), getattr(exact, column)
            apart = np.abs(np.interp(trace.time, exact.time, theirs) - ours).max()
            assert apart <= 5e-3 * np.abs(theirs).max(), (name, column)


@every_solver
def test_contact_is_made_at_constant_stage(solver):
    """With the stage where the surfaces just touch, spring and adhesion balance: the stable branch."""
    for stiffness, at in ((STIFFNESS, 0.0), (0.1 * STIFFNESS, 0.003)):
        loading = Loading("snap-in", at, (), Machine(stiffness))
        trace = solver.solve(Scene(ELASTIC, Sphere(1.0), loading, Adhesion(WORK, ZONE)))
        state = SpringContact(LAW, stiffness).at_stage(at)
        accuracy = {"reference": 1e-9, "bem": 1e-3, "fem": 5e-3}[solver.name]
        assert trace.extra["stage"][0] == pytest.approx(at, abs=1e-12)
        assert trace.contact_radius[0] == pytest.approx(state.contact_radius, rel=accuracy)
        most = abs(LAW.pull_off_force_control().force)
        assert trace.force[0] == pytest.approx(state.force, abs=accuracy * most)
    rigid = scene(RELAXING)
    snapped = replace(rigid, loading=replace(rigid.loading, start="snap-in"))
    assert np.array_equal(solver.solve(rigid).force, solver.solve(snapped).force)
