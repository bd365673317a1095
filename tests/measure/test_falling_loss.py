"""A loss that falls is measured, told, and judged."""

from __future__ import annotations

import numpy as np
import pytest
from support.synthetic_traces import trace

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere
from validation.cases import Case, load
from validation.compare.checks import check_case
from validation.measure.observables import largest_fall, measure
from validation.measure.warnings import fall_warnings
from validation.reference.starting_edge import closing
from validation.runs.run import Run, run


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
    adhesive, without = load("elastic-relaxed").scene, load("elastic-press").scene
    assert measure(made, adhesive, 0.0)["loss_fall"] == pytest.approx(fall[0])
    for scene, why in ((adhesive, "closure"), (without, "error of the solver")):
        assert [told in text and why in text for text in fall_warnings(scene, made, 0.01)] == [True] * bool(
            told
        )


@pytest.mark.parametrize("solver", ["reference", "bem", "fem"])
@pytest.mark.parametrize(("zone", "rate", "falls"), [(0.008, 1.0, True), (1e-5, 1e-3, False)])
def test_a_relaxed_contact_pressed_fast_is_told_by_every_solver(solver, zone, rate, falls):
    """At a rate of 1 the loss falls by a fifth of the largest stored energy, as the closed form has it."""
    work, material = 3.652e-4, Material(1.0, 0.5, (Branch(9.0, 1.0),))
    loading = Loading("relaxed", 0.0, (Ramp(0.003, rate),))
    found = run(Case("pressed", Scene(material, Sphere(1.0), loading, Adhesion(work, zone))), solver)
    assert any("loss falls" in text for text in found.warnings) is falls
    if falls:
        radius = found.trace.contact_radius
        expected = closing(10.0, (radius[-1] - radius[0]) / zone) * work * 2.0 * np.pi * radius[0] * zone
        assert found.measures["loss_fall"] == pytest.approx(expected, rel=0.05)
        assert found.measures["loss_fall"] == pytest.approx(3.926e-6, rel=0.002)


@pytest.mark.parametrize(("name", "right"), [("elastic-press", False), ("elastic-relaxed", True)])
def test_a_loss_that_falls_alike_in_all_solvers_passes_with_adhesion_only(name, right):
    case = load(name)
    made = falling([0.0, 3.0, 2.0, 4.0])
    runs = {
        solver: Run(name, solver, made, measures=measure(made, case.scene, 0.0))
        for solver in ("reference", "bem")
    }
    found = [check.passed for check in check_case(case, runs) if check.quantity == "loss_fall"]
    assert found == ([True] if right else [False, False, True])


def test_a_loss_that_falls_in_one_solver_alone_fails():
    case = load("elastic-relaxed")
    runs = {}
    for solver, loss in (("reference", [0.0, 1.0, 2.0, 4.0]), ("bem", [0.0, 3.0, 2.0, 4.0])):
        made = falling(loss)
        runs[solver] = Run(case.name, solver, made, measures=measure(made, case.scene, 0.0))
    assert [check.passed for check in check_case(case, runs) if check.quantity == "loss_fall"] == [False]
