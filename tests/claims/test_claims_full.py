"""The paper's statements on real runs: every recorded verdict is the one found."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from validation.claims.claim import Verdict
from validation.claims.evidence import SOLVER, Evidence, collect, required_runs
from validation.claims.page import CLAIMS, findings
from validation.claims.paper_figures import FIGURES, draw_figure
from validation.runs.pool import run_all, run_of, run_task, run_tasks
from validation.solvers.model_range import cycle_count

MANY = 30.0
"""Cycles of an oscillation from which the slow tests leave a run out."""
COARSE = 4
"""Annuli per zone of the boundary elements: a third of the default gives the same verdicts."""


def processes() -> ProcessPoolExecutor:
    return ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn"))


def short_runs() -> Evidence:
    """The required runs that are not long."""
    asked = [(case, solver) for case, solver in required_runs() if cycle_count(case.scene) < MANY]
    tasks = [run_task(case, solver, COARSE if solver == SOLVER else None) for case, solver in asked]
    with processes() as executor:
        runs = map(run_of, run_tasks(tasks, executor))
        return collect(asked, {(run.scene, run.solver): run for run in runs})


@pytest.mark.slow
def test_statements_that_need_no_long_run_have_their_recorded_verdicts():
    results = findings(short_runs())
    judged = [one for one in results if one.verdict is not Verdict.NOT_EVALUATED]
    assert len(judged) > 0.8 * len(CLAIMS)
    assert {one.name: (str(one.verdict), one.shown) for one in judged if one.changed} == {}


@pytest.mark.exhaustive
def test_every_statement_has_its_recorded_verdict():
    with processes() as executor:
        evidence = collect(required_runs(), run_all(required_runs(), executor))
    results = findings(evidence)
    assert len(results) == len(CLAIMS)
    assert {one.name: (str(one.verdict), one.shown) for one in results if one.changed} == {}
    assert [paper.name for paper in FIGURES if draw_figure(paper, evidence) is None] == []
