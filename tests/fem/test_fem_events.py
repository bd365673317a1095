"""How runs of the finite elements end, what their rows hit, what they cost, and where they can be stopped."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from support.paper_scenes import ELASTIC, WORK, ZONE
from support.paper_scenes import scene as scene_of

from contact_scene import (
    Adhesion,
    Force,
    ForceRamp,
    Hold,
    Oscillate,
    OutcomeKind,
    Ramp,
)
from fem_solver import Options, record, solve
from fem_solver.contact_problem import ContactProblem
from meshes import EdgeMeshes
from validation.cases import load
from validation.solvers import SOLVERS
from validation.solvers.finite_elements import FiniteElements

LONG = 0.08
WEAK = Adhesion(0.1 * WORK, LONG)


@cache
def mesh(zone=ZONE, divisions=2, reach=0.26):
    return EdgeMeshes(zone, divisions, reach)


def weak(*steps, **options):
    scene = scene_of(*steps, start="relaxed", at=0.02, adhesion=WEAK)
    return solve(scene, mesh(LONG, 6), Options(**options))


@cache
def shrinking(tolerance=None):
    return weak(Ramp(0.022, 0.01), Ramp(-0.3, 0.01), tolerance=tolerance)


def test_contact_that_shrinks_to_its_zone_ends_with_the_state_there():
    trace = shrinking()
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert trace.outcome.finished
    assert trace.outcome.past_extremum
    assert trace.events == ()
    assert trace.contact_radius[-1] == pytest.approx(LONG, rel=1e-12)
    assert trace.contact_radius[:-1].min() > LONG
    assert trace.outcome.time == trace.time[-1]
    # located to the accuracy of the rows: the speed there is finite
    finer = shrinking(1e-4)
    assert trace.time[-1] == pytest.approx(finer.time[-1], rel=2e-4)
    assert trace.force[-1] == pytest.approx(finer.force[-1], rel=2e-3)


@pytest.mark.parametrize("step", [Force(-0.001, 50.0), ForceRamp(-0.1, 1e-3)])
def test_zone_is_reached_under_a_force_before_the_tension_has_its_maximum(step):
    trace = weak(step)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert not trace.outcome.past_extremum
    assert not trace.outcome.finished
    assert trace.contact_radius[-1] == pytest.approx(LONG, rel=1e-12)
    assert trace.events == ()


def test_a_limit_point_above_the_zone_is_a_detachment():
    trace = weak(ForceRamp(-0.1, 1e-2))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.contact_radius[-1] > 1.2 * LONG
    assert [event.kind for event in trace.events] == ["pull-off"]


@pytest.mark.parametrize(("name", "apart"), [("elastic-glassy", 3e-3), ("retraction-v2e-4", 2e-2)])
def test_contact_is_lost_at_its_limit_point(name, apart):
    """The radius there goes with the root of the distance: it shows what force and time do not."""
    scene = load(name).scene
    found = SOLVERS["fem"].solve(scene, 5)
    known = SOLVERS["reference"].solve(scene)
    assert found.events[-1].contact_radius == pytest.approx(known.events[-1].contact_radius, rel=apart)


@pytest.mark.slow
def test_largest_tension_is_a_row_where_a_frozen_edge_lets_go():
    scene = scene_of(Ramp(-0.5, 1.0), start="relaxed", at=0.02)
    coarse, fine = (solve(scene, mesh(divisions=1), Options(tolerance=t)) for t in (1e-3, 1e-4))
    assert coarse.force.min() == pytest.approx(fine.force.min(), rel=2e-4)
    row = int(np.argmin(coarse.force))
    slopes = np.diff(coarse.force) / np.diff(coarse.time)
    assert slopes[row - 2] < -0.5 * slopes[row + 1] < 0.0  # a corner, not a smooth maximum
    assert coarse.counters.steps == len(coarse) - 1
    assert coarse.counters.history_updates == len(coarse)


def test_a_small_oscillation_on_a_long_drift_is_resolved():
    """Against the quasi-linear answer of a frozen edge: the force swings as the glassy punch does."""
    swings = []
    for drift in (0.0, 1e-3):
        oscillation = Oscillate(1e-7, 200.0, 0.2, drift)
        trace = solve(scene_of(oscillation, start="relaxed", at=0.03), mesh(divisions=1), Options(1e-3))
        assert len(trace) > 15 * 200.0 * 0.2 / (2.0 * np.pi)
        times = np.linspace(0.05, 0.19, 400)
        force = np.interp(times, trace.time, trace.force)
        swings.append(np.ptp(force - np.polyval(np.polyfit(times, force, 4), times)))
    assert swings[1] == pytest.approx(swings[0], rel=0.03)


def test_fields_forget_a_row_that_was_taken_back():
    scene = scene_of(Ramp(-0.5, 10.0), start="relaxed", at=0.032)
    recording = record(scene, FiniteElements().mesh(scene, 4), Options(record=True))
    assert len(recording.steps) == len(recording.trace)


def test_an_elastic_contact_passes_many_zones_in_a_step():
    rows = []
    for divisions in (1, 8):
        scene = scene_of(Ramp(0.02, 0.1), start="relaxed", at=0.01, material=ELASTIC)
        rows.append(len(solve(scene, mesh(divisions=divisions), Options(1e-3))))
    assert rows[1] < 1.2 * rows[0] < 120


def test_a_load_step_that_the_clock_cannot_resolve_is_told():
    trace = weak(Hold(1e17), Ramp(0.0, 1e-3))
    assert trace.outcome.kind is OutcomeKind.STEP_UNDERFLOW
    assert trace.time[-1] == 1e17
    assert trace.force[-1] == pytest.approx(weak(Hold(1e3)).force[-1], rel=1e-6)


def test_evaluations_of_the_closure_are_counted_once(monkeypatch):
    calls, closure = [], ContactProblem.closure

    def counted(self, s):
        calls.append(s)
        return closure(self, s)

    monkeypatch.setattr(ContactProblem, "closure", counted)
    for scene, own in (
        (scene_of(Ramp(-0.5, 10.0), start="relaxed", at=0.032), mesh(divisions=1)),
        (scene_of(Ramp(-0.5, 1.0), start="relaxed", at=0.02, adhesion=WEAK), mesh(LONG, 6)),
    ):
        calls.clear()
        trace = solve(scene, own)
        assert trace.outcome.finished
        assert trace.counters.closure_evaluations == len(calls)
