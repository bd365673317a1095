"""The reference on the path of the edge, against today's: parts first, then whole scenes."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.reference_path import measures, scene_of
from contact_scene import Adhesion, Branch, OutcomeKind, Table, Trace
from validation.cases import load
from validation.reference import tracking
from validation.reference.path.closure import closure
from validation.reference.path.equilibrium import elastic_start
from validation.reference.path.fields import NODES, WEIGHTS
from validation.reference.path.memory import PATH_AT_NODES, Ramp, collocation
from validation.reference.path.options import Options
from validation.reference.path.path import Segment
from validation.reference.path.polynomials import inverse
from validation.reference.path.rheology import Body, rheology
from validation.reference.path.solver import Run, solve
from validation.reference.path.trial import Trial
from validation.reference.sneddon import PowerTransform, transform
from validation.reference.tracking.closure import EdgeFields, closure_integral
from validation.reference.tracking.equilibrium import start_surface
from validation.reference.tracking.law import Griffith, NoTension
from validation.scenes import names


@pytest.mark.parametrize(("radius", "zone"), [(0.2, 0.013), (0.2, 1e-6), (0.02, 0.013)])
def test_closure_is_that_of_nodes(radius, zone):
    """Fields that today's interpolates exactly, cubics; behind the edge and ahead of it."""
    x, y = np.linspace(radius - zone, radius, 65), np.linspace(radius, radius + zone, 65)
    depth, relaxed = -0.01, 1.0

    def memory(at):
        return -0.3 + 0.2 * (at - radius) / zone + 0.1 * ((at - radius) / zone) ** 2

    def strain(at):
        return 0.05 + 0.02 * (at - radius) / zone

    shape = PowerTransform(1.0, 2.0)
    today = closure_integral(EdgeFields(x, memory(x), y, strain(y), depth), zone, relaxed, shape)
    here = closure(radius, zone, zone * np.linspace(0.0, 1.0, 17))
    behind, ahead = radius - zone + here.s, radius + here.s
    q = relaxed * (depth - shape(behind)) + memory(behind)
    d = strain(ahead) - depth + shape(ahead)
    assert here.integral(q, d) == pytest.approx(today, rel=1e-7 if zone > 0.5 * radius else 1e-10)


@pytest.mark.parametrize("time", [1e-6, 0.03, 1.0, 1e4])
def test_memory_by_collocation_is_that_of_a_ramp(time):
    times, memory, clock = np.array([time]), np.array([0.3]), np.array([0.0, 0.5, 0.4, 0.1, 0.0])
    exact = Ramp(times, clock, memory, 0.1, 0.7).end
    end = collocation(times, clock, memory, 0.1, 0.7 * (PATH_AT_NODES @ clock), np.zeros(9)).motion().end
    assert end[1] == pytest.approx(exact[1], rel=1e-12)
    assert end[0][0] == pytest.approx(exact[0][0], rel=1e-6, abs=1e-7)


@pytest.mark.parametrize(
    "way", [[0.0, 1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0, 0.0], [0.0, 2.0, -1.0, 0.0, 0.0]]
)
def test_inverse_of_a_path_that_may_turn_at_an_end(way):
    way, u = np.array(way), np.linspace(0.0, 1.0, 11)
    rise = sum(coefficient * u**order for order, coefficient in enumerate(way))
    assert inverse(way, rise) == pytest.approx(u, abs=1e-7)


@pytest.mark.parametrize(
    ("name", "near"),
    [("cycle-v0.02", 1e-6), ("force-4", 1e-6), ("pdms-retraction-10nm", 1e-6), ("instruments:310", 1e-4)],
)
def test_an_accepted_row_satisfies_the_next_step(name, near, monkeypatch):
    """The residual does not change when fields come from the table: else it is noise that steps shrink by."""
    run, worst, record = Run(scene_of(name)), [], Run._accepted

    def checked(run, trial, arrival, state, s):
        record(run, trial, arrival, state, s)
        tracker = run.tracker
        if not trial.direction:
            return
        way, basis = np.zeros(5), np.zeros(5)
        way[1], basis[1] = trial.direction * 1e-9 * tracker.law.zone, 1.0
        again = Trial(
            tracker.body, state, tracker.leg, Segment(way, 0.0 * way, 0.0 * way, basis), tracker.law.zone
        )
        before = tracker.law.residual(trial, arrival, False)
        worst.append(tracker.law.residual(again, again.arrive(state.parameter), False) - before)

    monkeypatch.setattr(Run, "_accepted", checked)
    run.run()
    assert np.quantile(np.abs(worst), 0.95) < near


