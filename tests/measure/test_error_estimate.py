"""What runs say about their own errors, and that agreement is judged by it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from support.spring_solver import SCENE, FunctionSolver, fake, named
from support.spring_solver import spring as spring_solve

from contact_scene import Counters, Outcome, OutcomeKind, Trace
from crosscontact import registry
from crosscontact.cli import main
from validation import solvers
from validation.cases import load
from validation.compare.against_reference import against_reference, check_case
from validation.execution.runs import Run, measure, run
from validation.measure.error_estimate import SAFETY, from_own, from_two_runs
from validation.measure.scaling import scale

CASE = load("cycle-v0.1")


def spring(stiffness: float, rows: int = 41, solver: str = "fem") -> Trace:
    """A spring pressed in and pulled out again, kinked at half time."""
    t = np.linspace(0.0, 1.0, rows)
    d = 0.03 - 0.08 * np.abs(t - 0.5)
    energy = 0.5 * stiffness * d**2
    outcome = Outcome(OutcomeKind.COMPLETED, "as told", 1.0)
    return Trace(
        solver, t, d, stiffness * d, np.full_like(t, 0.2), energy, energy, energy, outcome, Counters()
    )


def estimates(fine: Trace, coarse: Trace) -> dict[str, float]:
    return from_two_runs(fine, coarse, measure(fine, CASE.scene, 0.0), measure(coarse, CASE.scene, 0.0))


@pytest.mark.parametrize(("solver", "order"), [("fem", 2), ("bem", 1)])
def test_estimate_covers_the_error_at_the_known_order(solver, order):
    fine, coarse = spring(1.0 + 1e-3, solver=solver), spring(1.0 + 1e-3 * 2**order, solver=solver)
    found = estimates(fine, coarse)
    assert found["approach_force"] == pytest.approx(SAFETY * 1e-3, rel=2e-3)
    assert found["force"] == pytest.approx(SAFETY * 1e-3 * 0.4, rel=0.5)
    assert found["approach_force"] >= 1e-3


def test_a_scalar_is_no_better_than_its_curves():
    fine = spring(1.0)
    bent = dataclasses.replace(fine, force=fine.force * (1.0 + 0.1 * np.sin(2 * np.pi * fine.time)))
    found = estimates(fine, bent)
    assert found["approach_force"] == pytest.approx(found["force"])
    assert found["force"] > 1e-3


def test_the_largest_tension_is_uncertain_by_half_a_row_and_its_place_by_more():
    found = estimates(spring(1.0, rows=41), spring(1.0, rows=41))
    away = 0.5 * 0.08 / 40
    assert found["pull_off_force"] == pytest.approx(away / 0.01)
    assert found["pull_off_penetration"] == pytest.approx((2.0 + 1.0) * away / 0.03)  # a row, and half a row
    assert found["approach_force"] == 0.0


def test_the_place_of_the_largest_tension_is_as_uncertain_as_the_way_its_error_reaches():
    """Tension rises to 1 in ten steps and falls in five; known to 0.25 it may stand 2.5 steps before."""
    t = np.arange(16.0)
    force = -np.concatenate((0.1 * t[:11], 1.0 - 0.2 * t[1:6]))
    run = dataclasses.replace(
        spring(1.0, rows=16), time=t, force=force, penetration=-t, errors={"pull_off_force": 0.25 - 0.5 * 0.2}
    )
    found = from_own(run, {"pull_off_force": 1.0, "pull_off_time": 10.0})
    assert found["pull_off_force"] == pytest.approx(0.25)
    assert found["pull_off_time"] == pytest.approx(0.15 + (1.0 + 2.5) / 10.0)


def test_a_difference_is_as_uncertain_as_both_its_terms():
    fine, coarse = spring(1.0), spring(1.0)
    losses = {"branch_dissipation": 3.0, "dissipated_energy": 2.0, "zone_excess": 1.0}
    moved = {"branch_dissipation": 3.1, "dissipated_energy": 2.1, "zone_excess": 1.0}
    found = from_two_runs(fine, coarse, losses, moved)
    assert found["branch_dissipation"] == pytest.approx(SAFETY * 0.1 / 3.0)
    assert found["dissipated_energy"] == pytest.approx(SAFETY * 0.1 / 2.0 / 3.0)
    assert found["zone_excess"] == pytest.approx(
        3.0 * found["branch_dissipation"] + 2.0 * found["dissipated_energy"]
    )


def test_own_estimates_serve_for_what_they_do_not_name():
    trace = dataclasses.replace(spring(1.0), errors={"force": 1e-4, "contact_radius": 3e-4})
    found = from_own(trace, measure(trace, CASE.scene, 0.0))
    assert found["force"] == 1e-4
    assert found["approach_force"] == found["loop_energy"] == 3e-4
    assert "counters.steps" not in found
    assert "wall_seconds" not in found


def test_scales():
    trace = spring(1.0)
    assert scale("detachment_penetration", 1e-9, trace) == pytest.approx(0.03)
    assert scale("start_force", 1e-9, trace) == pytest.approx(0.05 * 0.03)
    assert scale("dissipated_energy", 1e-9, trace) == pytest.approx(trace.stored_energy.max())
    worked = dataclasses.replace(trace, external_work=7.0 * trace.external_work)
    assert scale("dissipated_energy", 1e-9, worked) == pytest.approx(7.0 * trace.stored_energy.max())
    assert scale("loop_energy", -2.0, trace) == 2.0


def test_coarser_runs_are_coarser():
    def coarser(name, scene, resolution):
        """Resolution and step tolerance of the coarser run, and the solver that carries it out."""
        call = solvers.solver(name).coarser(scene, resolution)
        assert call.args[0] is scene
        return call.args[1], call.keywords.get("step_tolerance"), call.func.__self__

    assert coarser("bem", CASE.scene, None)[:2] == (6, None)
    assert coarser("bem", CASE.scene, 40)[0] == 20
    assert coarser("fem", CASE.scene, None)[:2] == (5, 4e-3)
    assert coarser("fem", CASE.scene, None)[2].grading == 0.4
    assert coarser("fem", load("adhesionless-cycle").scene, None)[0] == 2


def runs(difference: float, mine: float | None, theirs: float | None) -> list:
    base = Run(CASE.name, "reference", spring(1.0), measures=measure(spring(1.0), CASE.scene, 0.0))
    trace = spring(1.0 + difference)
    result = Run(CASE.name, "fem", trace, measures=measure(trace, CASE.scene, 0.0))
    if mine is not None:
        result = dataclasses.replace(result, errors=dict.fromkeys([*result.measures, "force"], mine))
    if theirs is not None:
        base = dataclasses.replace(base, errors=dict.fromkeys([*base.measures, "force"], theirs))
    return against_reference(CASE, result, base)


@pytest.mark.parametrize(
    ("difference", "mine", "theirs", "agrees"),
    [
        (5e-3, None, None, True),  # by the tolerance of 1e-2
        (5e-3, 1e-3, None, True),  # an estimate on one side only says nothing
        (5e-3, 3e-3, 3e-3, True),
        (5e-3, 3e-3, 1e-3, False),
        (2e-2, 3e-2, 3e-2, False),  # the tolerance caps what estimates excuse
    ],
)
def test_agreement_is_within_the_estimates_capped_by_the_tolerance(difference, mine, theirs, agrees):
    verdict = {check.quantity: check for check in runs(difference, mine, theirs)}["approach_force"]
    assert verdict.passed is agrees
    assert (verdict.estimate, verdict.base_estimate) == (mine, theirs)
    assert ("parts at t =" in verdict.note) is not agrees


def test_compare_prints_estimates_and_names_a_disagreement(capsys, tmp_path, monkeypatch):
    """A fake gives the same answer at any resolution, hence claims to be exact: a small difference counts."""
    for name in registry.names():
        monkeypatch.setitem(solvers.SOLVERS, name, named(name, fake()))
    scene = tmp_path / "small.toml"
    scene.write_text(SCENE)
    assert main(["compare", str(scene), "--jobs", "1"]) == 0
    assert "estimates" in capsys.readouterr().out
    monkeypatch.setitem(solvers.SOLVERS, "bem", named("bem", fake(1.001)))

    def estimating(*given, **options):
        return dataclasses.replace(spring_solve()(*given, **options), errors={"force": 1e-5})

    monkeypatch.setitem(solvers.SOLVERS, "reference", FunctionSolver(estimating, "reference"))
    assert main(["compare", str(scene), "--jobs", "1"]) == 1
    out, err = capsys.readouterr()
    assert "0.0e+00 + 1.0e-05" in out
    line = next(line for line in err.splitlines() if "bem: approach_force" in line)
    assert line.startswith("failed: small: bem: approach_force: found ")
    assert "expected = " in line
    assert "parts at t =" in line


@pytest.mark.slow
def test_real_solvers_estimate_what_they_miss():
    """Static states, against the reference: true differences lie within the estimates."""
    case = load("relaxed-equilibrium")
    found = {solver: run(case, solver, estimate=True) for solver in registry.names()}
    checks = [check for check in check_case(case, found) if check.quantity == "start_radius"]
    judged = [check for check in checks if check.source == "front tracking"]
    assert {check.solver for check in judged} == {"bem", "fem"}
    for check in judged:
        assert check.passed
        assert 0.0 < abs(check.difference) <= check.estimate + check.base_estimate < 2e-3


def test_a_run_without_its_coarser_run_has_no_estimate(monkeypatch):
    def refuse_twice(scene, resolution, **options):
        if resolution is not None:
            raise ValueError("too coarse")
        return spring_solve()(scene, resolution, **options)

    monkeypatch.setitem(solvers.SOLVERS, "bem", FunctionSolver(refuse_twice))
    result = run(CASE, "bem", estimate=True)
    assert result.finished
    assert result.errors == {}
