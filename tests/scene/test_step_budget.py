"""The step budget grows with cycles and kinks of the loading; that of the user bounds every run."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace

import pytest
from support.recorded import hertz_curve
from support.spring_solver import FunctionSolver, StudiedSolver, named, small_scene, spring

import contact_scene as cs
import crosscontact as cc
from contact_scene.run_control import MAX_STEPS
from crosscontact.cli import main
from validation import solvers
from validation.fields import moments
from validation.solvers import SOLVERS
from validation.solvers.base import step_budget
from validation.studies import ladders as schemes
from validation.studies import study
from validation.studies.ladders import Ladder, Level, Settings

PRESSED = cs.Scene(
    cs.Material(0.75, 0.5, (cs.Branch(6.75, 1.0),)), cs.Sphere(1.0), cs.Loading("relaxed", 0.04, ())
)
ROWS = 10_000
TABLE = cs.Table(
    tuple(float(row) for row in range(ROWS)), tuple(0.04 + 0.01 * (row % 2) for row in range(ROWS))
)
LONG = {
    "2,000 cycles": replace(
        PRESSED, loading=replace(PRESSED.loading, steps=(cs.Oscillate(1e-3, 6.28, 2e3),))
    ),
    "a table of 10,000 rows": replace(PRESSED, loading=replace(PRESSED.loading, steps=(TABLE,))),
}


def budgets(monkeypatch) -> list[int | None]:
    """The budget with which a solver in place of the boundary elements is asked, run by run."""
    asked: list[int | None] = []

    def solve(scene, resolution=None, *, max_steps=None, **options):
        asked.append(max_steps)
        return spring(scene.material.modulus)(scene, resolution, **options)

    monkeypatch.setitem(solvers.SOLVERS, "bem", FunctionSolver(solve))
    return asked


@pytest.mark.parametrize(
    ("scene", "budget"), [(LONG["2,000 cycles"], 2e6), (LONG["a table of 10,000 rows"], 1e7), (PRESSED, 2e5)]
)
def test_a_solver_is_asked_with_the_budget_of_the_loading_or_the_users(monkeypatch, scene, budget):
    asked = budgets(monkeypatch)
    cc.solve(scene, "bem")
    cc.solve(scene, "bem", max_steps=7)
    assert asked == [pytest.approx(budget, rel=1e-2), 7]


@pytest.mark.parametrize(("resolution", "megabytes"), [(4, 85.0), (40, 742.0)])
def test_memory_of_a_mesh_that_follows_the_edge(resolution, megabytes):
    material = cs.Material(1e6, 0.49, (cs.Branch(3e6, 0.01), cs.Branch(1e6, 1.0)))
    loading = cs.Loading("relaxed", 2e-6, (cs.Ramp(-5e-5, 1e-5),))
    pull = cs.Scene(material, cs.Sphere(1e-3), loading, cs.Adhesion(0.05, 1e-6))
    assert megabytes / 1.5 <= 1e-6 * SOLVERS["fem"].mesh_bytes(pull, resolution) <= 1.5 * megabytes


def test_memory_of_a_mesh_whose_elements_grow_less_on_a_thin_layer():
    material, loading = cs.Material(0.75, 0.5), cs.Loading("relaxed", 0.02, (cs.Ramp(-0.5, 0.02),))
    law, body = cs.Adhesion(5e-4, 1e-4), cs.Layer(0.01, "bonded")
    pull = cs.Scene(material, cs.Sphere(1.0), loading, law, body=body)
    assert 1959.0 / 1.5 <= 1e-6 * SOLVERS["fem"].mesh_bytes(pull, 10) <= 1.5 * 1959.0


def test_fields_have_the_same_budget(monkeypatch):
    def record(scene, mesh, options, progress, monitor):
        raise RuntimeError(options.max_steps)

    monkeypatch.setattr("fem_solver.record", record)
    for given, budget in ((None, step_budget(LONG["2,000 cycles"])), (7, 7)):
        with pytest.raises(RuntimeError, match=f"^{budget}$"):
            moments.record_fields(LONG["2,000 cycles"], moments.FieldRequest(), 4, max_steps=given)


def stand_ins(monkeypatch, *names: str) -> list[int | None]:
    """The same for several solvers and, under the same names, schemes of a study."""
    asked = budgets(monkeypatch)
    solve = solvers.SOLVERS["bem"].function
    for name in names:
        method = named(name, StudiedSolver(solve))
        monkeypatch.setitem(solvers.SOLVERS, name, method)
        monkeypatch.setitem(schemes.SCHEMES, name, replace(schemes.SCHEMES[name], solver=method))
    return asked


@pytest.mark.parametrize(
    ("command", "runs"),
    [("compare --solvers reference,bem", 2), ("study --zones 1e-2 1e-4", 6), ("study --poisson 10", 5)],
)
def test_commands_of_many_runs_bound_every_one(tmp_path, monkeypatch, command, runs):
    """Apart from the coarser runs of error estimates."""
    asked = stand_ins(monkeypatch, "bem", "fem", "reference")
    monkeypatch.setattr("crosscontact.commands.study.processes", lambda *given, **more: nullcontext())
    word, *more = command.split()
    main([word, small_scene(tmp_path), *more, "--jobs", "1", "--max-steps", "30000"])
    assert asked.count(30_000) == runs


def test_a_study_bounds_every_level(tmp_path, monkeypatch):
    asked = stand_ins(monkeypatch, "bem", "reference")
    ladder = Ladder("bem", "together", "all", tuple(Level(1.0 / n, str(n), Settings(n)) for n in (4, 8)))
    monkeypatch.setattr(study, "ladders", lambda scene: [ladder, replace(ladder, kind="mesh")])
    main(["study", small_scene(tmp_path), "--jobs", "1", "--max-steps", "30000"])
    assert set(asked) == {30_000}
    asked.clear()
    main(["study", small_scene(tmp_path), "--jobs", "1"])
    assert set(asked) == {MAX_STEPS}


def test_a_fit_bounds_every_run_of_both_solvers(tmp_path, monkeypatch):
    asked = stand_ins(monkeypatch, "bem", "reference")
    curve = tmp_path / "hertz.csv"
    cc.write_curve(hertz_curve(), curve)
    given = ["fit", str(curve), small_scene(tmp_path), "--vary", "material.modulus", "--resolution", "4"]
    main([*given, "--starts", "1", "--jobs", "1", "--max-steps", "30000"])
    assert len(asked) > 2
    assert set(asked) == {30_000}
