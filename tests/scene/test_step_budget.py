"""The step budget is in proportion to what a scene asks: told by forecasts and stand-ins, nothing is run."""

from __future__ import annotations

from dataclasses import replace

import pytest
from support.recorded import hertz_curve
from support.spring_solver import FunctionSolver, StudiedSolver, fake, named, small_scene, spring

import crosscontact as cc
from benchmarks.cost_forecast import SCENES
from contact_scene import Branch, Loading, Material, Oscillate, Scene, Sphere, Table
from contact_scene.run_control.options import MAX_STEPS
from crosscontact.cli import main
from validation import solvers
from validation.execution.run_tasks import run_tasks
from validation.fields import request
from validation.solvers import SOLVERS, Cost
from validation.studies import schemes, study, zones
from validation.studies.ladders import Ladder, Level
from validation.studies.schemes import Settings

PRESSED = Scene(Material(0.75, 0.5, (Branch(6.75, 1.0),)), Sphere(1.0), Loading("relaxed", 0.04, ()))
ROWS = 10_000
TABLE = Table(tuple(float(row) for row in range(ROWS)), tuple(0.04 + 0.01 * (row % 2) for row in range(ROWS)))
LONG = {
    "2,000 cycles": replace(PRESSED, loading=replace(PRESSED.loading, steps=(Oscillate(1e-3, 6.28, 2e3),))),
    "a table of 10,000 rows": replace(PRESSED, loading=replace(PRESSED.loading, steps=(TABLE,))),
}


SAID = "are expected to take more, up to about 3e5 steps"


def budgets(monkeypatch, cost: Cost | None = None) -> list[int | None]:
    """The budget with which a solver in place of the boundary elements is asked, run by run."""
    asked: list[int | None] = []

    def solve(scene, resolution=None, *, max_steps=None, **options):
        asked.append(max_steps)
        return spring(scene.material.modulus)(scene, resolution, **options)

    if cost is not None:
        monkeypatch.setattr(FunctionSolver, "expected_cost", lambda self, scene, resolution=None: cost)
    monkeypatch.setitem(solvers.SOLVERS, "bem", FunctionSolver(solve))
    return asked


@pytest.mark.parametrize("label", LONG)
@pytest.mark.parametrize("name", SOLVERS)
def test_what_is_announced_may_be_carried_out(name, label):
    """Of every solver, with room for a forecast that is too low by its factor of three."""
    scene, method = LONG[label], SOLVERS[name]
    method.check(scene)
    assert method.step_budget(scene) >= max(MAX_STEPS, 5.0 * method.expected_cost(scene).steps)


def test_2_000_cycles_exceed_the_budget_of_a_solver_by_itself():
    assert SOLVERS["reference"].expected_cost(LONG["2,000 cycles"]).steps > MAX_STEPS


def test_a_usual_scene_has_the_usual_budget(monkeypatch):
    asked = budgets(monkeypatch)
    cc.solve(SCENES["one branch"], "bem")
    assert asked == [MAX_STEPS]


def test_a_solver_is_asked_with_the_budget_of_the_forecast_or_the_users(monkeypatch):
    asked = budgets(monkeypatch, Cost(3e5, 1.0, 1.0))
    cc.solve(PRESSED, "bem")
    cc.solve(PRESSED, "bem", max_steps=7)
    assert asked == [1_500_000, 7]


def test_fields_have_the_same_budget(monkeypatch):
    def record(scene, mesh, options, progress, monitor):
        raise RuntimeError(options.max_steps)

    monkeypatch.setattr("fem_solver.record", record)
    for given, budget in ((None, request.METHOD.step_budget(LONG["2,000 cycles"])), (7, 7)):
        with pytest.raises(RuntimeError, match=f"^{budget}$"):
            request.record_fields(LONG["2,000 cycles"], request.FieldRequest(), 4, max_steps=given)


def test_a_part_of_a_cost():
    """Set-up is spent whatever the budget."""
    cost = Cost(100.0, 12.0, 30.0, setup_seconds=2.0, setup_bytes=10.0)
    assert cost.within(None) == cost.within(100) == cost
    assert cost.within(10) == Cost(10.0, 3.0, 12.0, 2.0, 10.0)


