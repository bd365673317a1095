"""The matrix: every way a run can end has its verdict, nothing that goes wrong passes for an answer."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from support import scripted_solver as fakes

from contact_scene import OutcomeKind, Scene, SceneError, Trace
from crosscontact.commands import parser
from validation.cases import Case
from validation.runs.pool import Task, TaskResult
from validation.runs.run import Run
from validation.runs.run import run as run_solver
from validation.runs.store import Store
from validation.stability import cases as rows
from validation.stability.cases import AXES, StabilityCase, cases
from validation.stability.expected import CURVE, ClosedForm, EquivalentScene, NoSolution, ReferenceRuns, Value
from validation.stability.matrix import (
    Cell,
    CellVerdict,
    cell_of,
    energy_residual,
    run,
)
from validation.stability.page import limits, work_growth

WITHIN, WRONG, DECLINED = CellVerdict.WITHIN, CellVerdict.WRONG, CellVerdict.DECLINED
ENDINGS = {
    "right": WITHIN,
    "a little off": WITHIN,
    "wrong": WRONG,
    "ends otherwise": WRONG,
    "breaks down": CellVerdict.CRASH,
    "dies": CellVerdict.CRASH,
    "refuses": DECLINED,
    "gives up": DECLINED,
    "right again": WITHIN,
}
SHORTEST_ZONE = {"bem": 8e-4, "fem": 8e-3, "reference": 7e-6}
"""Largest error estimate, of loop energy or curve, at the resolutions of the matrix with a zone of a
millionth of the contact radius and ``V tau/R = 0.02``."""


def one(case: StabilityCase, *answers: Trace | Run, solver: str = "bem") -> Cell:
    """The cell of made-up answers: the solver's, and those that give the expected one."""
    runs = [fakes.answered(found, solver) if isinstance(found, Trace) else found for found in answers]
    asked = Task("", "", print, (Case("", rows.PLAIN), solver))
    return cell_of(case, solver, *(TaskResult(asked, found) for found in runs))


def solved(label: str, axis: str, solver: str) -> Cell:
    """The cell of a real run on a row with a closed form."""
    (case,) = [case for case in cases(axis) if case.label == label]
    return one(case, run_solver(Case("", case.scene), solver, case.resolution(solver)), solver=solver)


def test_every_ending_has_its_verdict_and_a_crash_alone_is_tried_again(tmp_path):
    asked = [fakes.case(title) for title in ENDINGS]
    matrix = run(asked, solvers=("bem",), task=fakes.acted, store=Store(tmp_path))
    found = {cell.label: cell for cell in matrix.cells}
    assert {label: cell.verdict for label, cell in found.items()} == ENDINGS
    assert found["dies"].reason == "the process ended with code 7"
    assert found["breaks down"].reason == "ZeroDivisionError: division by zero"
    assert found["wrong"].error == pytest.approx(0.01)
    assert found["ends otherwise"].error == math.inf
    assert (found["right"].steps, found["right"].rejected_steps) == (3, 1)
    faults = {"wrong", "ends otherwise", "breaks down", "dies"}
    assert {cell.label for cell in matrix.faults} == faults
    again = run(asked, solvers=("bem",), task=partial(fakes.acted, by=fakes.never), store=Store(tmp_path))
    for cell in again.cells:
        if cell.label in ("dies", "breaks down"):
            assert cell.reason == f"asked again: {cell.label}"
        else:
            assert cell == found[cell.label]


@pytest.mark.parametrize("title", ["hangs", pytest.param("waits", marks=pytest.mark.slow)])
def test_a_run_that_hangs_is_killed(title):
    matrix = run([fakes.case(title, seconds=0.4)], solvers=("bem",), task=fakes.acted)
    assert [cell.verdict for cell in matrix.cells] == [CellVerdict.HANG]


