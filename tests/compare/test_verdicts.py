"""Every way in which a verdict can be wrong: sign, side, roles, missing values, zeros, factors, units.

Numbers are worked out by hand; no solver runs.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from contact_scene import (
    Adhesion,
    Counters,
    Loading,
    Material,
    Outcome,
    OutcomeKind,
    Ramp,
    Scene,
    Sphere,
    Trace,
)
from validation.cases import Case, Expected
from validation.compare.checks import SCALARS, against_reference, check_case, check_run
from validation.measure.difference import agreement_limit, disagreement
from validation.measure.error_estimate import from_two_runs
from validation.measure.observables import Observables
from validation.runs.run import Run

SCENE = Scene(
    Material(0.75, 0.5),
    Sphere(2.0),
    Loading("relaxed", 0.0, (Ramp(0.03, 0.06), Ramp(-0.05, 0.16))),
    Adhesion(1e-3, 0.01),
)
TOLERANCES = {"bem": {"values": 0.01, "curves": 0.01, "movement": 0.02}}
CASE = Case("by hand", SCENE, tolerances=TOLERANCES)


def trace(factor: float = 1.0, kind: OutcomeKind = OutcomeKind.DETACHED, solver: str = "bem") -> Trace:
    """Pressed in by a spring and pulled until tension has passed its maximum; 201 rows."""
    t = np.linspace(0.0, 1.0, 201)
    d = np.where(t < 0.5, 0.06 * t, 0.03 - 0.16 * (t - 0.5))
    force = np.where(t < 0.9, 40.0 * d, -1.36 + 8.0 * (t - 0.9))
    work = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(d))))
    return Trace(
        solver=solver,
        time=t,
        penetration=d,
        force=factor * force,
        contact_radius=factor * (0.2 + 0.1 * np.sin(3.0 * t)),
        stored_energy=np.abs(work),
        external_work=factor * work,
        dissipated_energy=1e-3 * factor * t,
        outcome=Outcome(kind, "by hand", 1.0),
        counters=Counters(),
    )


MEASURES = {
    **dict.fromkeys(SCALARS, 0.5),
    "start_force": 0.0,
    "approach_force": 2.0,
    "loop_energy": -1.0,
    "dissipated_energy": 0.25,
}


def verdicts(change=None, errors=None, base_errors=None, base_change=None, run=None, base=None, case=CASE):
    """Checks by quantity: a run and its reference with the same measures but for some changes."""
    result = Run("by hand", "bem", run or trace(), measures=MEASURES | (change or {}), errors=errors or {})
    other = Run(
        "by hand",
        "reference",
        base or trace(solver="reference"),
        measures=MEASURES | (base_change or {}),
        errors=base_errors or {},
    )
    return {check.quantity: check for check in against_reference(case, result, other)}


def failed(*args, **kwargs) -> set[str]:
    return {name for name, check in verdicts(*args, **kwargs).items() if not check.passed}


def test_equal_runs_agree_in_everything_that_is_measured():
    found = verdicts()
    assert all(check.passed for check in found.values())
    expected = {name for name in SCALARS if not name.startswith("final")}
    assert set(found) == expected | {"outcome", "F(t), RMS", "a(t), RMS", "F(t), movement", "a(t), movement"}
    assert set(Observables().as_dict()) <= {*SCALARS, "peak_time"}  # uncertain as a crest is flat


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", [n for n in SCALARS if not n.startswith("final")])
def test_a_difference_of_either_sign_in_any_observable_fails(name, sign):
    """Differences are relative to 2 for the approach force, 0.5 and more for the others."""
    value = MEASURES[name] + sign * 0.25
    assert failed({name: value}) == {name}
    assert verdicts({name: value})[name].difference * sign > 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_difference_within_the_tolerance_passes_beyond_it_fails(sign):
    assert failed({"approach_force": 2.0 + sign * 2.0 * 0.0099}) == set()
    assert failed({"approach_force": 2.0 + sign * 2.0 * 0.0101}) == {"approach_force"}
    assert failed({"loop_energy": -1.0 + sign * 0.0099}) == set()
    assert failed({"loop_energy": -1.0 + sign * 0.0101}) == {"loop_energy"}


def test_a_difference_is_relative_to_the_reference():
    found = verdicts({"approach_force": 3.0})["approach_force"]
    assert (found.difference, found.expected, found.found) == pytest.approx(
        (0.5, *np.array([2.0, 3.0]) / (4.0 * np.pi))
    )


def test_the_value_of_the_reference_may_be_zero():
    size = 0.05 * np.abs(trace().force).max()
    assert failed({"start_force": 0.009 * size}) == set()
    assert failed({"start_force": -0.011 * size}) == {"start_force"}


def test_final_states_are_compared_where_contact_is_kept():
    kept = {"run": trace(kind=OutcomeKind.COMPLETED), "base": trace(kind=OutcomeKind.COMPLETED)}
    for name in ("final_force", "final_radius", "final_penetration", "final_time"):
        assert failed({name: MEASURES[name] + 1.0}, **kept) == {name}


@pytest.mark.parametrize(
    "name", ["pull_off_force", "detachment_radius", "approach_time", "dissipated_energy"]
)
def test_a_value_that_only_one_of_the_runs_gives_fails(name):
    assert failed({name: None}) == {name}
    assert verdicts({name: None})[name].note == "the run does not give it"
    assert failed(base_change={name: None}) == {name}
    assert verdicts(base_change={name: None})[name].note == "the reference gives none"
    assert failed({name: None}, base_change={name: None}) == set()


@pytest.mark.parametrize("kind", [OutcomeKind.COMPLETED, OutcomeKind.BELOW_ZONE])
def test_a_run_that_ends_in_another_way_fails(kind):
    assert failed(run=trace(kind=kind)) == {"outcome"}
    assert "outcome" in failed(base=trace(kind=kind))


def test_where_two_solvers_agree_and_the_reference_does_not_the_reference_fails():
    tolerances = dict.fromkeys(("bem", "fem"), TOLERANCES["bem"])
    case = dataclasses.replace(CASE, tolerances=tolerances)
    runs = {
        "reference": Run(
            "by hand", "reference", trace(0.5, OutcomeKind.COMPLETED), measures={"approach_force": 0.5}
        ),
        "bem": Run("by hand", "bem", trace(), measures={"approach_force": 1.0}),
        "fem": Run("by hand", "fem", trace(1.001), measures={"approach_force": 1.001}),
    }
    wrong = {(one.solver, one.quantity) for one in check_case(case, runs) if not one.passed}
    assert {solver for solver, _ in wrong} == {"reference"}
    assert {"outcome", "approach_force", "F(t), RMS"} <= {quantity for _, quantity in wrong}
    runs["fem"] = Run("by hand", "fem", trace(0.5, OutcomeKind.COMPLETED), measures={"approach_force": 0.5})
    wrong = {one.solver for one in check_case(case, runs) if not one.passed}
    assert wrong == {"bem"}


def test_no_run_and_no_reference_fail():
    for missing in (0, 1):
        runs = [Run("by hand", name, trace(), measures=MEASURES) for name in ("bem", "reference")]
        runs[missing] = dataclasses.replace(runs[missing], trace=None)
        assert [check.passed for check in against_reference(CASE, *runs)] == [False]


@pytest.mark.parametrize("factor", [1.03, 0.97])
def test_a_curve_too_high_or_too_low_fails(factor):
    curves = {"F(t), RMS", "F(t), movement", "a(t), RMS", "a(t), movement"}
    assert failed(run=trace(factor)) >= {"F(t), RMS", "a(t), RMS"}
    assert failed(run=trace(factor)) <= curves
    assert failed(run=trace(1.0 + (factor - 1.0) / 6.0)) == set()


def test_an_edge_that_stays_where_it_is_fails_by_its_movement_alone():
    """The radius differs by a thousandth of itself, and moves by two."""
    t = trace().time
    base = dataclasses.replace(trace(), contact_radius=1.0 + 0.01 * np.sin(6.0 * t))
    still = dataclasses.replace(
        base, contact_radius=np.where(t > 0.9, base.contact_radius[180], base.contact_radius)
    )
    assert failed(run=still, base=base) == {"a(t), movement"}


ESTIMATES = [
    (0.004, 0.003, 0.002, True),
    (0.006, 0.003, 0.002, False),
    (0.004, 0.005, None, True),  # one estimate says nothing
    (0.006, 0.001, None, True),
    (0.006, None, 0.001, True),
    (0.009, 0.02, 0.02, True),
    (0.011, 0.02, 0.02, False),  # the tolerance caps what estimates excuse
    (0.0, 0.04, 0.0, False),  # four times the tolerance: agreement by accident
    (0.0, 0.0, 0.04, False),
    (0.0, 0.03, 0.0, True),
    (0.0, math.nan, 0.0, False),
    (0.0, -1.0, 0.0, False),
    (0.0, math.inf, 0.0, False),
    (math.nan, 0.001, 0.001, False),
    (math.inf, None, None, False),
    (0.001, 0.0, 0.0, False),  # who claims to be exact has to be
]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("difference", "mine", "theirs", "agrees"), ESTIMATES)
def test_agreement_is_within_both_estimates(difference, mine, theirs, agrees, sign):
    assert (disagreement(sign * difference, 0.01, mine, theirs) == "") is agrees
    if math.isfinite(difference):
        name = "approach_force"
        errors = [{} if error is None else {name: error} for error in (mine, theirs)]
        assert (name not in failed({name: 2.0 * (1.0 + sign * difference)}, *errors)) is agrees


def test_the_limit_is_the_sum_of_both_estimates():
    assert agreement_limit(0.01, 0.002, 0.003) == pytest.approx(0.005, abs=1e-8)
    assert agreement_limit(0.01, 0.02, 0.0) == 0.01
    found = verdicts(errors={"approach_force": 0.002}, base_errors={"approach_force": 0.003})[
        "approach_force"
    ]
    assert (found.estimate, found.base_estimate) == (0.002, 0.003)
    assert found.limit == pytest.approx(0.005, abs=1e-8)


@pytest.mark.parametrize(("solver", "factor"), [("fem", 1.0), ("bem", 3.0)])
def test_an_estimate_is_three_times_the_extrapolated_difference(solver, factor):
    """Second order: 3/(2^2 - 1) of the difference; first order: 3/(2^1 - 1)."""
    run = trace(solver=solver)
    found = from_two_runs(run, run, {"approach_force": 2.0}, {"approach_force": 2.0 * 1.05})
    assert found["approach_force"] == pytest.approx(factor * 0.05)
    assert from_two_runs(run, run, {"approach_force": 2.0}, {"approach_force": 2.0 * 0.95})[
        "approach_force"
    ] == pytest.approx(factor * 0.05)


def value_check(measured: float | None, **expected):
    expectation = Expected("approach_force", "on paper", **expected)
    case = dataclasses.replace(CASE, expected=(expectation,))
    result = Run("by hand", "bem", trace(), measures=MEASURES | {"approach_force": measured})
    return check_run(case, result)[1:]


@pytest.mark.parametrize(
    ("measured", "passes"),
    [(-4.03, True), (-3.97, True), (-4.05, False), (-3.95, False), (4.0, False), (None, False)],
)
def test_check_values_of_either_sign(measured, passes):
    (check,) = value_check(measured, value=-4.0, tolerance={"bem": 0.01})
    assert check.passed is passes
    assert check.difference is None or check.difference == pytest.approx((measured + 4.0) / 4.0)


@pytest.mark.parametrize(
    ("measured", "passes"), [(0.019, True), (-0.019, True), (0.021, False), (-0.021, False)]
)
def test_check_values_of_zero_are_relative_to_a_scale(measured, passes):
    assert value_check(measured, value=0.0, scale=2.0, tolerance={"bem": 0.01})[0].passed is passes


@pytest.mark.parametrize(
    ("measured", "at_most", "at_least"),
    [
        (1.0, True, True),
        (1.0001, False, True),
        (0.9999, True, False),
        (-2.0, True, False),
        (None, False, False),
    ],
)
def test_limits_hold_on_one_side(measured, at_most, at_least):
    assert value_check(measured, at_most=1.0)[0].passed is at_most
    assert value_check(measured, at_least=1.0)[0].passed is at_least


def test_a_check_value_holds_for_the_solvers_it_names():
    assert value_check(7.0, value=1.0, tolerance={"fem": 0.01}) == []


def test_check_values_are_in_their_unit():
    """Unit of force of a sphere of radius 2: pi E0 R^2/(1 - nu^2) = 4 pi."""
    (check,) = value_check(4.0 * math.pi, value=1.0, unit="force", tolerance={"bem": 1e-9})
    assert check.passed
    assert check.found == pytest.approx(1.0)


def test_a_check_at_a_time_reads_its_column_there():
    (check,) = value_check(None, value=40.0 * 0.0151, at_time=0.25166666666666665, tolerance={"bem": 1e-9})
    assert not check.passed  # approach_force is no column
    expectation = Expected(
        "force", "on paper", value=40.0 * 0.0151, at_time=0.0151 / 0.06, tolerance={"bem": 1e-9}
    )
    for end, passes in ((1.0, True), (0.2, False)):
        case = dataclasses.replace(CASE, expected=(expectation,))
        run = trace()
        rows = run.time <= end
        short = {name: column[rows] for name, column in run.columns().items()}
        result = Run("by hand", "bem", dataclasses.replace(run, **short), measures=MEASURES)
        assert check_run(case, result)[1].passed is passes


@pytest.mark.parametrize(
    ("expected", "kind", "passes"),
    [
        ("", OutcomeKind.COMPLETED, True),
        ("", OutcomeKind.DETACHED, True),
        ("", OutcomeKind.BELOW_ZONE, False),
        ("", OutcomeKind.INTERRUPTED, False),
        ("", OutcomeKind.STEP_BUDGET, False),
        ("detached", OutcomeKind.DETACHED, True),
        ("detached", OutcomeKind.COMPLETED, False),
    ],
)
def test_the_ending_is_the_one_expected(expected, kind, passes):
    case = dataclasses.replace(CASE, outcome=expected)
    assert check_run(case, Run("by hand", "bem", trace(kind=kind)))[0].passed is passes
