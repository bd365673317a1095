"""A solver against the reference on one scene: scalars, and curves on one time axis."""

from __future__ import annotations

import math

from contact_scene import Trace
from validation.cases import Case
from validation.compare.checks import check_run
from validation.execution.runs import Run
from validation.measure.check import Check, agreement_limit
from validation.measure.cycles import cycle_times
from validation.measure.dimensionless import unit_sizes
from validation.measure.norms import distance, parting_time
from validation.measure.scaling import column_of, scale
from validation.solvers import REFERENCE

SCALARS = {
    "start_force": "force",
    "start_radius": "length",
    "approach_force": "force",
    "approach_radius": "length",
    "pull_off_force": "jkr-force",
    "pull_off_penetration": "length",
    "pull_off_radius": "length",
    "pull_off_time": "",
    "detachment_penetration": "length",
    "detachment_time": "",
    "loop_energy": "energy",
    "dissipated_energy": "energy",
    "branch_dissipation": "energy",
    "zone_excess": "energy",
    "peak_cycle_loss": "energy",
}
"""Unit by observable."""
CURVES = {"force": "F(t), RMS", "contact_radius": "a(t), RMS"}


def check_case(case: Case, runs: dict[str, Run]) -> list[Check]:
    """All checks of the runs of one scene, which are keyed by solver."""
    checks = [check for result in runs.values() for check in check_run(case, result)]
    base = runs.get(REFERENCE)
    if base is not None and REFERENCE not in case.refused_by:
        for solver, result in runs.items():
            if solver != REFERENCE and solver not in case.refused_by:
                checks += against_reference(case, result, base)
    return checks


def against_reference(case: Case, result: Run, base: Run) -> list[Check]:
    """Differences from the reference, each beside its limit.

    Where both runs estimate their errors, the limit is the sum of the two estimates, at most the scene's
    tolerance; otherwise it is the tolerance. What differences are relative to is stated in
    :mod:`validation.measure.scaling`.
    """
    if result.trace is None or base.trace is None:
        missing = "no run" if result.trace is None else "no reference run"
        return [
            Check(case.name, result.solver, "reference", "front tracking", None, None, False, note=missing)
        ]
    return _scalars(case, result, base, base.trace) + _curves(case, result, result.trace, base, base.trace)


def _scalars(case: Case, result: Run, base: Run, trace: Trace) -> list[Check]:
    known = unit_sizes(case.scene)
    oscillates = bool(cycle_times(case.scene.loading))
    checks = []
    for name, unit in SCALARS.items():
        expected, measured = base.measures.get(name), result.measures.get(name)
        tolerance = case.tolerance(result.solver, name)
        if expected is None or tolerance is None:
            continue
        if oscillates and name.startswith("approach"):
            continue  # of many crests of one height, which row comes first depends on the rows
        size = known.get(unit, 1.0)
        difference = None if measured is None else _ratio(measured - expected, scale(name, expected, trace))
        most, estimates = _limit(result, base, name, tolerance)
        passed = difference is not None and abs(difference) <= most
        note = "" if measured is not None else "the run does not give it"
        if measured is not None and not passed:
            note = _parting(result, trace, column_of(name) or "external_work", most)
        checks.append(
            Check(
                case.name,
                result.solver,
                name,
                "front tracking",
                expected / size,
                None if measured is None else measured / size,
                passed,
                unit if unit in known else "",
                difference,
                tolerance,
                note=note,
                estimate=estimates[0],
                base_estimate=estimates[1],
            )
        )
    return checks


def _curves(case: Case, result: Run, trace: Trace, base: Run, base_trace: Trace) -> list[Check]:
    tolerance = case.tolerance(result.solver, "curves")
    if tolerance is None:
        return []
    checks = []
    for column, name in CURVES.items():
        apart = distance(trace, base_trace, column)
        most, estimates = _limit(result, base, column, tolerance)
        passed = apart is not None and apart.rms <= most
        note = "" if apart is None else f"largest {apart.largest:.2g} at t = {apart.at:.4g}"
        if apart is not None and not passed:
            note = ", ".join(filter(None, (note, _parting(result, base_trace, column, most))))
        checks.append(
            Check(
                case.name,
                result.solver,
                name,
                "front tracking",
                0.0,
                None if apart is None else apart.rms,
                passed,
                "",
                None if apart is None else apart.rms,
                tolerance,
                note=note or "no common interval of time",
                estimate=estimates[0],
                base_estimate=estimates[1],
            )
        )
    return checks


def _limit(
    result: Run, base: Run, name: str, tolerance: float
) -> tuple[float, tuple[float | None, float | None]]:
    """Largest difference that counts as agreement, and the two estimates it comes from."""
    estimates = result.errors.get(name), base.errors.get(name)
    return agreement_limit(tolerance, *estimates), estimates


def _parting(result: Run, base: Trace, column: str, limit: float) -> str:
    """When the curves part by more than the limit, in words; empty if they never do."""
    parted = None if result.trace is None else parting_time(result.trace, base, limit, column)
    return "" if parted is None else f"parts at t = {parted:.4g}"


def _ratio(difference: float, size: float) -> float:
    if size > 0.0:
        return difference / size
    return 0.0 if difference == 0.0 else math.copysign(math.inf, difference)
