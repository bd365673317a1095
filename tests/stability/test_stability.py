"""The matrix: every way a run can end has its verdict, nothing that goes wrong passes for an answer."""

from __future__ import annotations

import time
from concurrent.futures import CancelledError
from dataclasses import replace

import numpy as np
import pytest
from support import scripted_solver as fakes

from contact_scene import OutcomeKind, Scene, SceneError
from crosscontact.commands import parser
from validation.runs.pool import Task, TaskResult, WorkerProcesses, run_tasks
from validation.runs.store import Store
from validation.stability import base, measure
from validation.stability.case import (
    ClosedForm,
    EquivalentScene,
    NoSolution,
    ReferenceRuns,
    StabilityCase,
    Value,
)
from validation.stability.case_runs import CaseAnswer, CaseRun, solve_case
from validation.stability.limits import limits, work_growth
from validation.stability.matrix import AXES, cases
from validation.stability.runner import run
from validation.stability.verdict import Cell, CellVerdict, cell_of

ENDINGS = {
    "right": CellVerdict.WITHIN,
    "a little off": CellVerdict.WITHIN,
    "wrong": CellVerdict.WRONG,
    "ends otherwise": CellVerdict.WRONG,
    "not a number": CellVerdict.NOT_FINITE,
    "raises": CellVerdict.CRASH,
    "dies": CellVerdict.CRASH,
    "refuses": CellVerdict.DECLINED,
    "gives up": CellVerdict.DECLINED,
}
SHORTEST_ZONE = {"bem": 8e-4, "fem": 8e-3, "reference": 7e-6}
"""Largest error estimate, of loop energy or curve, at the resolutions of the matrix with a zone of a
millionth of the contact radius and ``V tau/R = 0.02``; that of the finite elements takes a second run, twice
as long. The largest errors of all that is compared: 9e-5, 2.4e-3 and 6e-8."""


def one(case: StabilityCase, answer: CaseAnswer, *expected_runs: CaseAnswer, solver: str = "bem") -> Cell:
    """The cell of a made-up answer."""
    return cell_of(case, solver, answered(answer), tuple(map(answered, expected_runs)))


def answered(value: object) -> TaskResult:
    """The result of a task that gave this value."""
    return TaskResult(Task("", "", solve_case), value)


def test_every_ending_has_its_verdict_and_the_next_run_is_unharmed():
    asked = [fakes.case(title) for title in (*ENDINGS, "right again")]
    matrix = run(asked, solvers=("bem",), solve=fakes.act)
    found = {cell.label: cell.verdict for cell in matrix.cells}
    assert found == {**ENDINGS, "right again": CellVerdict.WITHIN}
    told = {cell.label: cell for cell in matrix.cells}
    assert told["dies"].reason == "the process ended with code 7"
    assert told["raises"].reason == "ZeroDivisionError: division by zero"
    assert told["wrong"].error == pytest.approx(0.01)
    assert told["ends otherwise"].error == measure.MISSING
    assert (told["right"].steps, told["right"].rejected_steps) == (3, 1)
    faults = {"wrong", "ends otherwise", "not a number", "raises", "dies"}
    assert {cell.label for cell in matrix.faults} == faults


@pytest.mark.parametrize("title", ["hangs", pytest.param("waits", marks=pytest.mark.slow)])
def test_a_run_that_hangs_is_killed(title):
    begin = time.monotonic()
    matrix = run([fakes.case(title, seconds=0.4)], solvers=("bem",), solve=fakes.act)
    assert [cell.verdict for cell in matrix.cells] == [CellVerdict.HANG]
    assert time.monotonic() - begin < 60.0


def test_no_answer_is_right_where_there_is_none():
    nothing = fakes.case("right", NoSolution("nothing holds"))
    assert one(nothing, CaseAnswer(refusal="adhesion.zone: too long")).verdict is CellVerdict.WITHIN
    assert (
        one(nothing, CaseAnswer(fakes.trace(kind=OutcomeKind.NO_EQUILIBRIUM))).verdict is CellVerdict.WITHIN
    )
    assert one(nothing, CaseAnswer(fakes.trace())).verdict is CellVerdict.WRONG
    refused = replace(nothing, scene=SceneError("radius", "falls"))
    assert cell_of(refused, "bem", None, ()).verdict is CellVerdict.WITHIN


def test_an_observable_that_is_missing_is_an_error_without_bound():
    cell = one(
        fakes.case("right", ClosedForm((Value("detachment_time", 1.0),), "made up")),
        CaseAnswer(fakes.trace()),
    )
    assert (cell.verdict, cell.error) == (CellVerdict.WRONG, measure.MISSING)


