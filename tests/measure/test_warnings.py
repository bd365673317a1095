"""A loss that falls is measured, told and judged."""

from __future__ import annotations

import numpy as np
import pytest
from support.closed_forms.starting_edge import closing
from support.synthetic_traces import trace

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere
from validation.cases import Case, load
from validation.compare.checks import check_case
from validation.measure.observables import largest_fall, measure
from validation.report.tables import left_out_by_all
from validation.runs.run import Run, fall_warnings, run


def falling(loss):
    """Four rows at the times 0 to 3."""
    return trace(np.arange(4.0), np.zeros(4), loss=loss)


@pytest.mark.parametrize(
    ("loss", "fall", "told"),
    [
        ([0.0, 1.0, 2.0, 3.0], (0.0, 0, 0), ""),
        ([0.0, 3.0, 2.0, 2.5], (1.0, 1, 2), "t = 1 to 2"),
        ([0.0, -1.0, -2.0, 5.0], (2.0, 0, 2), "t = 0 to 2"),  # lower from row to row
        ([0.0, 2.0, 2.0, 0.0], (3.0, 1, 3), "t = 1 to 3"),  # from a corner between rows
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


@pytest.mark.parametrize("name", ["reference", "bem", pytest.param("fem", marks=pytest.mark.slow)])
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


def test_work_left_out_is_told_by_its_counters():
    work = {"bem": {"closure_evaluations": 3, "history_updates": 1, "volume_solves": 0}, "new": {"steps": 1}}
    assert left_out_by_all(work).startswith("Nothing was left out")
    assert "fem: no history was carried." in left_out_by_all(work | {"fem": {"history_updates": 0}})
