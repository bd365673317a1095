"""Divisions in the quick suite."""

from __future__ import annotations

import pytest

from validation import cases, scenes, solvers
from validation.runs.pool import quick_resolution, run_all
from validation.solvers.base import QUICK_DIVISIONS


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
