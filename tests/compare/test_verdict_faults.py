"""Wrong versions of norms, verdicts and meshes, one at a time: numbers worked out on paper show each."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.faults.injection import by, changed, gives, seeded, table, takes, times
from support.synthetic_traces import by_hand

from contact_scene import Loading, Material, Ramp, Scene, Sphere, Trace
from meshes import EdgeMeshes, surface
from validation.cases import Case, Expected
from validation.compare.checks import against_reference, check_run
from validation.measure import curves, difference
from validation.runs.run import Run

SCENE = Scene(Material(1.0, 0.5), Sphere(1.0), Loading("relaxed", 0.0, (Ramp(1.0, 0.5),)))
KNOWN = Expected("loop_energy", "by hand", value=1.0, tolerance={"bem": 0.01})
CASE = Case("by hand", SCENE, expected=(KNOWN,), tolerances={"bem": {"values": 0.01}})
TIMES = np.arange(5.0)


def trace(force: np.ndarray) -> Trace:
    return by_hand(TIMES[: len(force)], force=force)


def run(loop: float) -> Run:
    return Run("by hand", "bem", trace(TIMES), measures={"loop_energy": loop})


def compared(loop: float) -> difference.Check:
    checks = against_reference(CASE, run(loop), run(1.0))
    return next(one for one in checks if one.quantity == "loop_energy")


def rms():
    """Apart by 0.5 throughout; the largest value is 4."""
    return curves.distance(trace(TIMES + 0.5), trace(TIMES)).rms, 0.125


def mean():
    """``|t - 2|/2`` over four times, the first and the last half of which differ in sign."""
    return curves.distance(trace(TIMES), trace(np.full(5, 2.0))).mean, 0.5


def window():
    """They part evenly in the second window, by 1 at its end, where the excursion is 2."""
    apart = np.maximum(TIMES - 2.0, 0.0) / 2.0
    spans = np.array([[0.0, 2.0], [2.0, 4.0]])
    found = curves.movement_distance(trace(TIMES + apart), trace(TIMES), spans)
    return (found.rms, found.begin, found.end), (0.5 / math.sqrt(12.0), 2.0, 4.0)


def sign():
    return [compared(loop).difference for loop in (0.75, 1.25)], (-0.25, 0.25)


def sides():
    """Both verdicts on what is a quarter too small, right, and a quarter too large."""
    loops = 0.75, 1.0, 1.25
    stated = [check_run(CASE, run(loop))[-1].passed for loop in loops]
    return [compared(loop).passed for loop in loops] + stated, [False, True, False] * 2


def limit():
    found = [difference.agreement_limit(tolerance, 0.01, 0.02) for tolerance in (1.0, 0.02)]
    return found, (0.03, 0.02)


def grading():
    """Intervals 1, 2, 4: ``ln(1 + L)/ln 2 = 3`` of them."""
    return surface.graded(0.0, 7.0, math.log(2.0), math.log(2.0)), (0.0, 1.0, 3.0, 7.0)


def place():
    """A mesh is not scaled at the radius that its level is made for."""
    meshes = EdgeMeshes(2.0, 4, 1e6)
    return meshes.scale(meshes.place(2.0 * meshes.centre(3))), 2.0


CHECKS = {one.__name__: one for one in (rms, mean, window, sign, sides, limit, grading, place)}


def _next_row(true):
    def worst(grid, apart, values, spans, *given):
        return true(grid, apart, values, spans + grid[1] - grid[0], *given)

    return worst


FAULTS = table("reference", "validation", [
    ("RMS without its root", "measure.curves:distance", gives(changed(rms=lambda rms: rms**2)), "rms"),
    ("mean of a difference with its sign", "measure.curves:_mean_magnitude",
     lambda true: lambda apart: 0.5 * (apart[0] + apart[-1]), "mean"),
    ("windows one row late", "measure.curves:_worst_window", _next_row, "window"),
    ("mean of a window left in", "measure.curves:_worst_window", takes(centred=by(0.0)), "window"),
    ("sign of a difference dropped", "measure.difference:relative", gives(abs), "sign"),
    ("verdict of one side", "measure.difference:Difference.disagreement",
     takes(self=changed(error=lambda size: max(size, 0.0))), "sides"),
    ("check values of one side", "compare.checks:_stated",
     gives(lambda check: replace(check, passed=check.difference < 0.01)), "sides"),
    ("estimates three times too generous", "measure.difference:agreement_limit",
     lambda true: lambda tolerance, *errors: true(tolerance, *(e and 3.0 * e for e in errors)), "limit"),
], shared=True)  # fmt: skip
FAULTS += table("fem", "meshes", [
    ("grading 1 % too steep", "surface:graded", takes(grading=by(1.01)), "grading"),
    ("sizes 1 % too large", "surface:graded", takes(size=by(1.01)), "grading"),
    ("fine strip of the followed edge 1 % off", "around_edge:EdgeMeshes.scale", times(1.01), "place"),
])  # fmt: skip
"""Each with the check that has to show it."""


def missed(name: str) -> bool:
    found, expected = CHECKS[name]()
    return not np.allclose(found, expected, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("name", CHECKS)
def test_numbers_on_paper_hold(name):
    assert not missed(name)


def test_every_check_has_its_fault():
    assert {name for fault in FAULTS for name in fault.scenes} == set(CHECKS)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.key)
def test_a_fault_shows(fault):
    (name,) = fault.scenes
    with seeded(fault) as calls:
        assert missed(name)
    assert calls.count > 0
