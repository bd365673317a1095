"""How the run of any solver begins, stops and ends; the memory it leaves; divisions of the quick suite."""

from __future__ import annotations

import gc
import math
import tracemalloc
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.paper_scenes import WORK, scene

import bem_solver
from contact_scene import Adhesion, Force, ForceRamp, Hold, Material, OutcomeKind, Ramp, SceneError
from validation import cases, scenes, solvers
from validation.reference import path as reference
from validation.runs.pool import quick_resolution, run_all
from validation.solvers import solver
from validation.solvers.base import QUICK_DIVISIONS

every_solver = pytest.mark.parametrize("name", ["bem", "fem", "reference"])
PRESS = scene(Ramp(0.022, 0.02), start="relaxed", at=0.02)


def finite(trace):
    return all(np.isfinite(column).all() for column in trace.columns().values())


@every_solver
@pytest.mark.parametrize("start", ["relaxed", "jump-in"])
def test_above_the_surface_there_is_no_equilibrium(name, start):
    trace = solver(name).solve(scene(Ramp(0.1, 0.1), start=start, at=-0.1), 4)
    assert trace.outcome.kind is OutcomeKind.NO_EQUILIBRIUM
    assert not trace.outcome.finished
    assert len(trace) == 0


@every_solver
def test_a_start_state_alone_is_one_row(name):
    trace = solver(name).solve(scene(at=0.01), 4)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert (len(trace), trace.counters.steps) == (1, 0)
    assert trace.contact_radius[0] > 0.1


@every_solver
def test_a_budget_of_steps_keeps_what_was_computed(name):
    asked = scene(Ramp(0.03, 0.02), start="relaxed", at=0.02)
    longer, trace = (solver(name).solve(asked, 4, max_steps=steps) for steps in (12, 7))
    assert trace.outcome.kind is OutcomeKind.STEP_BUDGET
    assert not trace.outcome.finished
    assert trace.counters.steps + trace.counters.rejected_steps == 7
    assert 2 < len(trace) < len(longer)
    assert trace.outcome.time == trace.time[-1]
    assert_allclose(trace.force, longer.force[: len(trace)], rtol=1e-4)
    assert finite(trace)


@every_solver
def test_progress_rises_to_one_and_changes_nothing(name):
    asked, shares = scene(Ramp(0.021, 0.02), Hold(0.0), Hold(0.1), start="relaxed", at=0.02), []
    trace = solver(name).solve(asked, 4, progress=shares.append)
    assert len(shares) >= trace.counters.steps
    assert shares[0] >= 0.0
    assert np.all(np.diff(shares) >= 0.0)
    assert shares[-1] == pytest.approx(1.0)
    assert_allclose(solver(name).solve(asked, 4).force, trace.force, rtol=1e-12)


@every_solver
def test_stop_times_are_stepped_onto_and_have_no_profile(name):
    trace = solver(name).solve(PRESS, 4, stop_times=(0.0, 0.0321, 9.0), profile_times=(0.05,))
    assert {0.0321, 0.05} <= set(trace.time)
    assert [profile.time for profile in trace.profiles] == [0.05]


@every_solver
def test_a_zone_longer_than_the_contact_is_refused(name):
    stiff = scene(at=1e-3, material=Material(7500.0, 0.5), adhesion=Adhesion(WORK, 0.5))
    with pytest.raises(SceneError, match="zone"):
        solver(name).solve(stiff, 4)


@pytest.mark.parametrize("name", ["bem", "reference"])
def test_where_nothing_touches_nothing_happens(name):
    """Withdrawn the run completes; under a tension the indenter is gone at once."""
    never = solver(name).solve(scene(Ramp(-0.03, 0.05), at=-0.01, adhesion=None), 4)
    assert never.outcome.kind is OutcomeKind.COMPLETED
    assert not never.contact_radius.any()
    for step, at in product((Force(-2e-3, 1.0), ForceRamp(-2e-3, 0.01)), (-5e-3, 0.0)):
        pulled = solver(name).solve(scene(step, at=at, adhesion=None), 4)
        assert (pulled.outcome.kind, pulled.outcome.reason) == (
            OutcomeKind.DETACHED,
            "pulled without contact",
        )
        assert not pulled.force.any()


@pytest.mark.parametrize("options", [bem_solver.Options, reference.Options], ids=["bem", "reference"])
@pytest.mark.parametrize(
    "wrong",
    [
        *({"resolution": value} for value in (0, 6.5, True, "6")),
        *({"tolerance": value} for value in (0.0, -1.0, math.nan, 2.0)),
        *({key: (0.0, value)} for key in ("profile_times", "stop_times") for value in (math.inf, "late")),
        {"max_steps": 0},
    ],
    ids=str,
)
def test_options_are_checked(options, wrong):
    with pytest.raises(SceneError, match=next(iter(wrong))) as error:
        options(**wrong)
    assert "allowed" in str(error.value)


LEAST = 2**21
"""Bytes that may wait for the garbage collection, which seldom looks at old objects."""


@pytest.mark.parametrize(
    "scene", ["elastic-relaxed", pytest.param("pdms-retraction-100nm", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("solver", solvers.SOLVERS)
def test_a_finished_run_is_freed_without_the_garbage_collection(solver, scene):
    case, method = cases.load(scene), solvers.solver(solver)
    method.load()
    method.solve(case.scene, 4, max_steps=3)  # what is looked up once a process
    gc.collect()
    tracemalloc.start()
    gc.disable()
    try:
        method.solve(case.scene, 4, max_steps=30)
        left, _ = tracemalloc.get_traced_memory()
        gc.collect()
        waited = left - tracemalloc.get_traced_memory()[0]
    finally:
        gc.enable()
        tracemalloc.stop()
    assert waited < LEAST


@pytest.mark.parametrize("name", scenes.suite("quick"))
@pytest.mark.parametrize("solver", solvers.SOLVERS)
def test_no_solver_is_finer_than_by_default_nor_than_the_suite_asks(solver, name):
    case = cases.load(name)
    default, chosen = solvers.solver(solver).default_resolution(case.scene), quick_resolution(case, solver)
    assert chosen == (default if solver == "fem" else min(default, QUICK_DIVISIONS))


def test_a_quick_run_is_that_of_its_resolution():
    case = cases.load("elastic-glassy")
    found = run_all([(case, "bem")], quick=True)["elastic-glassy", "bem"]
    coarse = solvers.solver("bem").solve(case.scene, QUICK_DIVISIONS)
    assert found.trace is not None
    assert found.trace.counters.steps == coarse.counters.steps
    assert found.trace.force.tolist() == coarse.force.tolist()


def test_a_solver_that_is_not_known_here_chooses_itself():
    assert quick_resolution(cases.load("elastic-glassy"), "another") is None
