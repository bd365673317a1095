"""What differences are relative to: one rule, from the rows of a run or from its scalars."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.synthetic_traces import trace

from validation.measure.observables import observe
from validation.measure.scaling import LOSSES, Magnitudes, column_of, scale

DEPTH, FORCE = [0.0, 0.03, -0.01], [-1.0, 4.0, -2.0]
RUN = trace(depth=DEPTH, force=FORCE, radius=[0.1, 0.2, 0.05], loss=[0.0, 1e-6, 1e-5])


def test_each_kind_of_quantity():
    assert scale("pull_off_penetration", 1e-9, RUN) == pytest.approx(0.03)
    assert scale("start_force", 3.0, RUN) == 3.0
    assert scale("start_force", 1e-9, RUN) == pytest.approx(0.2)
    assert scale("final_radius", 0.0, RUN) == pytest.approx(0.01)
    assert scale("peak_cycle_loss", 5.0, RUN) == 5.0
    for name in LOSSES:
        assert scale(name, 1e-9, RUN) == Magnitudes.of_trace(RUN).balance > 1e-9


def test_work_that_nearly_cancels_is_not_divided_by_itself():
    worked = dataclasses.replace(
        RUN, external_work=np.array([0.0, 0.06, -1e-9]), stored_energy=np.array([0.02, 0.08, 0.0])
    )
    assert scale("loop_energy", -1e-9, worked) == pytest.approx(0.05 * 0.06)
    assert scale("loop_energy", -0.5, worked) == 0.5
    assert scale("peak_cycle_loss", 1e-20, worked) == pytest.approx(0.05 * 0.08)
    assert Magnitudes.of_measures({"loop_energy": -2e-9}).scale("loop_energy", -2e-9) == 2e-9


def test_the_zero_of_a_stage_is_a_matter_of_choice():
    pulled = dataclasses.replace(RUN, extra={"stage": np.array([0.0, 0.05, -0.08])})
    assert scale("stage_at_detachment", 1e-9, pulled) == pytest.approx(0.08)
    assert scale("stage_at_detachment", 1e-9, RUN) == pytest.approx(0.03)
    assert Magnitudes.of_measures({"approach_penetration": 0.03}).scale("stage_at_detachment", 1e-9) == 0.03


def test_names_of_columns():
    assert column_of("approach_radius") == "contact_radius"
    assert column_of("stage_at_detachment") == "stage"
    assert column_of("zone_excess") == column_of("dissipated_energy") == ""


def test_scalars_stand_in_for_rows():
    measures = {**observe(RUN).as_dict(), "branch_dissipation": 3.0, "outcome": "completed", "refused": True}
    largest, rows = Magnitudes.of_measures(measures), Magnitudes.of_trace(RUN)
    for column in ("force", "contact_radius", "penetration", "time"):
        assert largest.columns[column] == pytest.approx(rows.columns[column])
    assert largest.balance == 3.0
    assert Magnitudes.of_measures({}).balance == 0.0