@pytest.mark.parametrize("name", [name for name in names() if not name.startswith("bulk")])
def test_starts_are_those_of_today(name):
    """Which interpolates the shape of a profile between nodes, and is 1e-8 off with a table."""
    scene = load(name).scene
    body = Body(rheology(scene.material), transform(scene.indenter))
    law = Griffith(scene.adhesion) if scene.is_adhesive else NoTension()
    start, today = elastic_start(scene, body), start_surface(scene, body, law)
    assert start.penetration == pytest.approx(today.penetration, rel=1e-12)
    assert start.radius == pytest.approx(today.radius, rel=1e-12 if not body.transform.knots.size else 2e-8)


SCENES = {
    "cycle-v0.02": 1e-5,
    "elastic-relaxed": 1e-5,
    "dwell-1": 1e-5,
    "cone-cycle": 1e-5,
    "force-4": 2e-5,
    "spring-elastic": 1e-5,
    "afm-si": 1e-5,
    "hysteresis-si": 1e-5,
    "rated-edge-si": 2e-5,
    "fixed-stress-si": 1e-5,
    "punch-programme": 1e-5,
    "adhesionless-cycle": 1e-5,
    "pdms-retraction-10nm": 1e-5,
    "instruments:113": 1e-5,  # a punch comes off as a whole
    "plain:208": 1e-12,  # a cone without adhesion comes off in a point
    "plain:414": 1e-12,  # a punch is let go in the rounding of its penetration
    "instruments:115": 1e-5,  # a rim is left for a slow way
    "short-zones:114": 2e-5,  # a fold in the rounding of the time
    "short-zones:306": 1e-5,  # a closing edge with a rate law sets off
}


@pytest.fixture(scope="module")
def runs():
    """Both solvers on a scene, each run once."""

    @functools.cache
    def both(name: str) -> tuple[Trace, Trace]:
        scene = scene_of(name)
        return solve(scene), tracking.solve(scene)

    return both


@pytest.mark.parametrize("name", SCENES)
def test_scenes_end_as_today(name, runs):
    """Pull-off, time of loss and largest radius."""
    mine, today = (measures(trace) for trace in runs(name))
    trace, near = runs(name)[1], SCENES[name]
    assert mine["pull_off"] == pytest.approx(
        today["pull_off"], rel=near, abs=1e-9 * np.abs(trace.force).max()
    )
    assert mine["outcome"] == today["outcome"]
    for quantity in ("time", "largest"):
        assert mine[quantity] == pytest.approx(today[quantity], rel=near)


@pytest.mark.parametrize("name", SCENES)
def test_energies_are_those_of_today(name, runs):
    """All energies, at the end of contact and after it, relative to the largest energy of the run."""
    traces = runs(name)
    scale = max(np.abs(traces[1].external_work).max(), traces[1].stored_energy.max())
    columns = [trace.columns() for trace in traces]
    for quantity in ("external_work", "dissipated_energy", "branch_dissipation", "separation_energy"):
        near = 2e-4 if name.startswith("rated") else 1e-5  # ends 1e-4 zones before the model does
        assert columns[0][quantity][-1] == pytest.approx(columns[1][quantity][-1], abs=near * scale)


