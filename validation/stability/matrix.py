"""The matrix: every case with every solver, each run in a process that can be killed, and its verdict.

A run passes if its answer is within tolerance, or if it reports that it has none: a refusal, or an outcome
other than ``completed`` and ``detached``. Anything else is a fault; the worst is a wrong answer.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from contact_scene import Material, Scene, SceneError, Trace
from validation.runs.pool import Task, TaskEnding, TaskResult, processes, run_tasks
from validation.runs.provenance import fingerprint
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS
from validation.stability.cases import StabilityCase
from validation.stability.expected import ClosedForm, EquivalentScene, NoSolution, ReferenceRuns


@dataclass(frozen=True)
class CaseRun:
    """One run: solver by name, scene, divisions per process zone, step budget."""

    solver: str
    scene: Scene
    resolution: int
    max_steps: int


@dataclass(frozen=True)
class CaseAnswer:
    """A trace, or the words of a refusal; processor time of the run in seconds."""

    trace: Trace | None = None
    refusal: str = ""
    seconds: float = 0.0


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
    """All that is reported about one run.

    ``errors`` are relative, by observable; ``expected_error`` is the error estimate of the expected values;
    ``seconds`` is processor time; ``residual`` as in :func:`energy_residual`.
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


@dataclass(frozen=True)
class StabilityMatrix:
    """All cells, in the order of the cases, and their wall time (s)."""

    cells: tuple[Cell, ...]
    wall_seconds: float

    @property
    def faults(self) -> tuple[Cell, ...]:
        """Cells at fault."""
        return tuple(cell for cell in self.cells if cell.fault)


def solve_case(run: CaseRun) -> CaseAnswer:
    """Run the solver; a refusal is an answer, anything else that is raised is a crash."""
    solver = SOLVERS[run.solver]
    solver.load()
    begin = time.process_time()
    try:
        trace = solver.solve(run.scene, run.resolution, max_steps=run.max_steps)
    except SceneError as error:
        return CaseAnswer(refusal=str(error), seconds=time.process_time() - begin)
    return CaseAnswer(trace, seconds=time.process_time() - begin)


def run(
    cases: Sequence[StabilityCase],
    jobs: int = 1,
    solvers: Collection[str] = SOLVERS,
    on_cell: Callable[[Cell, list[Cell]], None] = lambda cell, cells: None,
    solve: Callable[[CaseRun], CaseAnswer] = solve_case,
    store: Store | None = None,
) -> StabilityMatrix:
    """Run every case with every solver, ``jobs`` at a time; a cell is judged as soon as its runs are there.

    ``on_cell`` is given each cell and all so far; ``solve`` carries out one run. Runs in the ``store`` are
    not repeated; crashed or hung ones are not stored.
    """
    store = store or Store()
    columns = [(case, solver) for case in cases for solver in solvers]
    needed = [
        [
            Task(
                fingerprint("stability", one),
                f"{case.name}: {one.solver}",
                solve,
                (one,),
                CaseAnswer,
                case.seconds,
            )
            for one in _runs(case, solver)
        ]
        for case, solver in columns
    ]
    results: dict[str, TaskResult] = {}
    cells: dict[int, Cell] = {}

    def on_result(*found: TaskResult) -> None:
        results.update({result.task.key: result for result in found})
        for index, tasks in enumerate(needed):
            if index not in cells and all(task.key in results for task in tasks):
                cells[index] = cell_of(*columns[index], *(results[task.key] for task in tasks))
                on_cell(cells[index], in_order())

    def in_order() -> list[Cell]:
        return [cells[index] for index in sorted(cells)]

    on_result()  # cells without any run
    with processes(jobs, isolated=True) as executor:
        unique = {task.key: task for tasks in needed for task in tasks}
        longest_first = sorted(unique.values(), key=lambda task: -(task.time_limit or 0.0))
        run_tasks(longest_first, executor, store, on_result=on_result)
    return StabilityMatrix(tuple(in_order()), store.seconds)


def _runs(case: StabilityCase, solver: str) -> list[CaseRun]:
    """Runs that a cell rests on: the solver's own first, then those that give the expected answer."""
    if not isinstance(case.scene, Scene):
        return []
    expected, own = case.expected, case.resolution(solver)
    runs = [CaseRun(solver, case.scene, own, case.max_steps)]
    if isinstance(expected, ReferenceRuns):
        tracked = (expected.fine, expected.coarse)
        runs += [CaseRun(REFERENCE, case.scene, divisions, case.max_steps) for divisions in tracked]
    elif isinstance(expected, EquivalentScene):
        runs.append(CaseRun(solver, expected.scene, own, case.max_steps))
    return runs


