"""What is said of the answers of all solvers to a random scene: invariants, and the reference's answer.

A curve is compared relative to what it does in the run, its excursion, so that a small oscillation on a
large mean counts in full; a scalar relative to what :mod:`validation.measure.scaling` says.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from contact_scene import Trace
from validation.execution.runs import Run
from validation.execution.tasks import TaskEnding, TaskResult
from validation.measure.norms import CURVES, distance
from validation.measure.scaling import scale
from validation.solvers import REFERENCE
from validation.solvers.contact_range import largest_contact_radius
from validation.stability import trace_invariants
from validation.stability.random_scenes import RandomScene

WRONG = 0.05
"""Difference from which an answer counts as wrong, beyond the reference's own error: ten times what the
solvers are held to in the built-in scenes. An estimate that holds the difference makes it no better, but
then the run says so."""
NOTICEABLE = 2e-3
"""Difference below which an estimate that falls short of it is not reported."""
LOOSE = 0.1
"""Estimate of a curve from which on a run counts as not resolved, although it ends well."""
LEAST_MOVEMENT = 5e-3
"""Excursion of a curve, relative to its largest magnitude, below which it is at rest and compared
relative to that magnitude: what the solvers are held to in a curve by default."""
STEP_ACCURACY = 4e-3
"""Of an energy, relative to the effort of the run: the coarsest step tolerance of any solver."""
SCALARS = (
    "start_force",
    "start_radius",
    "pull_off_force",
    "detachment_time",
    "detachment_penetration",
    "loop_energy",
    "branch_dissipation",
)
"""Numbers that belong to the scene, not to which row comes next to an extremum."""


class AnswerFinding(StrEnum):
    """What is said of an answer, the worst that applies; the last two are as they should be."""

    CRASHED = "crashed"
    HUNG = "no answer in time"
    IMPROPER = "breaks an invariant"
    OTHER_ENDING = "ends otherwise"
    WRONG = "silently wrong"
    TOLD = "wrong, and says so"
    UNDERSTATED = "off by more than its estimate"
    FAILED = "fails a check"
    LOOSE = "estimate is large"
    NO_REFERENCE = "nothing to compare with"
    DECLINED = "reports no answer"
    AGREES = "agrees"


FAULTS = (
    AnswerFinding.CRASHED,
    AnswerFinding.IMPROPER,
    AnswerFinding.OTHER_ENDING,
    AnswerFinding.WRONG,
    AnswerFinding.TOLD,
    AnswerFinding.UNDERSTATED,
    AnswerFinding.FAILED,
)
"""Judgements after which the scene is written to a file."""


@dataclass(frozen=True)
class RandomSceneAnswer:
    """What became of one solver on one scene.

    Parameters
    ----------
    solver : str
    finding : AnswerFinding
    ending : str
        How the run ended.
    quantity : str
        The worst one.
    difference, allowed : float
        Of that quantity: from the reference, and the sum of both estimates.
    seconds : float
        Processor time, the coarser run for the estimate included.
    note : str
    """

    solver: str
    finding: AnswerFinding
    ending: str
    quantity: str = ""
    difference: float = 0.0
    allowed: float = 0.0
    seconds: float = 0.0
    note: str = ""


@dataclass(frozen=True)
class JudgedScene:
    """A random scene and every solver's answer."""

    seed: int
    kind: str
    indenter: str
    zone: float
    answers: tuple[RandomSceneAnswer, ...]


def examine(chosen: RandomScene, runs: Mapping[str, TaskResult]) -> JudgedScene:
    """Judge the runs of one scene by solver, that of the reference among them."""
    base = runs[REFERENCE].value
    answers = tuple(_answer(chosen, solver, result, base) for solver, result in runs.items())
    scene = chosen.scene
    zone = scene.adhesion.zone / largest_contact_radius(scene) if scene.adhesion is not None else 0.0
    return JudgedScene(chosen.seed, chosen.kind, scene.indenter.shape, zone, answers)


