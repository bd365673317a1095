"""A loss that falls, and swings of the edge over few nodes, are measured and told; a fall is judged."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.closed_forms.starting_edge import closing
from support.synthetic_traces import trace

from contact_scene import Adhesion, Branch, Hold, Loading, Material, Oscillate, Ramp, Scene, Sphere
from validation.cases import Case, load
from validation.compare.checks import check_case
from validation.measure.observables import largest_fall, measure
from validation.measure.warnings import fall_warnings, left_out_by_all, swing_warnings
from validation.runs.run import Run, run
from validation.solvers import solver


def falling(loss):
    """Four rows at the times 0 to 3."""
    return trace(np.arange(4.0), np.zeros(4), loss=loss)


@pytest.mark.parametrize(
    ("loss", "fall", "told"),
    [
        ([0.0, 1.0, 2.0, 3.0], (0.0, 0, 0), ""),
        ([0.0, 3.0, 2.0, 2.5], (1.0, 1, 2), "t = 1 to 2"),
        ([0.0, -1.0, -2.0, 5.0], (2.0, 0, 2), "t = 0 to 2"),  # lower from row to row
        ([0.0, 3.0, 2.991, 4.0], (3.0 - 2.991, 1, 2), ""),  # within 1 % of the loss
    ],
)
def test_a_loss_that_falls_is_measured_and_told_beyond_its_error(loss, fall, told):
    made = falling(loss)
    assert largest_fall(made) == pytest.approx(fall)
    for name, why in (("elastic-relaxed", "closure"), ("elastic-press", "error of the solver")):
        scene = load(name).scene
        assert measure(made, scene, 0.0)["loss_fall"] == pytest.approx(fall[0])
        said = fall_warnings(scene, made, 0.01)
        assert [told in text and why in text for text in said] == [True] * bool(told)


@pytest.mark.parametrize(
    ("name", "alone", "right"),
    [
        ("elastic-press", False, [False, False, True]),
        ("elastic-relaxed", False, [True]),
        ("elastic-relaxed", True, [False]),
    ],
)
def test_a_loss_that_falls_alike_in_all_solvers_passes_with_adhesion_only(name, alone, right):
    case, runs = load(name), {}
    for method in ("reference", "bem"):
        made = falling([0.0, 1.0 if alone and method == "reference" else 3.0, 2.0, 4.0])
        runs[method] = Run(name, method, made, measures=measure(made, case.scene, 0.0))
    found = [check.passed for check in check_case(case, runs) if check.quantity == "loss_fall"]
    assert found == right


@pytest.mark.parametrize("name", ["reference", "bem", "fem"])
@pytest.mark.parametrize(("zone", "rate", "falls"), [(0.008, 1.0, True), (1e-5, 1e-3, False)])
def test_a_relaxed_contact_pressed_fast_is_told_by_every_solver(name, zone, rate, falls):
    """At a rate of 1 the loss falls by a fifth of the largest stored energy, as the closed form has it."""
    work, material = 3.652e-4, Material(1.0, 0.5, (Branch(9.0, 1.0),))
    loading = Loading("relaxed", 0.0, (Ramp(0.003, rate),))
    found = run(Case("pressed", Scene(material, Sphere(1.0), loading, Adhesion(work, zone))), name)
    assert any("loss falls" in text for text in found.warnings) is falls
    if falls:
        radius = found.trace.contact_radius
        expected = closing(10.0, (radius[-1] - radius[0]) / zone) * work * 2.0 * np.pi * radius[0] * zone
        assert found.measures["loss_fall"] == pytest.approx(expected, rel=0.05)


CYCLES, AMPLITUDE = 3, 0.01
OSCILLATION = Oscillate(1e-3, 2.0 * math.pi / 20.0, 20.0 * CYCLES)
WAVE = np.sin(2.0 * math.pi / 20.0 * np.arange(20 * CYCLES + 1))
GROWN = np.linspace(0.1, 1.0, WAVE.size)
WAY = np.linspace(0.1, 0.2, WAVE.size)


def swinging(radius=AMPLITUDE, depth=1e-3):
    """A run of as many cycles with 20 rows each."""
    return trace(0.1 + depth * WAVE, WAVE, 0.2 + radius * WAVE)


@pytest.mark.parametrize(
    ("made", "step", "spacing", "told"),
    [
        (swinging(), OSCILLATION, 0.0, ""),
        (swinging(), OSCILLATION, 2.0 * AMPLITUDE / 7.9, "over 7.9 nodes"),
        (swinging(), OSCILLATION, 2.0 * AMPLITUDE / 8.1, ""),
        (swinging(AMPLITUDE * GROWN), OSCILLATION, AMPLITUDE / 4.0, "from t = 0 to 20 "),  # the smallest
        (swinging(depth=0.0), Hold(60.0), 1.0, ""),  # rounding in a hold
        (trace(WAY, WAY, 0.1 + WAY), Ramp(0.2, 0.1 / 60.0), 1.0, ""),  # a way
        (swinging(radius=0.0), OSCILLATION, 1.0, ""),  # an edge that stays
    ],
)
def test_the_smallest_swing_over_few_nodes_is_told(made, step, spacing, told):
    found = swing_warnings(made, Loading("relaxed", 0.1, (step,)), spacing)
    assert [told in text for text in found] == [True] * bool(told)


SOFT = Scene(
    Material(1e6, 0.5, (Branch(3e6, 0.1),)),
    Sphere(1e-3),
    Loading("relaxed", 2e-5, (Oscillate(1.5e-7, 10.0, 1.2),)),
)


@pytest.mark.parametrize(("name", "warned"), [("bem", False), ("fem", True), ("reference", False)])
def test_solvers_that_know_the_edge_everywhere_do_not_warn(name, warned):
    found = run(Case("swing", SOFT), name)
    assert any("to and fro" in text for text in found.warnings) is warned
    assert found.trace is not None


@pytest.mark.slow
def test_an_elastic_solid_and_a_finer_mesh_are_not_in_doubt():
    elastic, fem = replace(SOFT, material=Material(1e6, 0.5)), solver("fem")
    assert run(Case("swing", elastic), "fem").warnings == run(Case("swing", SOFT), "fem", 8).warnings == ()
    assert fem.edge_spacing(elastic) == 0.0
    assert fem.edge_spacing(SOFT, 8) == pytest.approx(0.5 * fem.edge_spacing(SOFT))


def test_work_left_out_is_told_by_its_counters():
    work = {"bem": {"closure_evaluations": 3, "history_updates": 1, "volume_solves": 0}, "new": {"steps": 1}}
    assert left_out_by_all(work).startswith("Nothing was left out")
    assert "fem: no history was carried." in left_out_by_all(work | {"fem": {"history_updates": 0}})
