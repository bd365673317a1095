"""Does the quick suite catch wrong physics? Single faults, one at a time, against the suite's own checks.

A fault counts as caught if a check of the quick suite that passes for the true solvers fails with the fault.
It is tried on the scenes it names, otherwise on the cheapest of that suite. One that names scenes or is tried
in CI has to be caught; any other that slips through all of those must not change any observable by more than
one per cent there. Tolerances alone are asked first; error estimates, which only narrow them and cost more
runs, where those show nothing. What all solvers share is tried on one solver, against check values alone.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import product

import numpy as np
import pytest
from support.faults import altered, bem, fem, reference, shared
from support.faults.injection import Fault, seeded, stale, time_limit

from validation import cases, scenes, solvers
from validation.compare.checks import check_case, check_run
from validation.measure.curves import distance
from validation.measure.error_estimate import ENERGIES
from validation.measure.scaling import column_of, scale
from validation.runs.pool import quick_resolution
from validation.runs.run import Run, run

FAULTS = [*reference.FAULTS, *bem.FAULTS, *fem.FAULTS, *altered.FAULTS, *shared.FAULTS]
SCENES = ("relaxed-equilibrium", "elastic-relaxed", "cycle-v0.02", "adhesionless-cycle", "three-branches")
NOTICEABLE = 0.01
CHEAP = "punch-programme"
CHEAP_TABLES = [fault for fault in altered.FAULTS if fault.scenes == (CHEAP,)][::3]
CHEAP_SHARED = [fault for fault in shared.FAULTS if fault.scenes == (CHEAP,)]
QUICKLY = [
    *CHEAP_SHARED[::2],
    *CHEAP_TABLES[::2],
    *(pytest.param(fault, marks=pytest.mark.slow) for fault in (*CHEAP_SHARED[1::2], *CHEAP_TABLES[1::2])),
]
"""Faults that a check value of the cheapest scene has to show, every other one by default."""
IN_CI = (
    "reference: tension and compression swapped",
    "bem: gap longer by a length of 1e-6",
    "bem: an earlier row's stage taken for its penetration",
    "bem: points of a step over zones released a tenth too early",
    "bem: path of a step over zones straight",
    "bem: branches faster than the steps taken for slow ones",
    "bem: force ramps 3 % too fast",
    "bem: cones half a degree too sharp",
    "bem: measured profile by straight lines",
    "bem: an edge that turned goes on as if it had not",
    "bem: answer: contact given up half a zone too early",
    "fem: energy without a branch",
    "fem: bulk relaxes like shear",
    "fem: relaxation times close together joined",
    "fem: surface 0.5 % narrower than its mesh",
    "reference: answer: tensions 1 % too small",
    "reference: holds 3 % too long",
    "shared: force ramps twice as fast",
    "shared: a cone's angle as the whole",
    "shared: heights of a table by straight lines",
    "shared: approach ends at the last of its deepest rows",
    "shared: contact lost half a zone too early",
    "shared: units of an energy 1 % too large",
    "shared: spring 1 % too soft",
)
"""One fault of each kind and regime, tried with the slow tests; the marker ``exhaustive`` has the others.

Tables, holds and forces that all solvers share are in ``QUICKLY``, too. What takes long is left to tests
of an edge that is pinned and of steps over zones.
"""
TIME_FACTOR = 10.0  # limit of a run with a fault, times processor time of the true run and its estimate ...
LEAST_LIMIT = 10.0  # ... and at least so many seconds


def beside(fault: Fault) -> set[str]:
    """Solvers whose true runs a fault needs: its own, the reference, one more where it is the reference's."""
    if fault.shared:
        return {fault.solver}
    return {fault.solver, solvers.REFERENCE, *({"bem"} if fault.solver == solvers.REFERENCE else ())}


def as_in_the_suite(case: cases.Case, solver: str, estimate: bool = False) -> Run:
    """A run as the quick suite has it."""
    return run(case, solver, quick_resolution(case, solver), estimate=estimate)


@cache
def unharmed(name: str, solver: str, estimate: bool) -> Run:
    """The true solver on a scene, with or without error estimates."""
    return as_in_the_suite(cases.load(name), solver, estimate)


def clean_runs(name: str, fault: Fault, estimate: bool) -> dict[str, Run]:
    """The true runs that a fault needs on a scene, without a check that fails."""
    runs = {solver: unharmed(name, solver, estimate) for solver in sorted(beside(fault))}
    failed = [check for check in check_case(cases.load(name), runs) if not check.passed]
    assert not failed, failed
    return runs


