"""Sweeps by the batch solver: what it gives, what the reference adds, and what ends in the middle."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from support.wrong_values import refusal

import crosscontact as cc
from validation.reference import batch
from validation.sweeps import batch_runs, run_plan
from validation.sweeps.dataset import to_dataset, write_results
from validation.sweeps.plan import builtin_or_file, plan_from_dict
from validation.sweeps.run_plan import carry_out, forecast, solved_again, store_of

SCENE = "retraction-fast"
ZONES = [0.0065, 0.013, 0.2]
"""The last is as long as the contact: there is no answer by the batch solver."""


def plan_of(tmp_path, **more):
    speed = {"name": "speed", "key": "loading.steps.0.rate", "values": [0.1, 0.3, 1.0]}
    zone = {"name": "zone", "key": "adhesion.zone", "values": [0.0065, 0.013]}
    asked = {"solver": "batch", "coordinates": [speed, zone], "drawn": []}
    return plan_from_dict(asked | more, tmp_path, builtin_or_file(SCENE, tmp_path))


@pytest.fixture
def few(monkeypatch):
    """Batches of two runs, and two runs solved again."""
    monkeypatch.setattr(run_plan, "TOGETHER", 2)
    monkeypatch.setattr(run_plan, "LEAST_SAMPLE", 2)


def test_runs_of_the_batch_solver_stand_beside_those_of_the_reference():
    found = cc.sweep(SCENE, {"adhesion.zone": ZONES}, "batch")
    alone = cc.sweep(SCENE, {"adhesion.zone": ZONES}, "reference")
    assert found.solved_by.values.tolist() == ["batch", "batch", "reference"]
    assert found.outcome.equals(alone.outcome)
    assert found.attrs["solver"] == "batch"
    assert found.attrs["solved_again"] == 2  # all there are of the batch solver
    for name in ("pull_off_force", "pull_off_time", "pull_off_penetration", "start_radius"):
        apart = np.abs(found[name] / alone[name] - 1.0).values
        assert apart[:2].max() < 1e-4
        if name == "pull_off_force":
            assert found[name].attrs["largest_difference"] == pytest.approx(apart[:2].max(), rel=1e-3)
        assert np.array_equal(found[name].values[2], alone[name].values[2], equal_nan=True)
    for name in ("dissipated_energy", "loop_energy", "pull_off_radius"):  # the batch solver gives none
        assert name not in found or np.isnan(found[name].values[:2]).all()
    assert found.pull_off_force_error.values[:2].max() < 1e-4
    assert "solved_by" not in alone


def test_runs_on_a_spring():
    """What holds of the stage too."""
    stiffness = {"machine.stiffness": [0.3, 10.0]}
    found, alone = (cc.sweep(SCENE, stiffness, solver) for solver in ("batch", "reference"))
    assert (found.solved_by == "batch").all()
    for name in ("pull_off_force", "detachment_time", "stage_at_detachment", "detachment_penetration"):
        assert found[name].values == pytest.approx(alone[name].values, rel=1e-4)
    assert "instability_loss" not in found or np.isnan(found.instability_loss).all()


def test_a_run_that_is_never_pulled_has_no_error_of_its_pull_off():
    """A number of 2e-5 stood beside no pull-off force."""
    found = cc.sweep(SCENE, {"loading.steps.0.to": [-0.5, 0.031]}, "batch")
    for name in ("pull_off_force", "pull_off_force_error", "pull_off_time_error"):
        assert np.isnan(found[name].values).tolist() == [False, True], name


@pytest.mark.parametrize(
    ("values", "more", "said"),
    [
        ({"loading.start": ["snap-in"]}, {}, "does not take the start 'snap-in' at loading.start"),
        ({"adhesion.zone": [0.01]}, {"measures": ["dissipated_energy"]}, "gives no 'dissipated_energy'"),
        ({"adhesion.zone": [0.01]}, {"resolution": 4}, "resolution: got 4"),
    ],
)
def test_what_does_not_qualify_is_refused_by_name(values, more, said):
    assert said in str(refusal(cc.sweep, SCENE, values, "batch", **more)).replace('"', "'")


def test_an_interrupted_sweep_goes_on_and_gives_the_same_bits(few, tmp_path, monkeypatch):
    plan, calls = plan_of(tmp_path), []
    inner = batch.solve
    monkeypatch.setattr(batch, "solve", lambda *asked: calls.append(len(asked[0])) or inner(*asked))
    folders = [tmp_path / name for name in ("whole", "parts")]
    for folder in folders:
        folder.mkdir()
    with store_of(folders[0]) as store:
        runs = solved_again(plan, carry_out(plan, store))
        assert forecast(plan, store).stored == 6
        assert len(runs.again) == 2
        write_results(plan, runs, folders[0])

    def interrupt(share, text):
        raise KeyboardInterrupt

    for _ in range(2):
        with store_of(folders[1]) as store, pytest.raises(KeyboardInterrupt):
            carry_out(plan, store, None, interrupt)
    with store_of(folders[1]) as store:
        write_results(plan, solved_again(plan, carry_out(plan, store)), folders[1])
    assert calls == [2] * 6  # nothing twice
    assert (folders[0] / "sweep.nc").read_bytes() == (folders[1] / "sweep.nc").read_bytes()


def test_any_executor_gives_the_same_and_a_batch_that_breaks_down_costs_no_run(few, tmp_path, monkeypatch):
    plan = plan_of(tmp_path, measures=["pull_off_force"], estimate=False)
    with store_of() as store:
        here = to_dataset(plan, carry_out(plan, store))
    with store_of() as store, ThreadPoolExecutor(2) as executor:
        there = to_dataset(plan, carry_out(plan, store, run_plan.Engine(executor)))
    assert there.identical(here)
    assert (here.solved_by == "batch").all()
    inner = batch_runs.batch.solve

    def breaking(scenes, *asked):
        if scenes[0].loading.steps[0].rate == 0.3:
            raise MemoryError
        return inner(scenes, *asked)

    monkeypatch.setattr(batch_runs.batch, "solve", breaking)
    with store_of() as store:
        other = to_dataset(plan, carry_out(plan, store))
    assert other.solved_by.values.tolist() == [["batch"] * 2, ["reference"] * 2, ["batch"] * 2]
    assert np.abs(other.pull_off_force / here.pull_off_force - 1.0).max() < 1e-4


def test_an_answer_that_is_not_known_to_a_hundredth_is_left_to_the_reference(tmp_path, monkeypatch):
    plan = plan_of(tmp_path, measures=["pull_off_force"], estimate=False)
    inner = batch.solve

    def doubtful(scenes, *asked):
        found = inner(scenes, *asked)
        return [replace(found[0], errors={"pull_off_force": 0.1}), *found[1:]]

    monkeypatch.setattr(batch, "solve", doubtful)
    with store_of() as store:
        data = to_dataset(plan, carry_out(plan, store))
    assert data.solved_by.values.ravel().tolist() == ["reference", *["batch"] * 5]


def test_traces_have_the_columns_that_are_known(few, tmp_path):
    h5py = pytest.importorskip("h5py", reason="it is not installed")
    plan = plan_of(tmp_path, traces="hdf5")
    with store_of(tmp_path) as store:
        write_results(plan, carry_out(plan, store), tmp_path)
    with h5py.File(next((tmp_path / "traces").iterdir())) as file:
        assert sorted(file["0000003"]) == sorted(batch_runs.COLUMNS)
        assert file["0000003"]["force"][:].min() < 0.0