def test_no_answer_is_right_where_there_is_none():
    nothing = fakes.case("right", NoSolution("nothing holds"))
    assert one(nothing, Run("", "bem", failure="adhesion.zone: too long", refused=True)).verdict is WITHIN
    assert one(nothing, fakes.trace(kind=OutcomeKind.NO_EQUILIBRIUM)).verdict is WITHIN
    assert one(nothing, fakes.trace()).verdict is WRONG
    assert one(replace(nothing, scene=SceneError("radius", "falls"))).verdict is WITHIN


def test_an_observable_that_is_missing_is_an_error_without_bound():
    """And one relative to a depth on either side of zero counts by its magnitude."""
    for value, error in ((Value("detachment_time", 1.0), math.inf), (Value("final_penetration", -0.01), 2.0)):
        cell = one(fakes.case("right", ClosedForm((value,), "made up")), fakes.trace())
        assert (cell.verdict, cell.error) == (WRONG, pytest.approx(error))


def test_the_front_tracking_adds_its_own_error_and_without_it_nothing_is_compared():
    case = fakes.case("by resolution", ReferenceRuns(("final_force", CURVE), fine=20, coarse=8))
    fine, coarse, off = (fakes.act(Case("", case.scene), "reference", n) for n in (20, 8, 4))
    cell = one(case, coarse, fine, coarse)
    assert cell.expected_error == pytest.approx(0.1 * (1 / 64 - 1 / 400) / 3.0, rel=1e-3)
    assert (cell.verdict, cell.error > 1e-3) == (WITHIN, True)  # of 1e-3 alone
    assert one(case, off, fine, coarse).verdict is WRONG
    broken = fakes.trace(kind=OutcomeKind.STEP_UNDERFLOW)
    assert one(case, fine, fine, broken).verdict is CellVerdict.UNKNOWN


@pytest.mark.parametrize(
    ("past", "expected", "verdict"),
    [
        (True, OutcomeKind.BELOW_ZONE, WITHIN),
        (True, OutcomeKind.DETACHED, WRONG),
        (False, OutcomeKind.DETACHED, DECLINED),
    ],
)
def test_a_contact_below_its_zone_is_an_answer_only_after_the_largest_tension(past, expected, verdict):
    case = fakes.case("below the zone", ReferenceRuns(("loop_energy",)))

    def ended(kind: OutcomeKind) -> Trace:
        trace = fakes.trace(kind=kind)
        return replace(trace, outcome=replace(trace.outcome, past_extremum=past))

    assert one(case, ended(OutcomeKind.BELOW_ZONE), ended(expected), ended(expected)).verdict is verdict


def test_the_matrix_runs_what_is_expected_and_the_other_scene():
    tracked = fakes.case("by resolution", ReferenceRuns(("final_force",), fine=40, coarse=20))
    other = fakes.case("right", EquivalentScene(fakes.scene("wrong")))
    matrix = run([tracked, other], solvers=("bem", "fem"), task=fakes.acted)
    assert [cell.verdict for cell in matrix.cells] == [WRONG] * 4  # 6 a zone: 2.7e-3 off


def test_units_are_undone_column_by_column():
    plain = fakes.trace()
    other = replace(plain, time=60.0 * plain.time, penetration=1e3 * plain.penetration,
                    contact_radius=1e3 * plain.contact_radius, force=1e-3 * plain.force)  # fmt: skip
    expected = EquivalentScene(fakes.scene("right"), length=1e3, stress=1e-9, time=60.0)

    def errors(trace: Trace, base: Trace = plain) -> dict[str, float]:
        return expected.errors(fakes.answered(trace), fakes.answered(base))

    assert max(errors(other).values()) < 1e-12
    assert errors(other, fakes.trace(steps=4)) == {CURVE: math.inf}
    wrong = replace(other, force=other.force * (1.0 + 1e-6))
    assert errors(wrong)["force"] == pytest.approx(1e-6, rel=1e-3)