def effect(true: Run, wrong: Run) -> tuple[float, str]:
    """Largest relative change of an observable or a curve, and its name; infinite without a curve."""
    if true.trace is None or wrong.trace is None or len(wrong.trace) == 0:
        return math.inf, "outcome"
    changes: dict[str, float] = {}
    for column, values in true.trace.columns().items():
        if column in ("balance_residual", "energy_release_rate", "stress_intensity_factor"):
            continue  # noise, a difference quotient, and what only one solver reports
        apart = distance(wrong.trace, true.trace, column)
        single = len(true.trace) == 1
        largest = float(np.abs(values).max()) or 1.0
        first = abs(wrong.trace.columns()[column][0] - values[0]) / largest
        changes[column] = first if single or apart is None else apart.rms
    for name, value in true.measures.items():
        now = wrong.measures.get(name)
        if value is None or name.startswith("final") or not (column_of(name) or name in ENERGIES):
            continue
        if now is None:
            return math.inf, name
        size = scale(name, value, true.trace)
        changes[name] = abs(now - value) / size if size > 0.0 else float(now != value)
    worst = max(changes, key=lambda name: changes[name])
    return changes[worst], worst.replace("_", " ")


def same(true: Run, wrong: Run) -> bool:
    """Whether not a bit of any column has changed."""
    if true.trace is None or wrong.trace is None:
        return False
    mine, theirs = true.trace.columns(), wrong.trace.columns()
    return all(np.array_equal(mine[name], theirs[name]) for name in mine)


@np.errstate(all="ignore")
def examine(fault: Fault) -> tuple[bool, float, str]:
    """Run the scenes with the fault until a check fails: whether one does, the largest effect and on what."""
    largest, called, changed, caught = (0.0, "nothing"), 0, False, False
    for name, estimate in product(fault.scenes or SCENES, (False,) if fault.shared else (False, True)):
        clean = clean_runs(name, fault, estimate)
        before = clean[fault.solver]
        limit = max(LEAST_LIMIT, TIME_FACTOR * (before.cpu_seconds + before.estimate_seconds))
        with seeded(fault) as calls, time_limit(limit):
            case = cases.load(name)
            wrong = as_in_the_suite(case, fault.solver, estimate)
            runs = {fault.solver: wrong} if fault.shared else {**clean, fault.solver: wrong}
            caught = not all(check.passed for check in check_case(case, runs))
        called += calls.count
        changed = changed or fault.shared or not same(before, wrong)
        largest = max(largest, effect(before, wrong))
        if caught:
            break
    assert called, "the wrong function is never called: the fault tests nothing"
    assert caught or changed, "the wrong function changes nothing: the fault tests nothing"
    return caught, *largest


def test_every_fault_fits_a_function_that_exists():
    lines = stale(FAULTS)
    assert not lines, "\n" + "\n".join(lines)


def test_the_scenes_belong_to_the_quick_suite():
    named = {name for fault in FAULTS for name in fault.scenes}
    assert named | set(SCENES) <= set(scenes.suite("quick"))


@pytest.mark.parametrize("solver", solvers.SOLVERS)
def test_check_values_hold_without_a_fault(solver):
    case = cases.load(CHEAP)
    found = as_in_the_suite(case, solver)
    assert [check for check in check_run(case, found) if not check.passed] == []


@pytest.mark.parametrize("fault", QUICKLY, ids=lambda fault: fault.key)
def test_check_values_catch_a_fault(fault):
    """Those of one scene, which pass through no solver."""
    with seeded(fault) as calls, time_limit(LEAST_LIMIT), np.errstate(all="ignore"):
        case = cases.load(CHEAP)
        found = as_in_the_suite(case, fault.solver)
        failed = [check for check in check_run(case, found) if not check.passed]
    assert calls.count
    assert failed


def test_the_faults_tried_in_ci_exist():
    assert set(IN_CI) <= {fault.key for fault in FAULTS}


@pytest.mark.parametrize(
    "fault",
    [
        pytest.param(fault, marks=pytest.mark.slow if fault.key in IN_CI else pytest.mark.exhaustive)
        for fault in FAULTS
    ],
    ids=lambda fault: fault.key,
)
def test_fault_is_caught_or_small(fault):
    caught, largest, most = examine(fault)
    small = not fault.scenes and fault.key not in IN_CI and largest <= NOTICEABLE
    assert caught or small, f"{largest:.2g} in {most}"