def _answer(chosen: RandomScene, solver: str, result: TaskResult, base: Run | None) -> RandomSceneAnswer:
    if result.ending is TaskEnding.TIMED_OUT:
        return RandomSceneAnswer(solver, AnswerFinding.HUNG, "", note=result.failure)
    run: Run | None = result.value
    if run is None or (run.trace is None and not run.refused):
        note = result.failure if run is None else run.failure
        return RandomSceneAnswer(solver, AnswerFinding.CRASHED, "", note=note)
    trace, seconds = run.trace, run.cpu_seconds + run.estimate_seconds
    if trace is None:
        return RandomSceneAnswer(solver, AnswerFinding.DECLINED, "refused", note=run.failure)
    ending = str(trace.outcome.kind)
    wrong = trace_invariants.broken(chosen.scene, trace)
    wrong += trace_invariants.energy_gained(chosen.scene, trace, STEP_ACCURACY)
    if wrong:
        return RandomSceneAnswer(
            solver, AnswerFinding.IMPROPER, ending, seconds=seconds, note="; ".join(wrong)
        )
    if not run.finished:
        return RandomSceneAnswer(
            solver, AnswerFinding.DECLINED, ending, seconds=seconds, note=trace.outcome.reason
        )
    if solver == REFERENCE:
        return RandomSceneAnswer(solver, AnswerFinding.AGREES, ending, seconds=seconds)
    if base is None or base.trace is None or not base.finished:
        return RandomSceneAnswer(solver, AnswerFinding.NO_REFERENCE, ending, seconds=seconds)
    if base.trace.outcome.kind is not trace.outcome.kind:
        note = f"the reference: {base.trace.outcome.kind} at t = {base.trace.outcome.time:.4g}"
        return RandomSceneAnswer(solver, AnswerFinding.OTHER_ENDING, ending, seconds=seconds, note=note)
    return _compared(run, trace, base, base.trace, seconds)


def _compared(run: Run, trace: Trace, base: Run, base_trace: Trace, seconds: float) -> RandomSceneAnswer:
    ending = str(trace.outcome.kind)
    worst: tuple[float, str, float, float] = (-math.inf, "", 0.0, 0.0)
    finding = AnswerFinding.AGREES
    for name, difference, own, others in _differences(run, trace, base, base_trace):
        allowed = own + others
        now = AnswerFinding.AGREES
        if difference > WRONG + others:
            told = math.isfinite(own) and difference <= allowed
            now = AnswerFinding.TOLD if told else AnswerFinding.WRONG
        elif difference > max(allowed, NOTICEABLE):
            now = AnswerFinding.UNDERSTATED
        elif name in CURVES and LOOSE < own < math.inf:
            now = AnswerFinding.LOOSE
        ranks = list(AnswerFinding)
        key = (difference, name, difference, allowed)
        if ranks.index(now) < ranks.index(finding) or (now is finding and key > worst):
            finding, worst = now, key
    return RandomSceneAnswer(run.solver, finding, ending, worst[1], worst[2], worst[3], seconds)


def _differences(
    run: Run, trace: Trace, base: Run, base_trace: Trace
) -> list[tuple[str, float, float, float]]:
    """Name, difference, own estimate (infinite if there is none), the reference's; relative to one size."""
    found = []
    for column in CURVES:
        apart = distance(trace, base_trace, column)
        values = base_trace.columns()[column]
        largest, excursion = float(np.abs(values).max(initial=0.0)), float(np.ptp(values))
        if apart is None or largest == 0.0:
            continue
        factor = largest / excursion if excursion > LEAST_MOVEMENT * largest else 1.0
        own, others = run.errors.get(column, math.inf), base.errors.get(column, 0.0)
        found.append((column, factor * apart.rms, factor * own, factor * others))
    for name in SCALARS:
        expected, measured = base.measures.get(name), run.measures.get(name)
        if expected is None or measured is None:
            continue
        size = scale(name, expected, base_trace)
        if size > 0.0:
            difference = abs(measured - expected) / size
            found.append((name, difference, run.errors.get(name, math.inf), base.errors.get(name, 0.0)))
    return found