@pytest.mark.parametrize("name", ["cycle-v0.02", "force-4", "afm-si", "adhesionless-cycle"])
def test_rows_are_straight_and_stops_change_nothing(name):
    """Rows asked for lie on the lines through those of a run without, but for the tolerance."""
    scene, without = load(name).scene, solve(load(name).scene)
    stops = without.time[-1] * np.linspace(0.003, 0.997, 150)
    stops = stops[~np.isin(stops, without.time)]
    trace = solve(scene, Options(stop_times=tuple(stops)))
    assert np.isin(without.time, trace.time).all()
    for column in ("force", "contact_radius"):
        values, plain = getattr(trace, column), getattr(without, column)
        assert values[np.isin(trace.time, stops)] == pytest.approx(
            np.interp(stops, without.time, plain), abs=3e-5 * np.abs(plain).max()
        )
        assert values[~np.isin(trace.time, stops)] == pytest.approx(plain, rel=1e-12)


def test_the_force_is_that_of_the_surface(monkeypatch):
    """Sums over the contact, step by step, against the table of passages: steps of many relaxation times."""
    worst, record = [], Run._accepted

    def checked(run, trial, arrival, state, s):
        record(run, trial, arrival, state, s)
        if trial.direction <= 0.0:
            return
        near = state.radius * (1.0 - np.geomspace(1e-12, 1.0, 200)[::-1])
        breaks = np.union1d(near, state.edges_between(0.0, state.radius))
        width, rheology = np.diff(breaks), trial.body.rheology
        x = (breaks[:-1, None] + width[:, None] * NODES).ravel()
        G = trial.body.transform(x)
        carried = state.surface.at(x, G, state.time, rheology.times, rheology.retardation)[1]
        q = rheology.stress(carried + rheology.moduli * state.memory, state.depth - G)
        worst.append(2.0 * (width[:, None] * WEIGHTS).ravel() @ q - state.force)

    monkeypatch.setattr(Run, "_accepted", checked)
    trace = solve(load("cycle-v2e-5").scene)
    assert np.abs(worst).max() < 1e-5 * trace.force.max()


def test_a_zone_of_fixed_stress_that_fills_its_contact_ends_the_run():
    scene = load("fixed-stress-si").scene
    adhesion = Adhesion(scene.adhesion.work, stress=0.4 * scene.adhesion.stress)
    material = replace(scene.material, branches=(Branch(10.0 * scene.material.modulus, 0.1),))
    scene = replace(scene, adhesion=adhesion, material=material)
    trace, today = solve(scene), tracking.solve(scene)
    assert trace.outcome.kind is today.outcome.kind is OutcomeKind.BELOW_ZONE
    assert trace.time[-1] == pytest.approx(today.time[-1], rel=2e-5)


@pytest.mark.parametrize(
    ("name", "pull_off"),
    [
        ("usual:216", 2.49687e-07),  # where the zone leaves a kink
        ("usual:120", 2.037228e-08),  # at an instant, between two steps of a jump
        ("usual:112", 1.878923e-03),  # in a jump over knots of a profile
    ],
)
def test_the_least_force(name, pull_off):
    trace = solve(scene_of(name))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert -trace.force.min() == pytest.approx(pull_off, rel=1e-5)


def test_rows_of_a_table_on_a_straight_line_are_no_kinks():
    scene = load("cycle-v0.02").scene
    steps = []
    for count in (3, 1000):
        times = np.linspace(0.0, 2.0, count)
        table = Table(tuple(times.tolist()), tuple((-0.01 * times).tolist()))
        loading = replace(scene.loading, steps=(table,))
        steps.append(solve(replace(scene, loading=loading)).counters.steps)
    assert steps[0] == steps[1]


def test_an_edge_that_closes_on_a_ragged_profile_jumps_ahead():
    trace = solve(scene_of("plain:218"))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(249.9568, rel=1e-6)
    assert trace.contact_radius.max() == pytest.approx(4.610647e-4, rel=1e-5)


def test_rows_within_a_step_are_right_where_branches_relax_in_a_small_part_of_it():
    trace = solve(scene_of("plain:211"))
    assert -trace.force.min() == pytest.approx(0.0217459, rel=1e-4)