def cells_of(steps: dict[float, int]) -> list[Cell]:
    return [
        Cell("axis", f"{x:g}", "bem", WITHIN, "completed", "", steps=n, series="s", stiffness=x)
        for x, n in steps.items()
    ]


def test_logarithmic_growth_is_told_from_faster_growth():
    (slow,) = work_growth(cells_of({10.0**k: 100 + 20 * k for k in range(8)}))
    assert slow.logarithmic
    assert (slow.per_decade, slow.at_first) == pytest.approx((20.0, 100.0))
    fast = cells_of({10.0**k: round(100 * 10 ** (0.3 * k)) for k in range(8)})
    assert not work_growth(fast)[0].logarithmic
    assert work_growth(fast)[0].power == pytest.approx(0.3, abs=0.01)
    assert any("FASTER" in line for line in limits(fast))
    assert work_growth(cells_of({1.0: 10, 10.0: 20})) == []


@pytest.mark.slow
def test_the_matrix_has_every_axis_and_every_name_once():
    for name in AXES:
        assert parser().parse_args(["stability", "--only", name]).only == name
    asked = cases()
    assert len({case.name for case in asked}) == len(asked) == 198
    refused = [case for case in asked if not isinstance(case.scene, Scene)]
    assert [type(case.expected) for case in refused] == [NoSolution]


def test_the_energy_of_a_real_run_balances_and_a_false_one_does_not():
    scene = rows.scene(rows.press_and_pull(0.1))
    trace = run_solver(Case("", scene), "reference", 8).trace
    assert energy_residual(trace, scene.material) < 1e-3
    false = replace(trace, stored_energy=1.05 * trace.stored_energy)
    assert energy_residual(false, scene.material) > 0.02


@pytest.mark.parametrize("solver", ["bem", "fem", "reference"])
@pytest.mark.parametrize(
    "label", ["jump of the penetration", pytest.param("jump, then rest", marks=pytest.mark.slow)]
)
def test_all_solvers_on_probes_with_a_closed_form(label, solver):
    cell = solved(label, "loading", solver)
    assert cell.verdict is WITHIN, cell.errors
    assert np.isfinite(cell.residual)


def test_an_elastic_contact_may_shrink_to_its_zone_before_it_is_unstable():
    cell = solved("da/a = 0.5, elastic", "adhesion", "reference")
    assert (cell.verdict, cell.outcome) == (WITHIN, OutcomeKind.BELOW_ZONE), cell.errors


@pytest.mark.slow
def test_elements_follow_the_edge_up_to_its_last_root():
    """Next to it a stride of a quarter element finds no root: with nothing shorter this took 9600 steps."""
    (case,) = [one for one in cases("relaxation-time") if one.label == "tau/T = 1e-12, pulled from rest"]
    assert run_solver(Case("", case.scene), "fem", 4).trace.counters.steps < 3000


@pytest.mark.parametrize(
    "solver",
    [
        pytest.param(name, marks=pytest.mark.exhaustive if name == "fem" else pytest.mark.slow)
        for name in SHORTEST_ZONE
    ],
)
def test_cells_of_the_shortest_zone_are_answered_within_estimates(solver):
    asked = [case for case in cases("adhesion") if case.label.startswith("da/a = 1e-06")]
    cells = run(asked, jobs=2, solvers=(solver,)).cells
    assert [(cell.verdict, cell.outcome) for cell in cells] == [(WITHIN, OutcomeKind.DETACHED)] * 3
    for cell in cells:
        assert np.isfinite(cell.residual)
        assert cell.error <= SHORTEST_ZONE[solver] + cell.expected_error, cell.errors


@pytest.mark.slow
def test_a_part_of_the_matrix_holds():
    asked = [*cases("step")[::2], *cases("scale")[1::2], *cases("speed")[1::3]]
    matrix = run(asked, jobs=2)
    assert [(cell.name, cell.worst, cell.error) for cell in matrix.cells if cell.verdict is not WITHIN] == []
