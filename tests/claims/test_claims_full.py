"""The paper's statements on real runs: every recorded verdict is the one found."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from validation.claims.claim import Verdict
from validation.claims.evidence import SOLVER, collect, required_runs
from validation.claims.page import CLAIMS, findings
from validation.claims.paper_figures import FIGURES, draw_figure
from validation.runs.pool import run_of, run_task, run_tasks
from validation.solvers.model_range import cycle_count

MANY = 30.0
"""Cycles of an oscillation from which the slow tests leave a run out."""
COARSE = 4
"""Annuli per zone of the boundary elements: a third of the default gives the same verdicts."""


@pytest.mark.parametrize(
    "short", [pytest.param(True, marks=pytest.mark.slow), pytest.param(False, marks=pytest.mark.exhaustive)]
)
def test_statements_have_their_recorded_verdicts(short):
    asked = [task for task in required_runs() if not short or cycle_count(task[0].scene) < MANY]
    tasks = [run_task(case, s, COARSE if short and s == SOLVER else None) for case, s in asked]
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as executor:
        runs = map(run_of, run_tasks(tasks, executor))
        evidence = collect(asked, {(run.scene, run.solver): run for run in runs})
    judged = [one for one in findings(evidence) if one.verdict is not Verdict.NOT_EVALUATED]
    assert {one.name: (str(one.verdict), one.shown) for one in judged if one.changed} == {}
    if short:
        assert len(judged) > 0.8 * len(CLAIMS)
    else:
        assert len(judged) == len(CLAIMS)
        assert [paper.name for paper in FIGURES if draw_figure(paper, evidence) is None] == []
