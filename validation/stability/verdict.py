"""One cell of the matrix: a solver's answer to a case, compared with the truth.

An answer is right within its tolerance, or it says that it is none: a refusal, or an outcome other than
``completed`` and ``detached``. Anything else is a fault, and the worst is an answer that looks like one.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from contact_scene import Scene, SceneError, Trace
from validation.execution.tasks import TaskEnding, TaskResult
from validation.stability import measure
from validation.stability.case import (
    ClosedForm,
    EquivalentScene,
    NoSolution,
    ReferenceRuns,
    StabilityCase,
    Truth,
)
from validation.stability.probe_runs import ProbeAnswer


class CellVerdict(StrEnum):
    """What a cell shows."""

    WITHIN = "within tolerance"
    DECLINED = "says that it has no answer"
    WRONG = "SILENTLY WRONG"
    CRASH = "CRASHED"
    NOT_FINITE = "NOT FINITE"
    HANG = "HUNG"
    UNKNOWN = "not judged: no truth"


FAULTS = (CellVerdict.WRONG, CellVerdict.CRASH, CellVerdict.NOT_FINITE, CellVerdict.HANG)


@dataclass(frozen=True)
class Cell:
    """Everything that is reported about one run.

    ``errors`` are relative, by observable; ``truth_error`` is the error estimate of the truth; ``seconds`` is
    processor time; ``residual`` as in :func:`measure.energy_residual`.
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
    truth_error: float = 0.0
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
    probe: StabilityCase, solver: str, result: TaskResult | None, truths: tuple[TaskResult | None, ...]
) -> Cell:
    """The cell of one solver.

    Parameters
    ----------
    result : TaskResult or None
        With an ``ProbeAnswer``; ``None`` if the scene itself was refused.
    truths : tuple of TaskResult or None
        Runs the truth rests on: for ``ReferenceRuns`` fine and coarse, for ``EquivalentScene`` its own.
    """
    if result is None:
        assert isinstance(probe.scene, SceneError)
        return _declined(probe, solver, "refused", str(probe.scene))
    if result.ending is TaskEnding.TIMED_OUT:
        return _cell(probe, solver, CellVerdict.HANG, "hung", result.failure)
    if result.ending is not TaskEnding.ANSWERED:
        return _cell(probe, solver, CellVerdict.CRASH, str(result.ending), result.failure)
    answer: ProbeAnswer = result.value
    if answer.trace is None:
        return _declined(probe, solver, "refused", answer.refusal, seconds=answer.seconds)
    trace, outcome = answer.trace, answer.trace.outcome
    facts: dict[str, Any] = {
        "steps": trace.counters.steps,
        "rejected_steps": trace.counters.rejected_steps,
        "seconds": answer.seconds,
    }
    broken = [name for name, column in trace.columns().items() if not np.isfinite(column).all()]
    if broken or not np.isfinite(outcome.time):
        reason = f"not finite: {', '.join(broken or ['time of the outcome'])}"
        return _cell(probe, solver, CellVerdict.NOT_FINITE, str(outcome.kind), reason, **facts)
    if not outcome.finished:
        return _declined(probe, solver, str(outcome.kind), outcome.reason, **facts)
    facts["residual"] = measure.energy_residual(trace, _scene(probe).material)
    return _compared(probe, solver, trace, truths, facts)


def _compared(
    probe: StabilityCase,
    solver: str,
    trace: Trace,
    truths: tuple[TaskResult | None, ...],
    facts: dict[str, Any],
) -> Cell:
    """A run that claims to have an answer."""
    truth, outcome = probe.truth, trace.outcome
    ended = (str(outcome.kind), outcome.reason)
    if isinstance(truth, NoSolution):
        return _cell(probe, solver, CellVerdict.WRONG, *ended, source=truth.why, **facts)
    if isinstance(truth, ClosedForm):
        errors, own, ending = measure.against_values(trace, truth.values), 0.0, truth.ending
        source = truth.source
    else:
        runs = [_trace(result) for result in truths]
        first = runs[0]
        if any(run is None or not run.outcome.finished for run in runs) or first is None:
            source = "the run it is measured against has no answer"
            return _cell(probe, solver, CellVerdict.UNKNOWN, *ended, source=source, **facts)
        ending = first.outcome.kind
        if isinstance(truth, EquivalentScene):
            errors, own = measure.against_equivalent(trace, first, truth), 0.0
            source = "the same solver on the equivalent scene"
        else:
            errors = measure.against_trace(trace, first, truth)
            own = _own_error(runs, truth)
            source = f"front tracking, {truth.fine} steps a zone"
    wrong = max(errors.values()) > probe.tolerance.limit(solver) + own or outcome.kind is not ending
    if outcome.kind is not ending:
        errors = errors | {f"ending ({ending})": measure.MISSING}
    verdict = CellVerdict.WRONG if wrong else CellVerdict.WITHIN
    return _cell(probe, solver, verdict, *ended, source=source, errors=errors, truth_error=own, **facts)


def _own_error(runs: list[Trace | None], truth: ReferenceRuns) -> float:
    fine, coarse = runs
    if fine is None or coarse is None:
        return measure.MISSING
    return measure.RICHARDSON * max(measure.against_trace(coarse, fine, truth).values())


def _declined(probe: StabilityCase, solver: str, outcome: str, reason: str, **facts) -> Cell:
    """A run that reports no answer; which is right where there is no solution."""
    right = isinstance(probe.truth, NoSolution)
    source = source_of(probe.truth)
    verdict = CellVerdict.WITHIN if right else CellVerdict.DECLINED
    return _cell(probe, solver, verdict, outcome, reason, source=source, **facts)


def skipped_cell(probe: StabilityCase, solver: str) -> Cell:
    """A run that takes too long to be part of the matrix: a limit, reported as one."""
    why = probe.skip_reasons[solver]
    return _cell(probe, solver, CellVerdict.DECLINED, "not run", why, source=source_of(probe.truth))


def source_of(truth: Truth) -> str:
    """Where a truth comes from, in words."""
    if isinstance(truth, ClosedForm):
        return truth.source
    if isinstance(truth, ReferenceRuns):
        return f"front tracking, {truth.fine} steps a zone"
    return truth.why if isinstance(truth, NoSolution) else "the same solver on the equivalent scene"


def _cell(
    probe: StabilityCase, solver: str, verdict: CellVerdict, outcome: str, reason: str, **facts
) -> Cell:
    return Cell(
        axis=probe.axis,
        label=probe.label,
        solver=solver,
        verdict=verdict,
        outcome=outcome,
        reason=" ".join(reason.split()),
        tolerance=probe.tolerance.limit(solver),
        why=probe.tolerance.why,
        series=probe.series,
        stiffness=probe.stiffness,
        **facts,
    )


def _trace(result: TaskResult | None) -> Trace | None:
    if result is None or result.ending is not TaskEnding.ANSWERED:
        return None
    return result.value.trace


def _scene(probe: StabilityCase) -> Scene:
    assert isinstance(probe.scene, Scene)
    return probe.scene
