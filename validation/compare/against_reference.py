"""A solver against the reference on one scene: scalars, and curves on one time axis."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from contact_scene import OutcomeKind, Trace
from contact_scene.trace import Array
from validation.cases import Case
from validation.compare.checks import check_run, declined
from validation.measure.curves import MOVEMENT, parting_time
from validation.measure.difference import (
    Check,
    Difference,
    agreement_limit,
    of_curves,
    of_movements,
    of_numbers,
)
from validation.measure.events import has_smooth_crests, is_located
from validation.measure.observables import Observables
from validation.measure.scaling import column_of, unit_sizes
from validation.measure.windows import windows
from validation.runs.run import Run
from validation.solvers import REFERENCE

SCALARS = {
    "start_force": "force",
    "start_radius": "length",
    "approach_time": "",
    "approach_penetration": "length",
    "approach_force": "force",
    "approach_radius": "length",
    "peak_force": "force",
    "pull_off_force": "jkr-force",
    "pull_off_penetration": "length",
    "pull_off_radius": "length",
    "pull_off_time": "",
    "detachment_penetration": "length",
    "detachment_radius": "length",
    "detachment_force": "force",
    "detachment_time": "",
    "stage_at_detachment": "length",
    "final_penetration": "length",
    "final_radius": "length",
    "final_force": "force",
    "final_time": "",
    "loop_energy": "energy",
    "dissipated_energy": "energy",
    "loss_fall": "energy",
    "instability_loss": "energy",
    "branch_dissipation": "energy",
    "zone_excess": "energy",
    "peak_cycle_loss": "energy",
}
"""Unit by observable: all that is measured, but for what counts work, and the frequency of the peak of the
loss, which is that of one cycle or of its neighbour."""
CURVES = {"force": "F(t)", "contact_radius": "a(t)"}
SOURCE = "front tracking"


def check_case(case: Case, runs: dict[str, Run]) -> list[Check]:
    """All checks of the runs of one scene, which are keyed by solver."""
    checks = [check for result in runs.values() for check in check_run(case, result)]
    base = runs.get(REFERENCE)
    if base is not None and REFERENCE not in case.refused_by:
        others = [r for name, r in runs.items() if name != REFERENCE and not declined(case, r)]
        found = [check for result in others for check in against_reference(case, result, base)]
        checks += _where_the_others_agree(case, others, found)
    return checks


def _where_the_others_agree(case: Case, others: list[Run], checks: list[Check]) -> list[Check]:
    """The checks, those that two solvers fail alike turned into one that the reference fails."""
    failed = {(check.solver, check.quantity) for check in checks if not check.passed}
    for one, two in combinations(others, 2):
        for check in against_reference(case, two, one):
            alike = {(one.solver, check.quantity), (two.solver, check.quantity)}
            if check.passed and alike <= failed:
                missed = next(c for c in checks if (c.solver, c.quantity) == (one.solver, check.quantity))
                turned = replace(
                    missed,
                    solver=REFERENCE,
                    source=f"{one.solver} and {two.solver} agree",
                    expected=missed.found,
                    found=missed.expected,
                    estimate=missed.base_estimate,
                    base_estimate=missed.estimate,
                )
                checks = [c for c in checks if (c.solver, c.quantity) not in alike] + [turned]
                failed -= alike
    return checks


def against_reference(case: Case, result: Run, base: Run) -> list[Check]:
    """Differences from the reference, each beside its limit.

    Where both runs estimate their errors, the limit is the sum of the two estimates, at most the scene's
    tolerance; otherwise it is the tolerance. Both runs have to end in the same way, and a run must not give
    what the reference does not: no detachment, no pull-off force where there is none.
    """
    if result.trace is None or base.trace is None:
        missing = "no run" if result.trace is None else "no reference run"
        return [Check(case.name, result.solver, "reference", SOURCE, None, None, False, note=missing)]
    ending = _ending(case, result, result.trace, base.trace)
    if result.curves is None or base.curves is None:
        return [ending]
    return [
        ending,
        *_numbers(case, result, base, base.curves),
        *_curves(case, result, base, base.curves),
    ]


def _ending(case: Case, result: Run, trace: Trace, base: Trace) -> Check:
    expected, found = str(base.outcome.kind), str(trace.outcome.kind)
    note = "" if expected == found else f"at t = {trace.outcome.time:.4g}, not {base.outcome.time:.4g}"
    return Check(case.name, result.solver, "outcome", SOURCE, expected, found, expected == found, note=note)


def _numbers(case: Case, result: Run, base: Run, trace: Trace) -> Iterator[Check]:
    known = unit_sizes(case.scene)
    names = [name for name in SCALARS if _comparable(case, result.solver, name, trace)]
    for one in of_numbers(result, base, names):
        name, unit = one.quantity, SCALARS[one.quantity]
        tolerance, size = case.tolerance(result.solver, name), known.get(unit, 1.0)
        values = (run.measures.get(name) for run in (base, result))
        expected, found = (None if value is None else value / size for value in values)
        if tolerance is None:
            continue
        if expected is not None:
            shown = (expected, found, unit if unit in known else "")
            yield _check(case, result, trace, one, name, tolerance, column_of(name), *shown)
        elif name in Observables().as_dict():
            yield Check(case.name, result.solver, name, SOURCE, None, found, False, unit, note=one.missing)


def _curves(case: Case, result: Run, base: Run, trace: Trace) -> Iterator[Check]:
    """Curves relative to their size, and relative to their excursion in the worst load step or cycle."""
    spans = windows(case.scene.loading, trace)
    differences = (*of_curves(result, base, spans), *of_movements(result, base, spans))
    found = {one.quantity: one for one in differences}
    for column, name in CURVES.items():
        for kind, norm, key in (("curves", "RMS", column), ("movement", "movement", column + MOVEMENT)):
            one, tolerance = found.get(key), case.tolerance(result.solver, kind)
            if one is not None and tolerance is not None:
                rms, parts = None if one.missing else one.error, column if kind == "curves" else None
                yield _check(case, result, trace, one, f"{name}, {norm}", tolerance, parts, 0.0, rms)


def _check(
    case: Case,
    result: Run,
    base: Trace,
    one: Difference,
    name: str,
    tolerance: float,
    column: str | None,
    expected: float,
    found: float | None,
    unit: str = "",
) -> Check:
    """The check of a difference, whose note says why it fails, where, and when the ``column`` parts."""
    reason, difference = one.disagreement(tolerance), None if one.missing else one.error
    given = case.name, result.solver, name, SOURCE, expected, found, not reason, unit, difference, tolerance
    parted = ""
    if reason and column is not None and not one.missing:
        parted = _parting(result, base, column, agreement_limit(tolerance, one.own, one.known_to))
    note = ", ".join(filter(None, (reason, one.note, parted)))
    return Check(*given, note=note, estimate=one.own, base_estimate=one.known_to)


def _comparable(case: Case, solver: str, name: str, trace: Trace) -> bool:
    """Whether two right runs have the same value: it does not depend on which rows they have."""
    if not is_located(name, trace, case.scene.loading):
        return False
    if name == "pull_off_time" and has_smooth_crests(
        case.scene.loading
    ):  # of cycles that pull alike, to the tolerance, any may pull most
        return not _comes_back(-trace.force, case.tolerance(solver, "pull_off_force") or 0.0)
    # After a detachment force and radius are zero; time and penetration of the loss are detachment_*.
    return not (name.startswith("final") and trace.outcome.kind is OutcomeKind.DETACHED)


def _comes_back(tension: Array, tolerance: float) -> bool:
    """Whether a tension rises to its largest value, within a relative tolerance, more than once."""
    high = tension >= (1.0 - tolerance) * float(tension.max())
    return int(np.count_nonzero(np.diff(high.astype(int), prepend=0) == 1)) > 1


def _parting(result: Run, base: Trace, column: str, limit: float) -> str:
    """When the curves part by more than the limit, in words; empty if they never do.

    The external work stands for what is no column of the run.
    """
    column = column if column in base.columns() else "external_work"
    parted = None if result.trace is None else parting_time(result.trace, base, limit, column)
    return "" if parted is None else f"parts at t = {parted:.4g}"
