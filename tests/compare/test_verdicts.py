"""Every way in which a verdict can be wrong: sign, side, roles, missing values, zeros, factors, units.

Numbers are worked out by hand; no solver runs.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from support.synthetic_traces import by_hand, work_of

import contact_scene as cs
from validation.cases import Case, Expected
from validation.compare.checks import SCALARS, against_reference, check_case, check_run
from validation.measure.difference import Difference, agreement_limit
from validation.runs.run import Run

SCENE = cs.Scene(
    cs.Material(0.75, 0.5),
    cs.Sphere(2.0),
    cs.Loading("relaxed", 0.0, (cs.Ramp(0.03, 0.06), cs.Ramp(-0.05, 0.16))),
    cs.Adhesion(1e-3, 0.01),
)
TOLERANCES = {name: {"values": 0.01, "curves": 0.01, "movement": 0.02} for name in ("bem", "fem")}
CASE = Case("by hand", SCENE, tolerances=TOLERANCES)
FINAL = {name for name in SCALARS if name.startswith("final")}
CURVES = {"F(t), RMS", "F(t), movement", "a(t), RMS", "a(t), movement"}


def trace(
    factor: float = 1.0, kind: cs.OutcomeKind = cs.OutcomeKind.DETACHED, solver: str = "bem"
) -> cs.Trace:
    """Pressed in by a spring and pulled until tension has passed its maximum; 201 rows."""
    t = np.linspace(0.0, 1.0, 201)
    d = np.where(t < 0.5, 0.06 * t, 0.03 - 0.16 * (t - 0.5))
    force = np.where(t < 0.9, 40.0 * d, -1.36 + 8.0 * (t - 0.9))
    rows = {"penetration": d, "force": force, "contact_radius": 0.2 + 0.1 * np.sin(3.0 * t)}
    made = work_of(by_hand(t, kind, solver, dissipated_energy=1e-3 * t, **rows))
    made = dataclasses.replace(made, stored_energy=np.abs(made.external_work))
    scaled = ("force", "contact_radius", "external_work", "dissipated_energy")
    return dataclasses.replace(made, **{name: factor * getattr(made, name) for name in scaled})


MEASURES = {
    **dict.fromkeys(SCALARS, 0.5),
    "start_force": 0.0,
    "approach_force": 2.0,
    "loop_energy": -1.0,
    "dissipated_energy": 0.25,
}


def verdicts(change=None, errors=None, base_errors=None, base_change=None, run=None, base=None):
    """Checks by quantity: a run and its reference with the same measures but for some changes."""
    first, second = run or trace(), base or trace(solver="reference")
    result = Run("by hand", "bem", first, measures=MEASURES | (change or {}), errors=errors or {})
    other = Run(
        "by hand", "reference", second, measures=MEASURES | (base_change or {}), errors=base_errors or {}
    )
    return {check.quantity: check for check in against_reference(CASE, result, other)}


def failed(*args, **kwargs) -> set[str]:
    return {name for name, check in verdicts(*args, **kwargs).items() if not check.passed}


@pytest.mark.parametrize("kind", [cs.OutcomeKind.DETACHED, cs.OutcomeKind.COMPLETED])
def test_all_that_is_measured_is_compared_and_a_difference_of_either_sign_fails(kind):
    """Relative to 2 for the approach force, 0.5 and more for the others; final states of contacts kept."""
    runs = {"run": trace(kind=kind), "base": trace(kind=kind)}
    names = set(SCALARS) - (FINAL if kind is cs.OutcomeKind.DETACHED else set())
    found = verdicts(**runs)
    assert all(check.passed for check in found.values())
    assert set(found) == names | {"outcome"} | CURVES
    for name in names:
        for change in (0.25, -0.25):
            changed = {name: MEASURES[name] + change}
            assert failed(changed, **runs) == {name}
            assert verdicts(changed, **runs)[name].difference * change > 0.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("share", "passes"), [(0.0099, True), (0.0101, False)])
def test_a_difference_is_relative_to_the_reference_or_a_twentieth_of_the_largest(sign, share, passes):
    least = 0.05 * np.abs(trace().force).max()
    for name, size in (("approach_force", 2.0), ("loop_energy", 1.0), ("start_force", least)):
        changed = MEASURES[name] + sign * share * size
        assert failed({name: changed}) == (set() if passes else {name})
    found = verdicts({"approach_force": 3.0})["approach_force"]
    shown = 0.5, 2.0 / (4.0 * np.pi), 3.0 / (4.0 * np.pi)
    assert (found.difference, found.expected, found.found) == pytest.approx(shown)


@pytest.mark.parametrize("name", ["pull_off_force", "detachment_radius", "approach_time"])
def test_a_value_that_only_one_of_the_runs_gives_fails(name):
    assert failed({name: None}) == failed(base_change={name: None}) == {name}
    assert verdicts({name: None})[name].note == "the run does not give it"
    assert verdicts(base_change={name: None})[name].note == "the reference gives none"
    assert failed({name: None}, base_change={name: None}) == set()


@pytest.mark.parametrize("kind", [cs.OutcomeKind.COMPLETED, cs.OutcomeKind.BELOW_ZONE])
def test_a_run_that_ends_in_another_way_or_not_at_all_fails(kind):
    assert failed(run=trace(kind=kind)) == {"outcome"}
    assert "outcome" in failed(base=trace(kind=kind))
    for missing in (0, 1):
        runs = [Run("by hand", name, trace(), measures=MEASURES) for name in ("bem", "reference")]
        runs[missing] = dataclasses.replace(runs[missing], trace=None)
        assert [check.passed for check in against_reference(CASE, *runs)] == [False]


def test_where_two_solvers_agree_and_the_reference_does_not_the_reference_fails():
    def wrong(**factors):
        kinds = {0.5: cs.OutcomeKind.COMPLETED}
        runs = {
            name: Run("by hand", name, trace(size, kinds.get(size, cs.OutcomeKind.DETACHED)),
                      measures={"approach_force": size})
            for name, size in factors.items()
        }  # fmt: skip
        return {(one.solver, one.quantity) for one in check_case(CASE, runs) if not one.passed}

    found = wrong(reference=0.5, bem=1.0, fem=1.001)
    assert {solver for solver, _ in found} == {"reference"}
    assert {"outcome", "approach_force", "F(t), RMS"} <= {quantity for _, quantity in found}
    assert {solver for solver, _ in wrong(reference=0.5, bem=1.0, fem=0.5)} == {"bem"}


def test_curves_are_compared_by_size_and_by_movement():
    """An edge that stays where it is differs by a thousandth of its radius, and moves by two."""
    for factor in (1.03, 0.97):
        assert {"F(t), RMS", "a(t), RMS"} <= failed(run=trace(factor)) <= CURVES
        assert failed(run=trace(1.0 + (factor - 1.0) / 6.0)) == set()
    t = trace().time
    base = dataclasses.replace(trace(), contact_radius=1.0 + 0.01 * np.sin(6.0 * t))
    stays = np.where(t > 0.9, base.contact_radius[180], base.contact_radius)
    assert failed(run=dataclasses.replace(base, contact_radius=stays), base=base) == {"a(t), movement"}


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
    (math.nan, 0.001, 0.001, False),
    (math.inf, None, None, False),
    (0.001, 0.0, 0.0, False),  # who claims to be exact has to be
]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("difference", "mine", "theirs", "agrees"), ESTIMATES)
def test_agreement_is_within_both_estimates(difference, mine, theirs, agrees, sign):
    assert (Difference("a number", sign * difference, mine, theirs).disagreement(0.01) == "") is agrees
    if math.isfinite(difference):
        name = "approach_force"
        errors = [{} if error is None else {name: error} for error in (mine, theirs)]
        found = verdicts({name: 2.0 * (1.0 + sign * difference)}, *errors)[name]
        assert (found.passed, found.estimate, found.base_estimate) == pytest.approx(
            (agrees, mine, theirs), nan_ok=True
        )
        assert found.limit == agreement_limit(0.01, mine, theirs) or math.isnan(mine)
        assert ("parts at t =" in found.note) <= (not agrees)


def value_check(measured: float | None, end: float = 1.0, **expected):
    expectation = Expected(**{"observable": "approach_force", "source": "on paper"} | expected)
    case = dataclasses.replace(CASE, expected=(expectation,))
    rows = trace().time <= end
    run = dataclasses.replace(trace(), **{name: c[rows] for name, c in trace().columns().items()})
    result = Run("by hand", "bem", run, measures=MEASURES | {"approach_force": measured})
    return check_run(case, result)[1:]


WITHIN = {"tolerance": {"bem": 0.01}}
AT = {"observable": "force", "value": 40.0 * 0.0151, "at_time": 0.0151 / 0.06, "tolerance": {"bem": 1e-9}}


@pytest.mark.parametrize(
    ("measured", "expected", "passes"),
    [
        (-4.03, {"value": -4.0, **WITHIN}, True),
        (-3.95, {"value": -4.0, **WITHIN}, False),
        (4.0, {"value": -4.0, **WITHIN}, False),
        (None, {"value": -4.0, **WITHIN}, False),
        (-0.019, {"value": 0.0, "scale": 2.0, **WITHIN}, True),
        (0.021, {"value": 0.0, "scale": 2.0, **WITHIN}, False),
        (1.0, {"at_most": 1.0}, True),
        (1.0001, {"at_most": 1.0}, False),
        (1.0, {"at_least": 1.0}, True),
        (0.9999, {"at_least": 1.0}, False),
        (None, {"at_least": 1.0}, False),
        # the unit of force of a sphere of radius 2: pi E0 R^2/(1 - nu^2) = 4 pi
        (4.0 * math.pi, {"value": 1.0, "unit": "force", "tolerance": {"bem": 1e-9}}, True),
        (0.0, AT, True),
        (0.0, AT | {"end": 0.2}, False),
        (0.0, AT | {"observable": "approach_force"}, False),  # which is no column
    ],
)
def test_check_values(measured, expected, passes):
    (check,) = value_check(measured, **expected)
    assert check.passed is passes
    if expected.get("value") == -4.0 and measured is not None:
        assert check.difference == pytest.approx((measured + 4.0) / 4.0)


def test_a_check_value_holds_for_the_solvers_it_names():
    assert value_check(7.0, value=1.0, tolerance={"fem": 0.01}) == []


@pytest.mark.parametrize(
    ("expected", "kind", "passes"),
    [
        ("", cs.OutcomeKind.COMPLETED, True),
        ("", cs.OutcomeKind.DETACHED, True),
        ("", cs.OutcomeKind.BELOW_ZONE, False),
        ("", cs.OutcomeKind.STEP_BUDGET, False),
        ("detached", cs.OutcomeKind.DETACHED, True),
        ("detached", cs.OutcomeKind.COMPLETED, False),
    ],
)
def test_the_ending_is_the_one_expected(expected, kind, passes):
    case = dataclasses.replace(CASE, outcome=expected)
    assert check_run(case, Run("by hand", "bem", trace(kind=kind)))[0].passed is passes
