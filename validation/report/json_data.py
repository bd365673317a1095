"""Every number of a report, of a study, of the stiff and extreme matrix, as data for programs.

The keys are a fixed contract with whoever reads ``report.json``, ``study.json`` and ``stability.json``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from validation.cases import Case
from validation.claims.claim import Finding
from validation.compare.premises import of_case
from validation.compare.suite import SceneComparison
from validation.execution.provenance import version
from validation.execution.run import Run
from validation.execution.run_folder import summary
from validation.measure.norms import CURVES
from validation.report.report import Report
from validation.report.sections.costs import spent
from validation.report.sections.scene import skipped_work
from validation.report.sections.stability import numbers
from validation.stability.growth import work_growth
from validation.stability.limits import limits
from validation.stability.runner import StabilityMatrix
from validation.studies import work_precision
from validation.studies.convergence import Convergence
from validation.studies.poisson import OBSERVED, CompressibilityComparison
from validation.studies.study import SceneStudy, Study
from validation.studies.zones import ZoneRun

FORMAT = 1
Data = dict[str, Any]


def of_report(report: Report) -> Data:
    """``report.json``."""
    whole = {
        "format": FORMAT,
        "suite": report.suite,
        "passed": not report.failures,
        "checks": len(report.checks),
        "failed": len(report.failures),
        "wall_seconds": report.wall_seconds,
        "cpu_seconds": sum(map(spent, report.runs)),
        "environment": report.environment,
        "program": version(),
        "scenes": [_scene(scene) for scene in report.scenes],
    }
    if report.claims is not None:
        whole["claims"] = [_finding(one) for one in report.claims.findings]
    if report.stability is not None:
        whole["stability"] = _matrix(report.stability, True)
    if report.baseline is not None:
        moves = [asdict(move) for move in report.baseline.moves]
        changes = list(report.baseline.changes)
        whole["baseline"] = {"path": report.baseline.path, "changes": changes, "moves": moves}
    return whole


def _scene(scene: SceneComparison) -> Data:
    return {
        "name": scene.case.name,
        "title": scene.case.scene.title,
        "figure": scene.case.figure,
        "statement": scene.case.statement,
        "premises": of_case(scene.case),
        "left_out": skipped_work(scene),
        "passed": scene.passed,
        "runs": {
            solver: summary(run) | {"traceback": run.details or None} for solver, run in scene.runs.items()
        },
        "checks": [asdict(check) for check in scene.checks],
    }


def _finding(one: Finding) -> Data:
    return asdict(one) | {"verdict": str(one.verdict), "changed": one.changed, "found": one.shown}


def of_matrix(matrix: StabilityMatrix, complete: bool = True) -> Data:
    """``stability.json``; ``complete`` is false while cells are still missing."""
    return {"format": FORMAT} | _matrix(matrix, complete)


def _matrix(matrix: StabilityMatrix, complete: bool) -> Data:
    counted = numbers(matrix.cells)
    return {
        "complete": complete,
        "wall_seconds": matrix.wall_seconds,
        "limits": limits(matrix.cells),
        "growth": [
            asdict(growth) | {"logarithmic": growth.logarithmic} for growth in work_growth(matrix.cells)
        ],
        "cells": [
            asdict(cell)
            | {"number": counted[cell.axis, cell.label], "error": cell.error, "worst": cell.worst}
            for cell in matrix.cells
        ],
    }


def of_study(study: Study) -> Data:
    """``study.json``."""
    return {
        "format": FORMAT,
        "wall_seconds": study.wall_seconds,
        "environment": study.environment,
        "scenes": [_scene_study(scene) for scene in study.scenes],
    }


def _scene_study(scene: SceneStudy) -> Data:
    cheapest = [
        {"measure": measure, "asked": error, "cheapest": best.scheme if best else None}
        | {"seconds": {entry.scheme: entry.seconds for entry in prices}}
        for measure in work_precision.measures(scene.timed)
        for error in work_precision.ERRORS
        for best, prices in [work_precision.cheapest(scene.timed, measure, error)]
    ]
    return {
        "name": scene.case.name,
        "title": scene.case.scene.title,
        "premises": of_case(scene.case),
        "reference": scene.reference,
        "reference_uncertainty": scene.uncertainty,
        "failed_levels": len(scene.failed),
        "ladders": [_ladder(entry) for entry in scene.ladders],
        "cheapest": cheapest,
        "growth": [
            asdict(work_precision.growth(entry, work))
            for entry in scene.timed
            for work in work_precision.WORK
        ],
    }


def _ladder(entry: Convergence) -> Data:
    return {
        "scheme": entry.ladder.scheme,
        "kind": entry.ladder.kind,
        "refined": entry.ladder.refined,
        "nominal_order": entry.nominal,
        "levels": [asdict(run) for run in entry.runs],
        "observables": [asdict(row) for row in entry.rows],
    }


def of_compressibilities(case: Case, compressibilities: Iterable[CompressibilityComparison]) -> Data:
    """``poisson-SCENE.json``."""
    return {
        "scene": case.name,
        "premises": of_case(case),
        "compressibilities": [
            {
                "bulk_to_shear": one.ratio,
                "initial_poisson": one.initial,
                "final_poisson": one.final,
                "runs": {label: _assumption(one, label, run) for label, run in one.runs.items()},
            }
            for one in compressibilities
        ],
    }


def of_zones(case: Case, runs: Iterable[ZoneRun]) -> Data:
    """``zones-SCENE.json``."""
    return {
        "scene": case.name,
        "premises": of_case(case),
        "runs": [
            {
                "zone_over_radius": one.ratio,
                "zone": one.zone,
                "solver": one.solver,
                "outcome": None if one.run is None else one.run.ending,
                "skipped": one.skipped or None,
                "steps": one.steps,
                "history_updates_per_step": one.updates,
                "cpu_seconds": one.seconds,
                "peak_memory_bytes": one.peak_memory,
                "errors": one.errors,
                "error_estimates": {} if one.run is None else one.run.errors,
            }
            for one in runs
        ],
    }


def _assumption(one: CompressibilityComparison, label: str, run: Run) -> Data:
    names = (*OBSERVED, *CURVES)
    differences = {name: one.difference(label, name) for name in names}
    return {
        "solver": run.solver,
        "ending": run.ending,
        "cpu_seconds": run.cpu_seconds,
        "observables": {name: run.measures.get(name) for name in OBSERVED},
        "error_estimates": {name: run.errors.get(name) for name in names},
        "differences": {name: None if d is None else d.error for name, d in differences.items()},
    }
