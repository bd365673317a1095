"""The paper's statements on real runs: every recorded verdict is the one found."""

from __future__ import annotations

import math
import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from validation.claims.all import CLAIMS, findings
from validation.claims.claim import Verdict
from validation.claims.evidence import Evidence, gather, required_runs
from validation.report.figures.paper_figures import FIGURES, draw_figure
from validation.solvers import SOLVERS

LONG = 10.0
"""Expected seconds of a run that the slow tests leave out: some hundred cycles of an oscillation."""


def evidence_of(shorter_than: float) -> Evidence:
    """The required runs that are expected to take less than so many seconds."""
    asked = [
        (case, solver)
        for case, solver in required_runs()
        if SOLVERS[solver].expected_cost(case.scene).seconds < shorter_than
    ]
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as executor:
        return gather(asked, executor)


@pytest.mark.slow
def test_statements_that_need_no_long_run_have_their_recorded_verdicts():
    results = findings(evidence_of(LONG))
    judged = [one for one in results if one.verdict is not Verdict.NOT_EVALUATED]
    assert len(judged) > 0.8 * len(CLAIMS)
    assert {one.name: (str(one.verdict), one.shown) for one in judged if one.changed} == {}


@pytest.mark.exhaustive
def test_every_statement_has_its_recorded_verdict():
    evidence = evidence_of(math.inf)
    results = findings(evidence)
    assert len(results) == len(CLAIMS)
    assert {one.name: (str(one.verdict), one.shown) for one in results if one.changed} == {}
    assert [paper.name for paper in FIGURES if draw_figure(paper, evidence) is None] == []
