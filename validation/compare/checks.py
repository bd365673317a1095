"""The verdicts on the runs of a scene: how each ended, the check values stated, and the reference.

Where run and reference estimate their errors, the limit of a difference is the sum of both estimates, at most
the scene's tolerance; otherwise it is the tolerance. Both have to end in the same way, and a run must not
give what the reference does not: no detachment, no pull-off force where there is none. What two solvers fail
alike while they agree with each other, the reference fails.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from contact_scene import OutcomeKind, Trace
from contact_scene.trace import Array
from validation.cases import Case, Expected
from validation.measure.curves import MOVEMENT, column_curve, parting_time
from validation.measure.difference import (
    Check,
    Difference,
    agreement_limit,
    of_curves,
    of_movements,
    of_numbers,
)
from validation.measure.events import has_smooth_crests, is_located
from validation.measure.observables import Observables, largest_fall
from validation.measure.scaling import column_of, scale, unit_of, unit_sizes
from validation.measure.windows import windows
from validation.runs.run import Run, fall_error
from validation.solvers import REFERENCE

SCALARS = (
    *(name for name in Observables().as_dict() if name != "peak_time"),
    "loss_fall",
    "branch_dissipation",
    "zone_excess",
    "peak_cycle_loss",
)
"""All that is measured, but for what counts work; the time of the largest force, which is uncertain as a
crest is flat; and the frequency of the peak of the loss, which is that of one cycle or of its neighbour."""
CURVES = {"force": "F(t)", "contact_radius": "a(t)"}
SOURCE = "front tracking"
NOT_GIVEN = "the run does not give it"


def check_case(case: Case, runs: dict[str, Run]) -> list[Check]:
    """All checks of the runs of one scene, which are keyed by solver."""
    checks = [check for result in runs.values() for check in check_run(case, result)]
    base = runs.get(REFERENCE)
    if base is not None:
        others = [r for name, r in runs.items() if name != REFERENCE and not _declined(case, r)]
        found = [check for result in others for check in against_reference(case, result, base)]
        checks += _where_the_others_agree(case, others, found)
    return checks


def check_run(case: Case, result: Run) -> list[Check]:
    """The ending of a run, and every check value stated for its scene and solver."""
    checks = [_reaches_its_end(case, result)]
    if _declined(case, result):
        return checks
    if result.curves is not None and not case.scene.is_adhesive:
        checks.append(_lost_for_good(case, result, result.curves))
    for expected in case.expected:
        if expected.value is None or result.solver in expected.tolerance:
            checks.append(_stated(case, result, expected))
    return checks


def against_reference(case: Case, result: Run, base: Run) -> list[Check]:
    """Differences from the reference, each beside its limit."""
    if result.trace is None or base.trace is None:
        missing = "no run" if result.trace is None else "no reference run"
        return [Check(case.name, result.solver, "reference", SOURCE, None, None, False, note=missing)]
    expected, found = base.outcome, result.outcome
    alike = expected == found
    when = "" if alike else f"at t = {result.trace.outcome.time:.4g}, not {base.trace.outcome.time:.4g}"
    ending = Check(case.name, result.solver, "outcome", SOURCE, expected, found, alike, note=when)
    if result.curves is None or base.curves is None:
        return [ending]
    return [ending, *_numbers(case, result, base, base.curves), *_curves(case, result, base, base.curves)]


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


def _numbers(case: Case, result: Run, base: Run, trace: Trace) -> Iterator[Check]:
    known = unit_sizes(case.scene)
    names = [name for name in SCALARS if _comparable(case, result.solver, name, trace)]
    for one in of_numbers(result, base, names):
        name, unit = one.quantity, unit_of(one.quantity)
        tolerance, size = case.tolerance(result.solver, name), known.get(unit, 1.0)
        values = (run.measures.get(name) for run in (base, result))
        expected, found = (None if value is None else value / size for value in values)
        if tolerance is None:
            continue
        if expected is not None:
            shown = (expected, found, unit if unit in known else "")
            yield _compared(case, result, trace, one, name, tolerance, column_of(name), *shown)
        elif name in Observables().as_dict():
            yield Check(case.name, result.solver, name, SOURCE, None, found, False, unit, note=one.missing)


def _curves(case: Case, result: Run, base: Run, trace: Trace) -> Iterator[Check]:
    """Curves relative to their size, and relative to their excursion in the worst load step or cycle."""
    spans = windows(case.scene.loading, trace)
    found = {
        one.quantity: one for one in (*of_curves(result, base, spans), *of_movements(result, base, spans))
    }
    for column, name in CURVES.items():
        for kind, norm, key in (("curves", "RMS", column), ("movement", "movement", column + MOVEMENT)):
            one, tolerance = found.get(key), case.tolerance(result.solver, kind)
            if one is not None and tolerance is not None:
                rms, parts = None if one.missing else one.error, column if kind == "curves" else None
                yield _compared(case, result, trace, one, f"{name}, {norm}", tolerance, parts, 0.0, rms)


def _compared(
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
    """The check of a difference, whose note says why it fails, where, and when the ``column`` parts.

    The external work stands for what is no column of the run.
    """
    reason, difference, parted = one.disagreement(tolerance), None if one.missing else one.error, ""
    if reason and column is not None and not one.missing and result.trace is not None:
        column = column if column in base.columns() else "external_work"
        limit = agreement_limit(tolerance, one.own, one.known_to)
        at = parting_time(result.trace, base, limit, column)
        parted = "" if at is None else f"parts at t = {at:.4g}"
    note = ", ".join(filter(None, (reason, one.note, parted)))
    given = case.name, result.solver, name, SOURCE, expected, found, not reason, unit, difference, tolerance
    return Check(*given, note=note, estimate=one.own, base_estimate=one.known_to)


def _comparable(case: Case, solver: str, name: str, trace: Trace) -> bool:
    """Whether two right runs have the same value: it does not depend on which rows they have."""
    if not is_located(name, trace, case.scene.loading):
        return False
    if name == "pull_off_time" and has_smooth_crests(case.scene.loading):
        # of cycles that pull alike, to the tolerance, any may pull most
        return not _comes_back(-trace.force, case.tolerance(solver, "pull_off_force") or 0.0)
    # After a detachment force and radius are zero; time and penetration of the loss are detachment_*.
    return not (name.startswith("final") and trace.outcome.kind is OutcomeKind.DETACHED)


def _comes_back(tension: Array, tolerance: float) -> bool:
    """Whether a tension rises to its largest value, within a relative tolerance, more than once."""
    high = tension >= (1.0 - tolerance) * float(tension.max())
    return int(np.count_nonzero(np.diff(high.astype(int), prepend=0) == 1)) > 1


def _declined(case: Case, result: Run) -> bool:
    """Whether a solver need not answer: it says so, and nothing is known of the scene.

    The reference has to: without it nothing is compared.
    """
    return result.refused and not case.outcome and result.solver != REFERENCE


def _reaches_its_end(case: Case, result: Run) -> Check:
    expected, outcome = case.outcome or "completed or detached", result.outcome
    if _declined(case, result):
        source, expected, passed = "a scene the method does not take", "refused", result.refused
    else:
        source = "the run reaches its end"
        passed = result.finished and (not case.outcome or outcome == case.outcome)
    note = result.ending if result.refused or not passed else ""
    return Check(case.name, result.solver, "outcome", source, expected, outcome, passed, note=note)


def _lost_for_good(case: Case, result: Run, trace: Trace) -> Check:
    """Without adhesion the loss may not fall by more than its error."""
    fall = largest_fall(trace)[0]
    most = fall_error(case, result) * scale("loss_fall", fall, trace)
    source = "a material gives nothing back of what it has lost"
    return Check(case.name, result.solver, "loss_fall", source, most, fall, fall <= most, relation="<=")


def _stated(case: Case, result: Run, expected: Expected) -> Check:
    """A run against a number on paper, or a limit on one side."""
    name, measured = expected.observable, result.measures.get(expected.observable)
    if expected.at_time is not None:
        name, measured = f"{name} at t = {expected.at_time:g}", _at_time(result, name, expected.at_time)
    found = None if measured is None else measured / unit_sizes(case.scene)[expected.unit]
    note = "" if found is not None else NOT_GIVEN
    if expected.value is None:
        limit, relation = (expected.at_least, ">=") if expected.at_most is None else (expected.at_most, "<=")
        assert limit is not None, f"{case.name}: a check of {name} states no number"
        passed = found is not None and (found <= limit if relation == "<=" else found >= limit)
        stated = case.name, result.solver, name, expected.source, limit, found, passed, expected.unit
        return Check(*stated, relation=relation, note=note)
    tolerance = expected.tolerance[result.solver]
    size = abs(expected.value) if expected.scale is None else expected.scale
    difference = math.nan if found is None else (found - expected.value) / size
    passed = abs(difference) <= tolerance
    stated = case.name, result.solver, name, expected.source, expected.value, found, passed, expected.unit
    return Check(*stated, None if found is None else difference, tolerance, note=note)


def _at_time(result: Run, column: str, time: float) -> float | None:
    """A column between rows; ``None`` if the run does not reach that time or has no such column."""
    trace = result.trace
    if trace is None or column not in trace.columns() or len(trace) < 2:
        return None
    return column_curve(trace, column).at(time) if trace.time[0] <= time <= trace.time[-1] else None
