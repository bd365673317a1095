"""A solver against the reference on one scene: scalars, and curves on one time axis."""

from __future__ import annotations

import math

import numpy as np

from scene import Trace
from validation.cases import Case
from validation.checks import Check, check_run
from validation.cycles import cycle_times
from validation.norms import distance, parting_time
from validation.runs import Run
from validation.scales import units
from validation.solvers import REFERENCE

SCALARS = {  # observable: (unit, column that sets the smallest meaningful scale)
    "start_force": ("force", "force"),
    "start_radius": ("length", "contact_radius"),
    "approach_force": ("force", "force"),
    "approach_radius": ("length", "contact_radius"),
    "pull_off_force": ("jkr-force", "force"),
    "detachment_penetration": ("length", "penetration"),
    "detachment_time": ("", "time"),
    "loop_energy": ("energy", ""),
    "peak_cycle_loss": ("energy", ""),
}
CURVES = {"force": "F(t), RMS", "contact_radius": "a(t), RMS"}


def check_case(case: Case, runs: dict[str, Run]) -> list[Check]:
    """All verdicts on the runs of one scene, keyed by solver."""
    checks = [check for result in runs.values() for check in check_run(case, result)]
    base = runs.get(REFERENCE)
    if base is not None:
        for solver, result in runs.items():
            if solver != REFERENCE:
                checks += against_reference(case, result, base)
    return checks


def against_reference(case: Case, result: Run, base: Run) -> list[Check]:
    """Differences from the reference, each beside its tolerance.

    Scalars are relative to the reference's value, penetrations to the largest penetration; values that
    nearly vanish are relative to a twentieth of their column's largest magnitude.
    """
    if result.trace is None or base.trace is None:
        missing = "no run" if result.trace is None else "no reference run"
        return [
            Check(case.name, result.solver, "reference", "front tracking", None, None, False, note=missing)
        ]
    return _scalars(case, result, base) + _curves(case, result, result.trace, base.trace)


def _scalars(case: Case, result: Run, base: Run) -> list[Check]:
    known = units(case.scene)
    oscillates = bool(cycle_times(case.scene.loading))
    checks = []
    for name, (unit, column) in SCALARS.items():
        wanted, found = base.measures.get(name), result.measures.get(name)
        tolerance = case.tolerance(result.solver, name)
        if wanted is None or tolerance is None:
            continue
        if oscillates and name.startswith("approach"):
            continue  # of many crests of one height, which row comes first depends on the rows
        unit = unit if unit in known else ""
        scale = abs(wanted)
        if column and base.trace is not None:
            largest = float(np.abs(base.trace.columns()[column]).max())
            scale = largest if column == "penetration" else max(scale, 0.05 * largest)
        difference = None if found is None else _ratio(found - wanted, scale)
        checks.append(
            Check(
                case.name,
                result.solver,
                name,
                "front tracking",
                wanted / known[unit],
                None if found is None else found / known[unit],
                difference is not None and abs(difference) <= tolerance,
                unit,
                difference,
                tolerance,
                note="" if found is not None else "the run does not give it",
            )
        )
    return checks


def _curves(case: Case, result: Run, trace: Trace, base: Trace) -> list[Check]:
    tolerance = case.tolerance(result.solver, "curves")
    if tolerance is None:
        return []
    checks = []
    for column, name in CURVES.items():
        apart = distance(trace, base, column)
        passed = apart is not None and apart.rms <= tolerance
        note = "" if apart is None else f"largest {apart.largest:.2g} at t = {apart.at:.4g}"
        if apart is not None and not passed:
            parted = parting_time(trace, base, tolerance, column)
            note += "" if parted is None else f", parts at t = {parted:.4g}"
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
            )
        )
    return checks


def _ratio(difference: float, scale: float) -> float:
    if scale > 0.0:
        return difference / scale
    return 0.0 if difference == 0.0 else math.copysign(math.inf, difference)
