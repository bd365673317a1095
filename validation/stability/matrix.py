"""The matrix: every case with every solver, each run in a process that can be killed, and its verdict.

A run passes if its answer is within tolerance, or if it reports that it has none: a refusal, or an outcome
other than ``completed`` and ``detached``. Anything else is a fault; the worst is a wrong answer.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

from contact_scene import Material, Scene, Trace
from validation.cases import Case
from validation.runs import pool
from validation.runs.run import Run
from validation.runs.store import Store
from validation.solvers import REFERENCE, SOLVERS
from validation.stability.cases import StabilityCase
from validation.stability.expected import ClosedForm, EquivalentScene, NoSolution, ReferenceRuns


class CellVerdict(StrEnum):
    """How a solver's answer compares with the expected one."""

    WITHIN = "within tolerance"
    DECLINED = "reports no answer"
    WRONG = "SILENTLY WRONG"
    CRASH = "CRASHED"
    HANG = "HUNG"
    UNKNOWN = "not compared: no expected values"


FAULTS = (CellVerdict.WRONG, CellVerdict.CRASH, CellVerdict.HANG)


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


def run(
    cases: Sequence[StabilityCase],
    jobs: int = 1,
    solvers: Collection[str] = SOLVERS,
    progress: pool.TellProgress | None = None,
    task: Callable[..., pool.Task] = pool.run_task,
    store: Store | None = None,
) -> StabilityMatrix:
    """Run every case with every solver, ``jobs`` at a time; ``task`` makes the task of a run.

    Runs in the ``store`` are not repeated; crashed or hung ones are not stored.
    """
    store = store or Store()
    columns = [(case, solver) for case in cases for solver in solvers]
    needed = [_tasks(case, solver, task) for case, solver in columns]
    unique = {one.key: one for tasks in needed for one in tasks}
    longest_first = sorted(unique.values(), key=lambda one: -(one.time_limit or 0.0))
    with pool.processes(jobs, isolated=True) as executor:
        results = {one.task.key: one for one in pool.run_tasks(longest_first, executor, store, progress)}
    pairs = zip(columns, needed, strict=True)
    cells = (cell_of(*column, *(results[one.key] for one in tasks)) for column, tasks in pairs)
    return StabilityMatrix(tuple(cells), store.seconds)


def _tasks(case: StabilityCase, solver: str, task: Callable[..., pool.Task]) -> list[pool.Task]:
    """Runs that a cell rests on: the solver's own first, then those that give the expected answer."""
    if not isinstance(case.scene, Scene):
        return []
    expected, own = case.expected, case.resolution(solver)
    runs = [(solver, case.scene, own)]
    if isinstance(expected, ReferenceRuns):
        runs += [(REFERENCE, case.scene, divisions) for divisions in (expected.fine, expected.coarse)]
    elif isinstance(expected, EquivalentScene):
        runs.append((solver, expected.scene, own))
    budget = {"max_steps": case.max_steps, "time_limit": case.seconds}
    return [task(Case(case.name, scene), name, divisions, **budget) for name, scene, divisions in runs]


def cell_of(
    case: StabilityCase, solver: str, result: pool.TaskResult | None = None, *expected_runs: pool.TaskResult
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
    if result.ending is not pool.TaskEnding.ANSWERED:
        hung = result.ending is pool.TaskEnding.TIMED_OUT
        return cell(CellVerdict.HANG if hung else CellVerdict.CRASH, str(result.ending), result.failure)
    found = pool.run_of(result)
    if found.breakdown:
        return cell(CellVerdict.CRASH, found.outcome, found.failure)
    facts: dict[str, Any] = {"seconds": found.cpu_seconds}
    if found.trace is not None:
        counters = found.trace.counters
        facts |= {"steps": counters.steps, "rejected_steps": counters.rejected_steps}
    if found.trace is None or not found.finished:
        return declined(found.outcome, found.reason, **facts)
    facts["residual"] = energy_residual(found.trace, case.scene.material)
    return cell(
        outcome=found.outcome,
        reason=found.reason,
        **facts,
        **_judged(case, solver, found, list(map(pool.run_of, expected_runs))),
    )


def _judged(case: StabilityCase, solver: str, run: Run, bases: Sequence[Run]) -> dict[str, Any]:
    """Verdict on a run that reports an answer, its errors and where the expected values come from."""
    expected, own = case.expected, 0.0
    if isinstance(expected, NoSolution):
        return {"verdict": CellVerdict.WRONG, "source": expected.source}
    if not all(base.finished for base in bases):
        return {"verdict": CellVerdict.UNKNOWN, "source": "the run it is measured against has no answer"}
    endings = expected.endings if isinstance(expected, ClosedForm) else (bases[0].outcome,)
    errors = expected.errors(run, *bases[:1])
    if isinstance(expected, ReferenceRuns):
        own = expected.own_error(*bases)
    if run.outcome not in endings:
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
