"""The forecast of a run: counts worked out by hand, growth, agreement with real runs."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from support.table_rows import sampled

from benchmarks.cost_forecast import SCENES
from contact_scene import (
    Adhesion,
    Branch,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    Ramp,
    Scene,
    Sphere,
)
from fem_solver.setup_memory import setup_memory
from validation.cases import load_all
from validation.compare.suite import all_pairs
from validation.execution.solver_tasks import expected_seconds
from validation.scenes import suite
from validation.solvers import SOLVERS, Cost
from validation.solvers.cost import CostModel, forecast
from validation.solvers.finite_elements import FiniteElements
from validation.solvers.fitted_meshes import mesh_for
from validation.solvers.scene_work import scene_work

ELASTIC = Material(0.75, 0.5)
HERTZ = Scene(ELASTIC, Sphere(1.0), Loading("relaxed", 0.0, (Ramp(0.04, 0.01), Ramp(0.01, 0.01))))
FAR = 1e-2
"""Relative error of a path of the edge that is read from a table of radii."""


def test_a_path_worked_out_by_hand():
    """Hertz, a = sqrt(R D): to 0.2, back to 0.1; the largest radius has 2 % to spare."""
    work = scene_work(HERTZ)
    assert work.zones == pytest.approx(0.3 / (0.01 * 1.02 * 0.2), rel=5 * FAR)
    assert work.radius_in_zones == pytest.approx(100.0)
    assert (work.cycles, work.intervals, work.branches, work.decades) == (0.0, 2.0, 0, 0.0)


def test_cycles_go_there_and_back():
    """Between a(0.03) and a(0.05) and back, three times, with the way to the first ends of the load step."""
    shaken = replace(HERTZ, loading=Loading("relaxed", 0.04, (Oscillate(0.01, 2.0 * math.pi, 3.0),)))
    work = scene_work(shaken)
    assert work.cycles == pytest.approx(3.0)
    travel, zone = 6.0 * (math.sqrt(0.05) - math.sqrt(0.03)), 0.01 * 1.02 * math.sqrt(0.05)
    assert work.zones_of_cycles * zone == pytest.approx(travel, rel=10 * FAR)
    assert work.zones * zone == pytest.approx(0.2, rel=10 * FAR)


def test_an_oscillation_that_shakes_the_contact_off_is_not_carried_out():
    """|E*(i w)| = |1 + 9 i/(1 + i)| = 7.1 at w t = 1: contact is lost from an amplitude of D/7.1 on."""
    rubber = replace(HERTZ, material=Material(1.0, 0.5, (Branch(9.0, 1.0),)))
    cycles = {
        amplitude: scene_work(
            replace(rubber, loading=Loading("relaxed", 0.04, (Oscillate(amplitude, 1.0, 1e3),)))
        ).cycles
        for amplitude in (0.04 / 7.2, 0.04 / 7.0)
    }
    assert list(cycles.values()) == [pytest.approx(1e3 / (2.0 * math.pi)), 1.0]


def test_what_comes_after_the_loss_of_contact_is_not_counted():
    lost = Loading("relaxed", 0.01, (Ramp(-1.0, 0.1), Oscillate(1e-3, 1e3, 1e3)))
    assert scene_work(replace(HERTZ, adhesion=Adhesion(5e-4, 0.01), loading=lost)).cycles == 0.0


def test_under_force_control_the_edge_follows_the_force():
    """F = 4 E* a^3/(3 R) with E* = 1: 0.2 at 4 * 0.008/3, at half of it 0.2/2^(1/3)."""
    full = 4.0 * 0.008 / 3.0
    pressed = replace(HERTZ, loading=Loading("relaxed", 0.0, (Force(full, 1.0), ForceRamp(0.5 * full, 1.0))))
    work = scene_work(pressed)
    assert work.zones * 0.01 * 1.02 * 0.2 == pytest.approx(0.2 + 0.2 - 0.2 / 2.0 ** (1.0 / 3.0), rel=10 * FAR)


def test_decades_from_the_shortest_relaxation_to_the_end_of_each_load_step():
    material = replace(ELASTIC, branches=(Branch(1.0, 10.0), Branch(1.0, 0.1)))
    held = replace(
        HERTZ, material=material, loading=Loading("relaxed", 0.01, (Hold(100.0), Hold(0.01), Hold(1e17)))
    )
    assert scene_work(held).decades == pytest.approx(4.0 + 1.0 + 6.0)


def test_what_adds_up():
    model = CostModel(
        steps_per_division=2.0,
        steps_per_decade=3.0,
        steps_per_cycle=5.0,
        steps_per_interval=7.0,
        adhesionless_steps_per_division=1.5,
        steps_per_division_of_cycle=0.5,
        steps_of_elastic_interval=100.0,
        seconds_of_setup=(1.0, 0.5),
        seconds_of_step=(0.1, 0.0, 0.01),
        share_of_branch=0.5,
        share_of_elastic_step=0.25,
        share_of_adhesionless_step=0.2,
        share_of_turn=0.1,
        bytes_of_run=(10.0, 1.0),
        bytes_of_row=3.0,
    )
    work = replace(
        scene_work(HERTZ),
        zones=10.0,
        zones_of_cycles=5.0,
        decades=2.0,
        cycles=4.0,
        intervals=6.0,
        branches=3,
        adhesive=True,
    )
    cycles = 5.0 * 4.0 + 0.5 * 4.0 * 5.0
    steps = 2.0 * 4.0 * 10.0 + 3.0 * 2.0 + cycles + 7.0 * 6.0
    step = 0.1 + 0.01 * 400.0
    assert forecast(model, work, 4, 20.0) == Cost(
        steps, pytest.approx(11.0 + steps * step * 2.0 * 2.4), 30.0 + 3.0 * steps, 11.0, 30.0
    )
    free = replace(work, adhesive=False)
    found = forecast(model, free, 4, 20.0)
    assert found.steps == pytest.approx(steps - 0.5 * 40.0)
    assert found.seconds == pytest.approx(11.0 + found.steps * step * 2.0 * 2.4 * 0.2)
    elastic = forecast(model, replace(work, branches=0), 4, 20.0)
    assert elastic.steps == 100.0 * 6.0 + cycles + 42.0
    assert elastic.seconds == pytest.approx(11.0 + elastic.steps * step * 0.25)


@pytest.mark.parametrize("name", SOLVERS)
def test_more_is_never_cheaper(name):
    base, solver = SCENES["one branch"], SOLVERS[name]
    more = {
        "zone": replace(base, adhesion=Adhesion(5e-4, 1.3e-3)),
        "branches": replace(
            base, material=Material(0.75, 0.5, tuple(Branch(0.1, 1.0 + n) for n in range(200)))
        ),
        "steps": replace(base, loading=Loading("jump-in", 0.0, base.loading.steps[:1] * 10_000)),
    }
    usual = solver.expected_cost(base)
    assert solver.expected_cost(base, 2 * solver.default_resolution(base)).steps > 1.5 * usual.steps
    # a step is a share of a zone where zones are long, and passes over any number of short ones
    longer, tenth = (replace(base, adhesion=Adhesion(5e-4, zone)) for zone in (0.026, 1.3e-4))
    assert usual.steps > 1.4 * solver.expected_cost(longer).steps
    assert solver.expected_cost(tenth).steps >= solver.expected_cost(more["zone"]).steps
    assert solver.expected_cost(tenth).seconds >= solver.expected_cost(more["zone"]).seconds
    assert solver.expected_cost(more["branches"]).seconds > 1.5 * usual.seconds
    assert solver.expected_cost(more["steps"]).steps > 10_000
    assert solver.expected_cost(more["zone"]).bytes > usual.bytes


def test_finite_elements_announce_gigabytes_where_the_mesh_cannot_follow_the_edge():
    fine = replace(SCENES["one branch"], adhesion=Adhesion(5e-4, 1e-3))
    assert FiniteElements(path="quadrature").expected_cost(fine).bytes > 1e9
    assert SOLVERS["fem"].expected_cost(fine).bytes < 1e9
    assert SOLVERS["fem"].expected_cost(SCENES["one branch"]).bytes < 3e8


@pytest.mark.parametrize("zone", [1e-2, 1e-5])
def test_an_edge_that_rests_on_its_rim_takes_a_mesh_that_is_fine_there_alone(zone):
    """The memory is that which the set-up works out from the mesh: 0.1 and 0.16 GB."""
    loading = Loading("relaxed", 0.01, (Ramp(0.02, 0.01),))
    punch = Scene(ELASTIC, FlatPunch(1.0), loading, Adhesion(1e-6, zone))
    mesh = mesh_for(punch, None)
    radii = mesh.points[0][mesh.points[1] == 0.0]
    intervals = np.count_nonzero(radii <= 1.2 * mesh.parameters.fine_to)
    needed = setup_memory(intervals, mesh.points.shape[1])
    assert SOLVERS["fem"].expected_cost(punch).setup_bytes == pytest.approx(needed, rel=0.3)


def test_a_real_run_takes_as_many_steps_as_forecast():
    solver = SOLVERS["reference"]
    found = solver.solve(SCENES["one branch"]).counters.steps
    assert found / 2.0 <= solver.expected_cost(SCENES["one branch"]).steps <= 2.0 * found


HALF_A_MINUTE = [("fem", "one branch, short zone"), ("fem", "ten branches")]
"""Not run: the steps of the finite elements are those of their other scenes."""


@pytest.mark.parametrize(
    ("name", "label"), sampled((pair for pair in product(SOLVERS, SCENES) if pair not in HALF_A_MINUTE), 2)
)
def test_forecasts_hold_within_a_factor_of_three(name, label):
    solver = SOLVERS[name]
    found = solver.solve(SCENES[label]).counters.steps
    assert found / 3.0 <= solver.expected_cost(SCENES[label]).steps <= 5.0 * found


@pytest.mark.parametrize("name", SOLVERS)
def test_a_scene_beyond_all_bounds_has_a_forecast(name):
    endless = replace(SCENES["one branch"], adhesion=Adhesion(1e-60, 1e-60), indenter=Sphere(1e60))
    assert SOLVERS[name].expected_cost(endless).seconds > 0.5


MOST_OF_QUICK = 95.0
"""Processor seconds that the forecasts of the quick suite may add up to, error estimates left out: 86 as this
was written, less than a minute on two cores."""


def test_the_quick_suite_stays_quick():
    pairs = all_pairs(load_all(suite("quick")))
    assert sum(expected_seconds(case, solver) for case, solver in pairs) < MOST_OF_QUICK


def test_short_zones_cost_no_more_steps():
    """Reference and boundary elements step over any number of zones."""
    rubber = replace(HERTZ, material=Material(0.75, 0.5, (Branch(6.75, 1.0),)))
    steps = {
        solver: [
            SOLVERS[solver].expected_cost(replace(rubber, adhesion=Adhesion(5e-4, zone))).steps
            for zone in (1e-4, 1e-6)
        ]
        for solver in ("reference", "bem")
    }
    assert steps["reference"][1] == pytest.approx(steps["reference"][0], rel=0.01)
    assert steps["bem"][1] == pytest.approx(steps["bem"][0], rel=0.01)
