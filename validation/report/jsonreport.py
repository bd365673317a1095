"""The report as JSON: every number of it, for programs."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from validation.execution.files import to_json
from validation.execution.runs import summary
from validation.report import claims_section, stability_section
from validation.report.costs import spent
from validation.report.text import spared_by

if TYPE_CHECKING:
    from validation.compare.suite import SceneComparison
    from validation.report.build import Report

FORMAT = 1


def text(report: Report) -> str:
    """The whole report."""
    return to_json(data(report))


def data(report: Report) -> dict[str, Any]:
    """The same before it is written."""
    whole = {
        "format": FORMAT,
        "suite": report.suite,
        "passed": not report.failures,
        "checks": len(report.checks),
        "failed": len(report.failures),
        "wall_seconds": report.wall_seconds,
        "cpu_seconds": sum(map(spent, report.runs)),
        "environment": report.environment,
        "scenes": [_scene(page) for page in report.pages],
    }
    if report.claims is not None:
        whole["claims"] = claims_section.data(report.claims)
    if report.stability is not None:
        whole["stability"] = stability_section.data(report.stability)
    if report.baseline is not None:
        moves = [asdict(move) for move in report.baseline.moves]
        whole["baseline"] = {"path": report.baseline.path, "moves": moves}
    return whole


def _scene(page: SceneComparison) -> dict[str, Any]:
    return {
        "name": page.case.name,
        "title": page.case.scene.title,
        "figure": page.case.figure,
        "statement": page.case.statement,
        "left_out": spared_by(page),
        "passed": page.passed,
        "runs": {
            solver: summary(result) | {"traceback": result.details or None}
            for solver, result in page.runs.items()
        },
        "checks": [asdict(check) for check in page.checks],
    }
