"""Sweeps carried out: labelled, nothing dropped, nothing run twice, the same bytes on any engine."""

from __future__ import annotations

import json
import os
import sqlite3
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import numpy as np
import pytest
import xarray
from support.spring_solver import FunctionSolver, named, small_scene, spring
from support.unlaid_figures import without_layout

import crosscontact as cc
from benchmarks.sweep_price import plan_of
from contact_scene import UnsupportedScene
from crosscontact.cli import main
from validation import solvers
from validation.runs import pool, store
from validation.runs.pool import Engine
from validation.sweeps import run_plan
from validation.sweeps.dataset import to_dataset
from validation.sweeps.plan import plan_from_dict
from validation.sweeps.run_plan import store_of, task_of

RATES = [0.01, 0.02, 0.05]
DEPTHS = [0.02, 0.03]


@pytest.fixture
def scene_file(tmp_path):
    return small_scene(tmp_path)


@pytest.fixture
def calls(monkeypatch):
    """Scenes that a stand-in for the boundary elements was asked for."""
    asked = []

    def solve(scene, resolution=None, **options):
        asked.append((scene.loading.steps[0].rate, scene.loading.steps[0].to))
        if scene.loading.steps[0].rate == 0.05 and scene.loading.steps[0].to == 0.03:
            raise UnsupportedScene("loading", "too fast", "slower ones")
        if scene.loading.steps[0].rate == 0.04:
            raise ArithmeticError("lost its way")
        return spring(2.0)(scene, resolution, **options)

    monkeypatch.setitem(solvers.SOLVERS, "bem", named("bem", FunctionSolver(solve, "bem")))
    return asked


def swept(scene_file, rates=RATES, **more):
    values = {
        ("loading.steps.0.rate", "loading.steps.1.rate"): rates,
        "loading.steps.0.to": DEPTHS,
    }
    return cc.sweep(scene_file, values, "bem", estimate_errors=False, measures=["approach_force"], **more)


def test_a_sweep_is_labelled_by_its_coordinates(scene_file, calls):
    data = swept(scene_file)
    assert data.approach_force.dims == ("loading.steps.0.rate", "loading.steps.0.to")
    found = data.approach_force.sel({"loading.steps.0.rate": 0.02, "loading.steps.0.to": 0.03})
    assert float(found) == pytest.approx(0.06)
    assert data.approach_force.attrs["units"] == "force"
    assert data["loading.steps.0.rate"].attrs["units"] == "length time-1"
    assert len(calls) == 6


def test_what_is_refused_or_breaks_down_stays_with_its_reason(scene_file, calls):
    data = swept(scene_file, [0.04, 0.05])
    assert data.outcome.values.tolist() == [["failed", "failed"], ["detached", "refused"]]
    assert data.reason.values[0, 0] == "ArithmeticError: lost its way"
    assert data.reason.values[1, 1] == "loading: too fast; allowed: slower ones"
    assert np.isnan(data.approach_force.values).tolist() == [[True, True], [False, True]]
    assert data.attrs["unfinished_runs"] == 3


def test_a_changed_plan_shares_its_runs_and_repeated_points_are_run_once(tmp_path, scene_file, calls):
    out = tmp_path / "out"
    first = swept(scene_file, out=out)
    bytes_of = {name: (out / name).read_bytes() for name in ("sweep.nc", "sweep.csv")}
    assert len(calls) == 6
    swept(scene_file, out=out)
    assert len(calls) == 6
    assert {name: (out / name).read_bytes() for name in bytes_of} == bytes_of
    wider = swept(scene_file, [*RATES, 0.03, 0.03], out=out)
    assert sorted(calls[6:]) == [(0.03, 0.02), (0.03, 0.03)]
    assert first.approach_force.equals(wider.approach_force.isel({"loading.steps.0.rate": slice(3)}))


def test_the_file_opens_with_stock_xarray(tmp_path, scene_file, calls):
    data = swept(scene_file, out=tmp_path / "out")
    with xarray.open_dataset(tmp_path / "out" / "sweep.nc") as stored:
        xarray.testing.assert_identical(stored.load(), data)
    rows = (tmp_path / "out" / "sweep.csv").read_text().splitlines()
    assert len(rows) == 7
    assert rows[0].startswith("loading.steps.0.rate,loading.steps.0.to,approach_force,")
    assert rows[-1].endswith("refused,loading: too fast; allowed: slower ones,")


