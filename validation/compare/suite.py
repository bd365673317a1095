"""All solvers on a list of scenes, and the verdicts on every run."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

from validation.cases import Case
from validation.compare.against_reference import check_case
from validation.execution.progress import Progress
from validation.execution.run import Run
from validation.execution.solver_tasks import run_all
from validation.execution.store import Store
from validation.measure.check import Check
from validation.solvers import SOLVERS


@dataclass(frozen=True)
class SceneComparison:
    """One scene: its runs by solver, and the verdicts on them."""

    case: Case
    runs: dict[str, Run]
    checks: list[Check]

    @property
    def passed(self) -> bool:
        """Whether every check on this scene passed."""
        return all(check.passed for check in self.checks)


def compare_scenes(
    cases: Sequence[Case],
    executor: Executor | None,
    progress: Progress,
    *,
    estimate: bool = True,
    store: Store | None = None,
    further: Sequence[tuple[Case, str]] = (),
    solvers: Sequence[str] | None = None,
    max_steps: int | None = None,
    quick: bool = False,
) -> tuple[list[SceneComparison], dict[tuple[str, str], Run]]:
    """Run every solver on every scene and check the runs.

    Parameters
    ----------
    cases : sequence of Case
    executor : Executor or None
        ``None``: in this process.
    progress : Progress
        Closed at the end.
    estimate : bool
        Whether errors of these runs are estimated, and bound the differences that count as agreement.
    store : Store or None
        Runs of an earlier attempt are taken over.
    further : sequence of (Case, str)
        Cases and solvers to be run at the same time, for other evidence.
    solvers : sequence of str or None
        Names; ``None``: all for which the scene does not take too long.
    max_steps : int or None
        Of every run; ``None``: the solver's own bound.
    quick : bool
        Whether runs have the resolution of the quick suite, not each solver's default.

    Returns
    -------
    comparisons : list of SceneComparison
    runs : dict of (str, str) to Run
        All of them by scene and solver, the further ones included.
    """
    pairs = [*all_pairs(cases, solvers), *further]
    estimated = [case.name for case in cases] if estimate else []
    try:
        runs = run_all(pairs, executor, store, progress, estimated, max_steps, quick)
    finally:
        progress.close()
    comparisons = []
    for case in cases:
        by_solver = {solver: runs[case.name, solver] for _, solver in all_pairs([case], solvers)}
        comparisons.append(SceneComparison(case, by_solver, check_case(case, by_solver)))
    return comparisons, runs


def all_pairs(cases: Sequence[Case], solvers: Sequence[str] | None = None) -> list[tuple[Case, str]]:
    """Every scene with every solver named, or with all for which it does not take too long."""
    return [
        (case, solver)
        for case in cases
        for solver in solvers or [name for name in SOLVERS if name not in case.too_long_for]
    ]