def test_against_the_front_tracking_with_its_own_error():
    case = fakes.case("by resolution", ReferenceRuns(("final_force", measure.CURVE), fine=20, coarse=10))
    fine, coarse = (fakes.act(CaseRun("reference", case.scene, n, 9)) for n in (20, 10))
    cell = one(case, fakes.act(CaseRun("bem", case.scene, 10, 9)), fine, coarse)
    assert cell.expected_error == pytest.approx(0.1 * (1 / 100 - 1 / 400) / 3.0, rel=1e-3)
    assert cell.verdict is CellVerdict.WITHIN
    assert one(case, fakes.act(CaseRun("bem", case.scene, 4, 9)), fine, coarse).verdict is CellVerdict.WRONG
    broken = CaseAnswer(fakes.trace(kind=OutcomeKind.STEP_UNDERFLOW))
    assert one(case, fine, fine, broken).verdict is CellVerdict.UNKNOWN


@pytest.mark.parametrize(
    ("past", "expected", "verdict"),
    [
        (True, OutcomeKind.BELOW_ZONE, CellVerdict.WITHIN),
        (True, OutcomeKind.DETACHED, CellVerdict.WRONG),
        (False, OutcomeKind.DETACHED, CellVerdict.DECLINED),
    ],
)
def test_a_contact_below_its_zone_is_an_answer_only_after_the_largest_tension(past, expected, verdict):
    case = fakes.case("below the zone", ReferenceRuns(("loop_energy",)))

    def ended(kind: OutcomeKind) -> CaseAnswer:
        trace = fakes.trace(kind=kind)
        return CaseAnswer(replace(trace, outcome=replace(trace.outcome, past_extremum=past)))

    others = [CaseAnswer(fakes.trace(kind=expected))] * 2
    if expected is OutcomeKind.BELOW_ZONE:
        others = [ended(expected)] * 2
    assert one(case, ended(OutcomeKind.BELOW_ZONE), *others).verdict is verdict


def test_the_driver_runs_what_is_expected_and_the_other_scene():
    computed = fakes.case("by resolution", ReferenceRuns(("final_force",), fine=40, coarse=20))
    same = fakes.case("right", EquivalentScene(fakes.scene("wrong")))
    matrix = run([computed, same], solvers=("bem", "fem"), solve=fakes.act)
    verdicts = [(cell.label, cell.solver, cell.verdict) for cell in matrix.cells]
    assert verdicts == [
        ("by resolution", "bem", CellVerdict.WRONG),  # 6 a zone: 2.7e-3 off
        ("by resolution", "fem", CellVerdict.WRONG),
        ("right", "bem", CellVerdict.WRONG),
        ("right", "fem", CellVerdict.WRONG),
    ]


def test_units_are_undone_column_by_column():
    plain = fakes.trace()
    other = replace(plain, time=60.0 * plain.time, penetration=1e3 * plain.penetration,
                    contact_radius=1e3 * plain.contact_radius, force=1e-3 * plain.force)  # fmt: skip
    expected = EquivalentScene(fakes.scene("right"), length=1e3, stress=1e-9, time=60.0)
    assert max(measure.against_equivalent(other, plain, expected).values()) < 1e-12
    assert measure.against_equivalent(other, fakes.trace(steps=4), expected) == {
        measure.CURVE: measure.MISSING
    }
    wrong = replace(other, force=other.force * (1.0 + 1e-6))
    assert measure.against_equivalent(wrong, plain, expected)["force"] == pytest.approx(1e-6, rel=1e-3)


def test_cells_that_are_kept_are_not_run_again(tmp_path):
    asked = [fakes.case("right"), fakes.case("raises")]
    first = run(asked, solvers=("bem", "fem"), solve=fakes.act, store=Store(tmp_path))
    again = run(asked, solvers=("bem", "fem"), solve=fakes.never, store=Store(tmp_path))
    assert again.cells[:2] == first.cells[:2]
    assert [cell.reason for cell in again.cells[2:]] == [
        "AssertionError: raises"
    ] * 2  # a crash is tried again


def test_processes_that_are_shut_down_answer_no_more():
    executor = WorkerProcesses(1)
    (result,) = run_tasks([Task("a", "a", abs, (-3,), time_limit=60.0)], executor)
    assert (result.value, result.failure) == (3, "")
    pending = executor.submit(time.sleep, 60.0)
    executor.shutdown(cancel_futures=True)
    with pytest.raises(CancelledError):
        pending.result()
    with pytest.raises(RuntimeError):
        executor.submit(abs, -3)


def cells_of(steps: dict[float, int]) -> list[Cell]:
    return [
        Cell("axis", f"{x:g}", "bem", CellVerdict.WITHIN, "completed", "", steps=n, series="s", stiffness=x)
        for x, n in steps.items()
    ]