def test_any_executor_gives_the_same(scene_file, calls):
    here = swept(scene_file)
    with ThreadPoolExecutor(2) as executor:
        there = swept(scene_file, executor=executor)
    assert there.identical(here)
    with pytest.raises(cc.SceneError, match="executor: got list"):
        swept(scene_file, executor=[])


def speeds_plan(scene_file, tmp_path, rates):
    rate = {"name": "rate", "key": "loading.steps.0.rate", "values": rates}
    asked = {"scene": scene_file, "solver": "bem", "estimate": False, "coordinates": [rate]}
    return plan_from_dict(asked, tmp_path)


def test_a_worker_with_other_sources_is_refused(scene_file, calls, monkeypatch):
    """As one of a cluster: what it is asked was made by another version."""
    monkeypatch.setattr(pool, "version", lambda: f"{threading.get_ident()}")
    with ThreadPoolExecutor(1) as executor, pytest.raises(cc.SceneError, match="the same installation"):
        swept(scene_file, executor=executor)


def test_a_batch_that_ends_its_process_is_run_again_one_by_one(tmp_path, scene_file, calls, monkeypatch):
    sizes = []

    class Dying(ThreadPoolExecutor):
        def submit(self, function, batch, *arguments):
            sizes.append(len(batch))
            rates = [asked[0].scene.loading.steps[0].rate for _, asked in batch]
            dies = 0.02 in rates
            return super().submit(os.kill if dies else function, *("no process",) * dies, batch, *arguments)

    monkeypatch.setattr(Engine, "batch_size", lambda *given: 2)
    plan = speeds_plan(scene_file, tmp_path, [0.01, 0.03, 0.06, 0.02])
    with Dying(1) as executor, store_of() as store:
        runs = run_plan.carry_out(plan, store, Engine(executor, 1))
        data = to_dataset(plan, runs)
        assert data.outcome.values.tolist() == ["detached", "detached", "detached", "failed"]
        assert data.reason.values[3].startswith("TypeError")
        assert sizes == [2, 2, 1, 1]
        assert sorted(rate for rate, _ in calls) == [0.01, 0.03, 0.06]
        assert run_plan.missing_runs(plan, store)[1].sum() == 1  # another attempt may end otherwise


@pytest.mark.parametrize("pages", [1, 5])
def test_a_full_disk_is_one_line_with_the_file(capsys, tmp_path, monkeypatch, pages):
    """SQLite's limit of pages answers as a full disk does: for a new file, and for its first run."""
    limit = f"PRAGMA page_size = 512; PRAGMA max_page_count = {pages};"
    monkeypatch.setattr(store, "_TABLE", limit + store._TABLE)
    plan = tmp_path / "plan.toml"
    plan.write_text(
        f'scene = "{small_scene(tmp_path)}"\nresolution = 4\nestimate = false\n'
        '[[coordinates]]\nkey = "indenter.radius"\nvalues = [1.0]\n'
    )
    assert main(["sweep", str(plan), "--jobs", "1", "--out", str(tmp_path / "out")]) == 1
    said = [line for line in capsys.readouterr().err.splitlines() if "error" in line]
    assert len(said) == 1
    assert "disk is full" in said[0]
    assert str(tmp_path / "out" / "runs.sqlite") in said[0]


def test_files_of_another_program_are_refused_in_one_line(capsys, tmp_path):
    with closing(sqlite3.connect(tmp_path / "runs.sqlite")) as connection:
        connection.execute("CREATE TABLE answers (number REAL)")
    with pytest.raises(cc.SceneError, match=r"runs\.sqlite cannot be used: no such column"):
        store_of(tmp_path)
    xarray.Dataset({"a": ("x", np.arange(3.0))}).to_netcdf(tmp_path / "sweep.nc", engine="h5netcdf")
    assert main(["sweep", "--plot", str(tmp_path)]) == 2
    refusal = capsys.readouterr().err
    assert "sweep.nc: is not the result of a sweep" in refusal
    assert refusal.count("\n") == 1


