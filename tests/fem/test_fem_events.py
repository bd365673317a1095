"""How runs of the finite elements end, what their rows hit, what they cost, and where they can be stopped."""

from __future__ import annotations

import os
from functools import cache

import numpy as np
import pytest
from support.paper_scenes import ELASTIC, WORK, ZONE
from support.paper_scenes import scene as scene_of

from contact_scene import (
    Adhesion,
    Branch,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Material,
    Oscillate,
    OutcomeKind,
    Ramp,
    SceneError,
)
from fem_solver import Options, record, solve
from fem_solver.release import ContactProblem
from fem_solver.setup_memory import NODES_PER_INTERVAL, UNKNOWNS_PER_VERTEX, setup_memory
from meshes import fit, structured_half_space

LONG = 0.08
WEAK = Adhesion(0.1 * WORK, LONG)


@cache
def mesh(zone=ZONE, divisions=2, reach=0.26):
    return structured_half_space(fit(0.0, reach, zone, divisions))


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


def test_a_punch_that_peels_needs_a_mesh_that_is_fine_inside():
    scene = scene_of(Ramp(-0.1, 1e-3), start="relaxed", at=0.0, indenter=FlatPunch(0.2))
    narrow, wide = (structured_half_space(fit(a, 0.2, ZONE, 2, edge=0.2)) for a in (0.18, 0.0))
    trace = solve(scene, narrow)
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert "the mesh is made for" in trace.outcome.reason
    assert trace.contact_radius[-1] > narrow.parameters.fine_from + ZONE
    whole = solve(scene, wide)
    assert whole.outcome.finished
    assert whole.contact_radius[-1] < 0.8 * trace.contact_radius[-1]
    shared = trace.time < 0.999 * trace.time[-1]
    expected = np.interp(trace.time[shared], whole.time, whole.contact_radius)
    assert np.abs(trace.contact_radius[shared] - expected).max() < 0.1 * ZONE


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
        trace = solve(scene_of(oscillation, start="relaxed", at=0.03), mesh(divisions=1))
        assert len(trace) > 15 * 200.0 * 0.2 / (2.0 * np.pi)
        times = np.linspace(0.05, 0.19, 400)
        force = np.interp(times, trace.time, trace.force)
        swings.append(np.ptp(force - np.polyval(np.polyfit(times, force, 4), times)))
    assert swings[1] == pytest.approx(swings[0], rel=0.03)


def test_fields_forget_a_row_that_was_taken_back():
    scene = scene_of(Ramp(-0.5, 10.0), start="relaxed", at=0.032)
    recording = record(scene, mesh(divisions=1), Options(record_every=1))
    assert recording.log.rows == len(recording.trace)


def test_an_elastic_contact_passes_many_zones_in_a_step():
    rows = []
    for divisions in (1, 8):
        scene = scene_of(Ramp(0.02, 0.1), start="relaxed", at=0.01, material=ELASTIC)
        rows.append(len(solve(scene, mesh(divisions=divisions))))
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


def test_many_branches_cost_little_and_their_energies_are_those_of_their_variables():
    times = np.geomspace(1e-4, 1e4, 100)
    material = Material(0.75, 0.5, tuple(Branch(0.0675, time) for time in times))
    scene = scene_of(Ramp(0.022, 0.01), Hold(3.0), start="relaxed", at=0.02, material=material)
    recording = record(scene, mesh(divisions=1), Options(record_times=(0.2,)))
    history, state = recording.setup.history, recording.setup.history.state
    forms = [branch @ history.operator.displacement(branch) for branch in state.branches]
    assert np.allclose(state.forms, forms, rtol=1e-9, atol=1e-12 * max(forms))


def test_memory_is_forecast_from_the_size_of_the_mesh(monkeypatch):
    parameters = fit(0.0, 0.26, ZONE, 4)
    grid = structured_half_space(parameters)
    scene = scene_of()
    setup, vertices = record(scene, grid).setup, grid.points.shape[1]
    intervals = 1.2 * parameters.fine_to / parameters.fine_size
    assert NODES_PER_INTERVAL * intervals == pytest.approx(len(setup.radii), rel=0.25)
    assert UNKNOWNS_PER_VERTEX * vertices == pytest.approx(setup.space.unknowns, rel=0.1)
    memory = setup_memory(intervals, vertices)
    assert setup_memory(2.0 * intervals, 2.0 * vertices) > 2.0 * memory
    assert setup_memory(intervals, vertices, apart=True) > 3.0 * memory
    pages = os.sysconf

    def small(name):
        return 1000 if name == "SC_PHYS_PAGES" else pages(name)

    monkeypatch.setattr(os, "sysconf", small)
    with pytest.raises(SceneError, match="GB are installed"):
        solve(scene, grid)
