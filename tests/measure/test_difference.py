"""The subtraction of two runs, and what it is relative to, in numbers worked out by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.exam_answers import hertz_run
from support.synthetic_traces import trace

from validation.cases import load
from validation.measure.difference import of_curves, of_movements, of_numbers, relative
from validation.measure.observables import observe
from validation.measure.scaling import LOSSES, Magnitudes, scale
from validation.measure.windows import windows

BASE = hertz_run()
LARGEST = float(BASE.trace.force.max())
NAME = "approach_force"


@pytest.mark.parametrize(
    ("value", "expected", "error", "of_largest"),
    [(0.6, 0.5, 0.2, 0.1), (0.4, 0.5, -0.2, -0.1), (0.02, 0.01, 0.2, 0.01), (None, 0.5, math.inf, math.inf),
     (0.5, None, math.inf, math.inf)],
)  # fmt: skip
def test_numbers_are_relative_to_themselves_or_to_the_largest(value, expected, error, of_largest):
    run, base = (
        replace(BASE, measures={NAME: None if x is None else x * LARGEST}, errors={NAME: known})
        for x, known in ((value, 1e-3), (expected, 2e-3))
    )
    for names, found in (((), error), ((NAME,), of_largest)):
        (one,) = of_numbers(run, base, (NAME, "final_force"), names)
        assert (one.quantity, one.own, one.known_to) == (NAME, 1e-3, 2e-3)
        assert one.error == pytest.approx(found)
        assert bool(one.missing) is (value is None or expected is None)
        assert bool(one.disagreement(1.0)) is (one.missing != "" or abs(found) > 3e-3)


def test_a_gap_over_nothing_is_infinite():
    assert relative(0.0, 0.0) == 0.0
    assert (relative(1e-9, 0.0), relative(-1e-9, 0.0)) == (math.inf, -math.inf)


def test_curves_and_their_movement():
    """Twice the force is off by its root mean square over its largest, and by its spread in the window."""
    twice = replace(BASE, trace=replace(BASE.trace, force=2.0 * BASE.trace.force))
    spans = windows(load(BASE.scene).scene.loading, BASE.trace)[:1]
    force, radius = of_curves(twice, BASE, spans)
    assert force.error**2 == pytest.approx(0.25, rel=1e-3)  # mean of (depth^1.5)^2, depth even in time
    assert radius.error == 0.0
    moved, still = of_movements(twice, BASE, spans)
    assert moved.error**2 == pytest.approx(0.25 - 0.4**2, rel=1e-3)
    assert still.error == 0.0
    assert list(of_movements(twice, BASE, spans[:0])) == []


RUN = trace([0.0, 0.03, -0.01], [-1.0, 4.0, -2.0], [0.1, 0.2, 0.05], [0.0, 1e-6, 1e-5])
WORKED = replace(RUN, external_work=np.array([0.0, 0.06, -1e-9]), stored_energy=np.array([0.02, 0.08, 0.0]))
STAGED = replace(RUN, extra={"stage": np.array([0.0, 0.05, -0.08])})


@pytest.mark.parametrize(
    ("run", "name", "value", "size"),
    [
        (RUN, "pull_off_penetration", 1e-9, 0.03),
        (RUN, "start_force", 3.0, 3.0),
        (RUN, "start_force", 1e-9, 0.05 * 4.0),
        (RUN, "final_radius", 0.0, 0.05 * 0.2),
        (RUN, "peak_cycle_loss", 5.0, 5.0),
        (WORKED, "loop_energy", -1e-9, 0.05 * 0.06),  # work that nearly cancels
        (WORKED, "loop_energy", -0.5, 0.5),
        (WORKED, "peak_cycle_loss", 1e-20, 0.05 * 0.08),
        (STAGED, "stage_at_detachment", 1e-9, 0.08),  # the zero of a stage is a matter of choice
        (RUN, "stage_at_detachment", 1e-9, 0.03),
        *((WORKED, name, 1e-9, 0.08) for name in LOSSES),
    ],
)
def test_each_kind_of_quantity_has_its_scale(run, name, value, size):
    assert scale(name, value, run) == pytest.approx(size)


def test_scalars_stand_in_for_rows():
    measures = {**observe(RUN).as_dict(), "branch_dissipation": 3.0, "outcome": "completed", "refused": True}
    largest, rows = Magnitudes.of_measures(measures), Magnitudes.of_trace(RUN)
    for column in ("force", "contact_radius", "penetration", "time"):
        assert largest.columns[column] == pytest.approx(rows.columns[column])
    assert largest.balance == 3.0
    assert Magnitudes.of_measures({"loop_energy": -2e-9}).scale("loop_energy", -2e-9) == 2e-9
    assert Magnitudes.of_measures({"approach_penetration": 0.03}).scale("stage_at_detachment", 1e-9) == 0.03
    assert Magnitudes.of_measures({}).balance == 0.0
