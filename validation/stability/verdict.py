"""One cell of the matrix: a solver's answer to a case, compared with the expected one.

A run passes if its answer is within tolerance, or if it reports that it has none: a refusal, or an outcome
other than ``completed`` and ``detached``. Anything else is a fault; the worst is a wrong answer.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from contact_scene import Scene, SceneError, Trace
from validation.runs.pool import TaskEnding, TaskResult
from validation.stability import measure
from validation.stability.case import (
    ClosedForm,
    EquivalentScene,
    Expectation,
    NoSolution,
    ReferenceRuns,
    StabilityCase,
)
from validation.stability.case_runs import CaseAnswer


class CellVerdict(StrEnum):
    """How a solver's answer compares with the expected one."""

    WITHIN = "within tolerance"
    DECLINED = "reports no answer"
    WRONG = "SILENTLY WRONG"
    CRASH = "CRASHED"
    NOT_FINITE = "NOT FINITE"
    HANG = "HUNG"
    UNKNOWN = "not compared: no expected values"


FAULTS = (CellVerdict.WRONG, CellVerdict.CRASH, CellVerdict.NOT_FINITE, CellVerdict.HANG)


@dataclass(frozen=True)
class Cell:
    """Everything that is reported about one run.

    ``errors`` are relative, by observable; ``expected_error`` is the error estimate of the expected values;
    ``seconds`` is processor time; ``residual`` as in :func:`measure.energy_residual`.
    """

    axis: str
    label: str
    solver: str
    verdict: CellVerdict
    outcome: str
    reason: str
    source: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    tolerance: float = 0.0
    why: str = ""
    expected_error: float = 0.0
    steps: int = 0
    rejected_steps: int = 0
    residual: float | None = None
    seconds: float = 0.0
    series: str = ""
    stiffness: float = 1.0

    @property
    def name(self) -> str:
        """Unique within the matrix."""
        return f"{self.axis}: {self.label}: {self.solver}"

    @property
    def error(self) -> float | None:
        """The largest error; ``None`` without any."""
        return max(self.errors.values(), default=None)

    @property
    def worst(self) -> str:
        """The observable that has it."""
        return max(self.errors, key=lambda name: self.errors[name], default="")

    @property
    def fault(self) -> bool:
        """Whether this must not happen."""
        return self.verdict in FAULTS


def cell_of(
    case: StabilityCase, solver: str, result: TaskResult | None, expected_runs: tuple[TaskResult | None, ...]
) -> Cell:
    """The cell of one solver.

    Parameters
    ----------
    case : StabilityCase
    solver : str
        Name.
    result : TaskResult or None
        With a ``CaseAnswer``; ``None`` if the scene itself was refused.
    expected_runs : tuple of TaskResult or None
        Runs that give the expected values: for ``ReferenceRuns`` fine and coarse, for ``EquivalentScene`` its
        own.

    Returns
    -------
    Cell
    """
    if result is None:
        assert isinstance(case.scene, SceneError)
        return _declined(case, solver, "refused", str(case.scene))
    if result.ending is TaskEnding.TIMED_OUT:
        return _cell(case, solver, CellVerdict.HANG, "hung", result.failure)
    if result.ending is not TaskEnding.ANSWERED:
        return _cell(case, solver, CellVerdict.CRASH, str(result.ending), result.failure)
    answer: CaseAnswer = result.value
    if answer.trace is None:
        return _declined(case, solver, "refused", answer.refusal, seconds=answer.seconds)
    trace, outcome = answer.trace, answer.trace.outcome
    facts: dict[str, Any] = {
        "steps": trace.counters.steps,
        "rejected_steps": trace.counters.rejected_steps,
        "seconds": answer.seconds,
    }
    broken = [name for name, column in trace.columns().items() if not np.isfinite(column).all()]
    if broken or not np.isfinite(outcome.time):
        reason = f"not finite: {', '.join(broken or ['time of the outcome'])}"
        return _cell(case, solver, CellVerdict.NOT_FINITE, str(outcome.kind), reason, **facts)
    if not outcome.finished:
        return _declined(case, solver, str(outcome.kind), outcome.reason, **facts)
    facts["residual"] = measure.energy_residual(trace, _scene(case).material)
    return _compared(case, solver, trace, expected_runs, facts)


def _compared(
    case: StabilityCase,
    solver: str,
    trace: Trace,
    expected_runs: tuple[TaskResult | None, ...],
    facts: dict[str, Any],
) -> Cell:
    """A run that reports an answer."""
    expected, outcome = case.expected, trace.outcome
    ended = (str(outcome.kind), outcome.reason)
    if isinstance(expected, NoSolution):
        return _cell(case, solver, CellVerdict.WRONG, *ended, source=expected.why, **facts)
    if isinstance(expected, ClosedForm):
        errors, own, endings = measure.against_values(trace, expected.values), 0.0, expected.endings
    else:
        runs = [_trace(result) for result in expected_runs]
        first = runs[0]
        if any(run is None or not run.outcome.finished for run in runs) or first is None:
            source = "the run it is measured against has no answer"
            return _cell(case, solver, CellVerdict.UNKNOWN, *ended, source=source, **facts)
        endings = (first.outcome.kind,)
        if isinstance(expected, EquivalentScene):
            errors, own = measure.against_equivalent(trace, first, expected), 0.0
        else:
            errors = measure.against_trace(trace, first, expected)
            own = _own_error(runs, expected)
    wrong = max(errors.values()) > case.tolerance.limit(solver) + own or outcome.kind not in endings
    if outcome.kind not in endings:
        errors = errors | {f"ending ({' or '.join(endings)})": measure.MISSING}
    verdict = CellVerdict.WRONG if wrong else CellVerdict.WITHIN
    source = source_of(expected)
    return _cell(case, solver, verdict, *ended, source=source, errors=errors, expected_error=own, **facts)


def _own_error(runs: list[Trace | None], expected: ReferenceRuns) -> float:
    fine, coarse = runs
    if fine is None or coarse is None:
        return measure.MISSING
    return measure.RICHARDSON * max(measure.against_trace(coarse, fine, expected).values())


def _declined(case: StabilityCase, solver: str, outcome: str, reason: str, **facts) -> Cell:
    """A run that reports no answer; which is right where there is no solution."""
    right = isinstance(case.expected, NoSolution)
    source = source_of(case.expected)
    verdict = CellVerdict.WITHIN if right else CellVerdict.DECLINED
    return _cell(case, solver, verdict, outcome, reason, source=source, **facts)


def source_of(expected: Expectation) -> str:
    """Where the expected values come from, in words."""
    if isinstance(expected, ClosedForm):
        return expected.source
    if isinstance(expected, ReferenceRuns):
        return f"front tracking, {expected.fine} steps a zone"
    return expected.why if isinstance(expected, NoSolution) else "the same solver on the equivalent scene"


def _cell(case: StabilityCase, solver: str, verdict: CellVerdict, outcome: str, reason: str, **facts) -> Cell:
    return Cell(
        axis=case.axis,
        label=case.label,
        solver=solver,
        verdict=verdict,
        outcome=outcome,
        reason=" ".join(reason.split()),
        tolerance=case.tolerance.limit(solver),
        why=case.tolerance.why,
        series=case.series,
        stiffness=case.stiffness,
        **facts,
    )


def _trace(result: TaskResult | None) -> Trace | None:
    if result is None or result.ending is not TaskEnding.ANSWERED:
        return None
    return result.value.trace


def _scene(case: StabilityCase) -> Scene:
    assert isinstance(case.scene, Scene)
    return case.scene