def cell_of(
    case: StabilityCase, solver: str, result: TaskResult | None = None, *expected_runs: TaskResult
) -> Cell:
    """The cell of one solver, from the results of its run and of those that give the expected answer."""

    def cell(verdict: CellVerdict, outcome: str, reason: str, **facts) -> Cell:
        facts |= {"tolerance": case.tolerance.limit(solver), "why": case.tolerance.why}
        facts |= {"series": case.series, "stiffness": case.stiffness}
        return Cell(case.axis, case.label, solver, verdict, outcome, " ".join(reason.split()), **facts)

    def declined(outcome: str, reason: str, **facts) -> Cell:
        right = isinstance(case.expected, NoSolution)
        verdict = CellVerdict.WITHIN if right else CellVerdict.DECLINED
        return cell(verdict, outcome, reason, source=case.expected.source, **facts)

    if result is None or not isinstance(case.scene, Scene):
        return declined("refused", str(case.scene))
    if result.ending is TaskEnding.TIMED_OUT:
        return cell(CellVerdict.HANG, "hung", result.failure)
    if result.ending is not TaskEnding.ANSWERED:
        return cell(CellVerdict.CRASH, str(result.ending), result.failure)
    answer: CaseAnswer = result.value
    trace, facts = answer.trace, {"seconds": answer.seconds}
    if trace is None:
        return declined("refused", answer.refusal, **facts)
    kind, reason = str(trace.outcome.kind), trace.outcome.reason
    facts |= {"steps": trace.counters.steps, "rejected_steps": trace.counters.rejected_steps}
    broken = [name for name, column in trace.columns().items() if not np.isfinite(column).all()]
    if broken or not np.isfinite(trace.outcome.time):
        where = ", ".join(broken or ["time of the outcome"])
        return cell(CellVerdict.NOT_FINITE, kind, f"not finite: {where}", **facts)
    if not trace.outcome.finished:
        return declined(kind, reason, **facts)
    residual = energy_residual(trace, case.scene.material)
    judged = _judged(case, solver, trace, [_trace(one) for one in expected_runs])
    return cell(judged.pop("verdict"), kind, reason, residual=residual, **facts, **judged)


def _trace(result: TaskResult) -> Trace | None:
    trace = result.value.trace if result.ending is TaskEnding.ANSWERED else None
    return trace if trace is not None and trace.outcome.finished else None


def _judged(case: StabilityCase, solver: str, trace: Trace, found: Sequence[Trace | None]) -> dict[str, Any]:
    """Verdict on a run that reports an answer, its errors and where the expected values come from."""
    expected, own = case.expected, 0.0
    runs = [one for one in found if one is not None]
    if isinstance(expected, NoSolution):
        return {"verdict": CellVerdict.WRONG, "source": expected.source}
    if len(runs) < len(found):
        return {"verdict": CellVerdict.UNKNOWN, "source": "the run it is measured against has no answer"}
    if isinstance(expected, ClosedForm):
        errors, endings = expected.errors(trace), expected.endings
    else:
        errors, endings = expected.errors(trace, runs[0]), (runs[0].outcome.kind,)
    if isinstance(expected, ReferenceRuns):
        own = expected.own_error(*runs)
    if trace.outcome.kind not in endings:
        errors[f"ending ({' or '.join(endings)})"] = math.inf
    within = max(errors.values()) <= case.tolerance.limit(solver) + own
    verdict = CellVerdict.WITHIN if within else CellVerdict.WRONG
    return {"verdict": verdict, "source": expected.source, "errors": errors, "expected_error": own}


def energy_residual(trace: Trace, material: Material) -> float | None:
    """What the energies of a run leave unexplained while in contact, relative to the largest of them.

    At a sharp edge ``W = dU + P_b - int K^2/(2 Einf*) dA``, with the stored energy ``U`` and the branch
    dissipation ``P_b`` from integrals of their own; the work of adhesion does not enter. A solver that knows
    no stress intensity factor keeps such a residual itself (``balance_residual``).
    """
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if touching.size < 2:
        return None
    rows = slice(0, int(touching[-1]) + 1)
    work, stored = trace.external_work[rows], trace.whole_stored_energy[rows]
    if "balance_residual" in trace.extra:
        left = trace.extra["balance_residual"][rows]
    elif {"branch_dissipation", "stress_intensity_factor"} <= trace.extra.keys():
        release = trace.extra["stress_intensity_factor"][rows] ** 2 / (2.0 * material.glassy_plane_modulus)
        opened = -np.diff(np.pi * trace.contact_radius[rows] ** 2)
        released = np.concatenate(([0.0], np.cumsum(0.5 * (release[1:] + release[:-1]) * opened)))
        left = work - work[0] - (stored - stored[0]) - trace.extra["branch_dissipation"][rows] - released
    else:
        return None
    return float(np.abs(left).max()) / (max(float(np.abs(work).max()), float(stored.max())) or 1.0)
