"""The paper's statements on real runs: every recorded verdict is the one found."""

from __future__ import annotations

import os
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

from validation.claims.all import CLAIMS, findings
from validation.claims.evidence import gather, required_runs
from validation.report.figures.paper_figures import FIGURES, draw_figure


@pytest.mark.slow
def test_every_statement_has_its_recorded_verdict():
    with ProcessPoolExecutor(os.cpu_count(), mp_context=get_context("spawn")) as executor:
        evidence = gather(required_runs(), executor)
    results = findings(evidence)
    assert len(results) == len(CLAIMS)
    assert {one.name: (str(one.verdict), one.shown) for one in results if one.changed} == {}
    assert [paper.name for paper in FIGURES if draw_figure(paper, evidence) is None] == []