def test_a_budget_below_the_forecast_is_said_at_the_start(capsys, tmp_path, monkeypatch):
    """The cost that is announced is that of the steps which may be taken."""
    asked = budgets(monkeypatch, Cost(3e5, 602.0, 3e9, 2.0, 1e9))
    given = ["solve", small_scene(tmp_path), "--solver", "bem"]
    for budget, said in (
        (
            "30000",
            [
                "--max-steps 30000: about 3e5 steps are expected: the run may end before its loading",
                "expected: about 3e4 steps, 62 s, 1.2 GB of memory",
            ],
        ),
        ("300000", ["expected: about 3e5 steps, 10 min, 3.0 GB of memory"]),
    ):
        assert main([*given, "--max-steps", budget]) == 0
        lines = [line for line in capsys.readouterr().err.splitlines() if "expected" in line]
        assert lines == [f"crosscontact: {line}" for line in said]
    assert asked == [30_000, 300_000]


def test_compare_bounds_every_run(capsys, tmp_path, monkeypatch):
    asked = budgets(monkeypatch, Cost(3e5, 1.0, 1.0))
    monkeypatch.setitem(solvers.SOLVERS, "reference", named("reference", fake()))
    given = ["compare", small_scene(tmp_path), "--solvers", "reference,bem", "--jobs", "1"]
    main([*given, "--max-steps", "30000"])
    (line,) = [line for line in capsys.readouterr().err.splitlines() if "--max-steps" in line]
    said = "2 of 2 runs are expected to take more, up to about 3e5 steps (small by reference)"
    assert line == f"crosscontact: --max-steps 30000: {said}: they may end before their loading"
    main([*given, "--max-steps", "300000"])
    assert "--max-steps" not in capsys.readouterr().err
    assert asked[0] == 30_000
    assert 300_000 in asked


def stand_ins(monkeypatch, *names: str) -> list[int | None]:
    """The same for several solvers and, under the same names, schemes of a study."""
    asked = budgets(monkeypatch, Cost(3e5, 1.0, 1.0))
    solve = solvers.SOLVERS["bem"].function
    for name in names:
        method = named(name, StudiedSolver(solve))
        monkeypatch.setitem(solvers.SOLVERS, name, method)
        monkeypatch.setitem(schemes.SCHEMES, name, replace(schemes.SCHEMES[name], solver=method))
    return asked


def said(err: str) -> str:
    """The only line on the step budget."""
    (line,) = [line for line in err.splitlines() if "--max-steps" in line]
    return line


def test_a_study_bounds_every_level(capsys, tmp_path, monkeypatch):
    asked = stand_ins(monkeypatch, "bem", "reference")
    ladder = Ladder("bem", "together", "all", tuple(Level(1.0 / n, str(n), Settings(n)) for n in (4, 8)))
    monkeypatch.setattr(study, "ladders", lambda scene: [ladder, replace(ladder, kind="mesh")])
    main(["study", small_scene(tmp_path), "--jobs", "1", "--max-steps", "30000"])
    assert f"4 of 4 runs {SAID} (small by bem, together 8)" in said(capsys.readouterr().err)
    assert set(asked) == {30_000}
    asked.clear()
    main(["study", small_scene(tmp_path), "--jobs", "1"])
    assert "--max-steps" not in capsys.readouterr().err
    assert set(asked) == {1_500_000}


def test_studies_of_zones_and_of_poisson_ratios_bound_every_run(capsys, tmp_path, monkeypatch):
    asked = stand_ins(monkeypatch, "bem", "fem", "reference")
    monkeypatch.setattr(zones, "run_tasks", lambda tasks, *others: run_tasks(tasks))
    given = [small_scene(tmp_path), "--max-steps", "30000"]
    main(["study", *given, "--zones", "1e-2", "1e-4"])
    line = said(capsys.readouterr().err)
    assert f"6 of 6 runs {SAID} (small, zone 1e-04 of the radius, by reference)" in line
    assert asked.count(30_000) == 6
    main(["study", *given, "--poisson", "10", "--jobs", "1"])
    assert "5 of 5 runs" in said(capsys.readouterr().err)
    assert asked.count(30_000) == 11


def test_a_fit_bounds_every_run_of_both_solvers(capsys, tmp_path, monkeypatch):
    asked = stand_ins(monkeypatch, "bem", "reference")
    curve = tmp_path / "hertz.csv"
    cc.write_curve(hertz_curve(), curve)
    given = ["fit", str(curve), small_scene(tmp_path), "--vary", "material.modulus", "--resolution", "4"]
    main([*given, "--starts", "1", "--jobs", "1", "--max-steps", "30000"])
    assert f"2 of 2 runs {SAID} (hertz by reference)" in said(capsys.readouterr().err)
    assert len(asked) > 2
    assert set(asked) == {30_000}
