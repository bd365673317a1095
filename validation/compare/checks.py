"""The ending of a run and the check values stated for its scene, each as a check."""

from __future__ import annotations

import math

from contact_scene import Trace
from validation.cases import Case, Expected
from validation.measure.curves import column_curve
from validation.measure.difference import Check
from validation.measure.observables import largest_fall
from validation.measure.scaling import scale, unit_sizes
from validation.runs.run import Run, fall_error
from validation.solvers import REFERENCE


def check_run(case: Case, result: Run) -> list[Check]:
    """The ending of a run, and every check value stated for its scene and solver."""
    checks = [_ending(case, result)]
    if declined(case, result):
        return checks
    if result.curves is not None and not case.scene.is_adhesive:
        checks.append(_lost_for_good(case, result, result.curves))
    for expected in case.expected:
        if expected.value is None or result.solver in expected.tolerance:
            checks.append(_value(case, result, expected))
    return checks


def declined(case: Case, result: Run) -> bool:
    """Whether a solver need not answer: the case says so or, where nothing is known of a scene, the solver.

    The reference has to: without it nothing is compared.
    """
    unknown = not case.outcome and result.solver != REFERENCE
    return result.solver in case.refused_by or (result.refused and unknown)


def _ending(case: Case, result: Run) -> Check:
    expected = case.outcome or "completed or detached"
    outcome = result.outcome
    if declined(case, result):
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


def _value(case: Case, result: Run, expected: Expected) -> Check:
    size = unit_sizes(case.scene)[expected.unit]
    name = expected.observable
    if expected.at_time is not None:
        measured = _at_time(result, name, expected.at_time)
        name = f"{name} at t = {expected.at_time:g}"
    else:
        measured = result.measures.get(name)
    shown = None if measured is None else measured / size
    if expected.value is None:
        return _limit(case, result, expected, name, shown)
    tolerance = expected.tolerance[result.solver]
    scale = abs(expected.value) if expected.scale is None else expected.scale
    difference = None if shown is None else (shown - expected.value) / scale
    return Check(
        case.name,
        result.solver,
        name,
        expected.source,
        expected.value,
        shown,
        difference is not None and math.isfinite(difference) and abs(difference) <= tolerance,
        expected.unit,
        difference,
        tolerance,
        note="" if shown is not None else "the run does not give it",
    )


def _limit(case: Case, result: Run, expected: Expected, name: str, shown: float | None) -> Check:
    if expected.at_most is not None:
        bound, relation = expected.at_most, "<="
        passed = shown is not None and shown <= bound
    else:
        assert expected.at_least is not None, f"{case.name}: a check of {name} states no number"
        bound, relation = expected.at_least, ">="
        passed = shown is not None and shown >= bound
    note = "" if shown is not None else "the run does not give it"
    return Check(
        case.name, result.solver, name, expected.source, bound, shown, passed, expected.unit,
        relation=relation, note=note,
    )  # fmt: skip


def _at_time(result: Run, column: str, time: float) -> float | None:
    """A column between rows; ``None`` if the run does not reach that time or has no such column."""
    trace = result.trace
    if trace is None or column not in trace.columns() or len(trace) < 2:
        return None
    return column_curve(trace, column).at(time) if trace.time[0] <= time <= trace.time[-1] else None
