"""What sweeps cost beside their runs."""

from __future__ import annotations

import pytest
from support.spring_solver import SCENE, FunctionSolver, named, spring

from benchmarks.sweep_price import plan_of
from validation import solvers
from validation.runs.store import RunTable
from validation.sweeps.dataset import write_results
from validation.sweeps.figures import draw
from validation.sweeps.plan import plan_from_dict
from validation.sweeps.run_plan import RunSettings, carry_out, forecast


def test_every_run_is_another_scene(tmp_path):
    plan, other = plan_of(5, tmp_path), plan_of(5, tmp_path, first=3.0)
    radii = [plan.scene_of(rows).indenter.radius for rows in plan.rows()]
    assert len(set(radii)) == plan.count == 5
    assert not set(radii) & {other.scene_of(rows).indenter.radius for rows in other.rows()}


def test_short_runs_are_stored_by_batches_in_this_process_too(tmp_path, monkeypatch):
    method = FunctionSolver(spring(2.0), "bem")
    monkeypatch.setitem(solvers.SOLVERS, "bem", named("bem", method))
    (tmp_path / "small.toml").write_text(SCENE)
    rates = {"key": "loading.steps.0.rate", "linspace": [0.01, 0.05, 40]}
    plan = plan_from_dict(
        {"scene": "small.toml", "solver": "bem", "estimate": False, "coordinates": [rates]}, tmp_path
    )
    batches = []
    with RunTable() as table:
        keep = table.keep
        monkeypatch.setattr(table, "keep", lambda runs: keep(batches.append(list(runs)) or batches[-1]))
        runs = carry_out(plan, table)
        assert [run.fingerprint for batch in batches for run in batch] == runs.keys
    assert len(batches) < 20


def test_a_solver_that_is_installed_beside_is_told_apart_by_its_version(tmp_path, monkeypatch):
    scene = plan_of(1, tmp_path).scene.with_values({})
    prints = []
    for version in ("", "other 1.0", "other 1.1"):
        monkeypatch.setattr(type(solvers.SOLVERS), "origin", lambda self, name, v=version: v)
        prints.append(RunSettings("reference").fingerprint(scene))
    assert len(set(prints)) == 3


@pytest.mark.slow
def test_the_forecast_of_the_size_is_right_within_a_factor_of_two(tmp_path, monkeypatch):
    plan = plan_of(24, tmp_path)
    out = tmp_path / "out"
    out.mkdir()
    with RunTable(out) as table:
        expected = forecast(plan, table).bytes
        draw(write_results(plan, carry_out(plan, table), out), out)
    assert 0.5 < sum(file.stat().st_size for file in out.iterdir()) / expected < 2.0