def test_logarithmic_growth_is_told_from_faster_growth():
    (slow,) = work_growth(cells_of({10.0**k: 100 + 20 * k for k in range(8)}))
    assert slow.logarithmic
    assert slow.per_decade == pytest.approx(20.0)
    assert slow.at_first == pytest.approx(100.0)
    (fast,) = work_growth(cells_of({10.0**k: round(100 * 10 ** (0.3 * k)) for k in range(8)}))
    assert not fast.logarithmic
    assert fast.power == pytest.approx(0.3, abs=0.01)
    assert any("FASTER" in line for line in limits(cells_of({10.0**k: 10 * 3**k for k in range(8)})))
    assert work_growth(cells_of({1.0: 10, 10.0: 20})) == []


@pytest.mark.slow
def test_the_matrix_has_every_axis_and_every_name_once():
    command_line = parser()
    for name in AXES:
        assert command_line.parse_args(["stability", "--only", name]).only == name
    asked = cases()
    assert len({case.name for case in asked}) == len(asked)
    assert all(0.0 < limit < 0.3 for case in asked for limit in case.tolerance.limits.values())
    assert all(case.tolerance.why for case in asked)
    refused = [case for case in asked if not isinstance(case.scene, Scene)]
    assert [type(case.expected) for case in refused] == [NoSolution]
    stiff = max(case.stiffness for case in asked)
    assert stiff >= 1e12


def test_the_energy_of_a_real_run_balances_and_a_false_one_does_not():
    scene = base.scene(base.material(), base.press_and_pull(0.1))
    trace = solve_case(CaseRun("reference", scene, 8, 5000)).trace
    assert trace is not None
    assert measure.energy_residual(trace, scene.material) < 1e-3
    false = replace(trace, stored_energy=1.05 * trace.stored_energy)
    assert measure.energy_residual(false, scene.material) > 0.02


@pytest.mark.parametrize(
    "label", ["jump of the penetration", pytest.param("jump, then rest", marks=pytest.mark.slow)]
)
def test_all_solvers_on_probes_with_a_closed_form(label):
    (case,) = [case for case in AXES["loading"]() if case.label == label]
    for solver in ("bem", "fem", "reference"):
        job = CaseRun(solver, case.scene, case.resolution(solver), case.max_steps)
        cell = one(case, solve_case(job), solver=solver)
        assert cell.verdict is CellVerdict.WITHIN, (cell.name, cell.errors)
        assert np.isfinite(cell.residual)


def test_an_elastic_contact_may_shrink_to_its_zone_before_it_is_unstable():
    (case,) = [case for case in AXES["adhesion"]() if case.label == "da/a = 0.5, elastic"]
    job = CaseRun("reference", case.scene, case.resolution("reference"), case.max_steps)
    cell = one(case, solve_case(job), solver="reference")
    assert case.expected.endings == (OutcomeKind.BELOW_ZONE,)
    assert cell.verdict is CellVerdict.WITHIN, cell.errors


@pytest.mark.slow
def test_elements_follow_the_edge_up_to_its_last_root():
    """Next to it a stride of a quarter element finds no root: with nothing shorter this took 9600 steps."""
    (case,) = [one for one in AXES["relaxation-time"]() if one.label == "tau/T = 1e-12, pulled from rest"]
    trace = solve_case(CaseRun("fem", case.scene, 4, 20_000)).trace
    assert trace is not None
    assert trace.counters.steps < 3000


@pytest.mark.parametrize(
    "solver",
    [
        pytest.param(name, marks=pytest.mark.exhaustive if name == "fem" else pytest.mark.slow)
        for name in SHORTEST_ZONE
    ],
)
def test_cells_of_the_shortest_zone_are_answered_within_estimates(solver):
    """A millionth of the contact radius, where each of the solvers passes over many zones in a step.

    Finite elements take minutes, beside the other rows of long tables.
    """
    asked = [case for case in AXES["adhesion"]() if case.label.startswith("da/a = 1e-06")]
    cells = run(asked, jobs=2, solvers=(solver,)).cells
    assert len(cells) == len(asked) == 3
    for cell in cells:
        assert cell.verdict is CellVerdict.WITHIN, (cell.reason, cell.errors)
        assert cell.outcome == OutcomeKind.DETACHED
        assert np.isfinite([cell.residual, *cell.errors.values()]).all()
        assert cell.error <= SHORTEST_ZONE[solver] + cell.expected_error, cell.errors


@pytest.mark.slow
@pytest.mark.parametrize("axis", ["step", "scale", "speed"])
def test_whole_axes_hold(axis):
    asked = AXES[axis]()
    asked = {"step": asked[::2], "scale": asked[1::2], "speed": asked[1::3]}[axis]
    matrix = run(asked, jobs=2)
    assert [(cell.name, cell.worst, cell.error) for cell in matrix.faults] == []
    assert {cell.verdict for cell in matrix.cells} == {CellVerdict.WITHIN}