def write_plan(tmp_path, scene_file):
    file = tmp_path / "plan.toml"
    file.write_text(
        f'title = "A plan"\nscene = "{scene_file}"\nsolver = "bem"\nestimate = false\n'
        'drawn = ["approach_force"]\nmeasures = ["approach_force"]\n'
        '[[coordinates]]\nname = "speed"\nkey = "loading.steps.0.rate"\n'
        f"values = {json.dumps(RATES)}\n"
    )
    return str(file)


def test_the_command_writes_draws_and_says_what_did_not_end(capsys, tmp_path, scene_file, calls):
    plan, out = write_plan(tmp_path, scene_file), tmp_path / "out"
    assert main(["sweep", plan]) == 2
    assert "--out: is missing; allowed: a folder for the results, or --dry-run" in capsys.readouterr().err
    assert main(["sweep"]) == 0
    assert "speed-preload" in capsys.readouterr().out
    assert main(["sweep", plan, "--dry-run"]) == 0
    assert "3 runs of small by bem, 0 stored, 3 to do" in capsys.readouterr().out
    with without_layout():
        assert main(["sweep", plan, "--out", str(out), "--jobs", "1"]) == 1  # one is refused
    shown = capsys.readouterr()
    assert "2 detached: as told" in shown.out
    assert "1 refused: loading: too fast" in shown.out
    assert shown.err.splitlines()[-1] == "crosscontact: 1 of 3 runs did not reach their end"
    assert (out / "approach_force.png").exists()
    (out / "approach_force.png").unlink()
    with without_layout():
        assert main(["sweep", "--plot", str(out)]) == 0
    assert (out / "approach_force.png").exists()
    assert main(["sweep", plan, "--dry-run", "--out", str(out)]) == 0
    assert "3 stored, 0 to do" in capsys.readouterr().out
    assert len(calls) == 4  # the dry run carries out the first


@pytest.mark.parametrize("kind", ["hdf5", pytest.param("parquet", marks=pytest.mark.slow)])
def test_traces_are_kept_on_request(tmp_path, scene_file, calls, kind):
    package = pytest.importorskip(
        {"hdf5": "h5py", "parquet": "pyarrow.parquet"}[kind], reason="it is not installed"
    )
    out = tmp_path / "out"
    swept(scene_file, out=out)
    swept(scene_file, out=out, traces=kind)
    assert len(calls) == 11  # the refused one has no trace to be run for
    if kind == "hdf5":
        with package.File(out / "traces" / "runs-0000000-0000005.h5") as file:
            assert sorted(file) == [f"000000{run}" for run in range(5)]
            group = file["0000003"]
            assert (group.attrs["loading.steps.0.rate"], group.attrs["loading.steps.0.to"]) == (0.02, 0.03)
            assert group["force"][:].max() == pytest.approx(0.06)
    else:
        table = package.read_table(out / "traces" / "runs-0000000-0000005.parquet").to_pydict()
        found = set(
            zip(table["run"], table["loading.steps.0.rate"], table["loading.steps.0.to"], strict=True)
        )
        assert sorted(found)[:4] == [(0, 0.01, 0.02), (1, 0.01, 0.03), (2, 0.02, 0.02), (3, 0.02, 0.03)]
        assert max(table["force"]) == pytest.approx(0.06)
    with pytest.raises(cc.SceneError, match="traces: given without out"):
        swept(scene_file, traces=kind)


def test_short_runs_travel_in_batches_as_long_as_the_engine_asks_for():
    engine = Engine(None, 4, 0.2)
    assert engine.batch_size(0.0, 0, 1000) == 1  # what a run takes is not known yet
    assert engine.batch_size(0.1, 10, 1000) == 20
    assert [engine.batch_size(0.1, 10, left) for left in (80, 8)] == [10, 5]  # to end together
    assert engine.batch_size(20.0, 10, 1000) == Engine().batch_size(0.1, 10, 1000) == 1


def test_a_solver_that_is_installed_beside_is_told_apart_by_its_version(tmp_path, monkeypatch):
    plan, prints = plan_of(1, tmp_path), []
    for version in ("", "other 1.0", "other 1.1"):
        monkeypatch.setattr(type(solvers.SOLVERS), "origin", lambda self, name, v=version: v)
        prints.append(task_of(plan, next(plan.rows())).key)
    assert len(set(prints)) == 3
