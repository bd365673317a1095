"""All solvers on the scenes of a suite, and the verdicts on every run."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field

from validation.cases import Case
from validation.compare.checks import check_case
from validation.measure.difference import Check
from validation.runs.pool import run_all
from validation.runs.progress import Progress
from validation.runs.provenance import stamp
from validation.runs.run import Run
from validation.runs.store import Store
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


@dataclass(frozen=True)
class SuiteComparison:
    """The scenes of a suite, where and in how long they were computed, and runs beside for other evidence.

    ``further`` runs are named by scene and solver.
    """

    suite: str
    scenes: list[SceneComparison]
    environment: dict[str, object]
    wall_seconds: float
    further: dict[tuple[str, str], Run] = field(default_factory=dict)

    @property
    def checks(self) -> list[Check]:
        """All checks on the scenes."""
        return [check for scene in self.scenes for check in scene.checks]

    @property
    def failures(self) -> list[Check]:
        """Checks that are not passed."""
        return [check for check in self.checks if not check.passed]

    @property
    def runs(self) -> dict[tuple[str, str], Run]:
        """All runs by scene and solver, those for other evidence last."""
        own = {(scene.case.name, solver): run for scene in self.scenes for solver, run in scene.runs.items()}
        return own | self.further


def compare_scenes(
    suite: str,
    cases: Sequence[Case],
    executor: Executor | None,
    progress: Progress,
    *,
    estimate: bool = True,
    store: Store | None = None,
    further: Sequence[tuple[Case, str]] = (),
    solvers: Sequence[str] | None = None,
    max_steps: int | None = None,
) -> SuiteComparison:
    """Run every solver on every scene and check the runs.

    The ``quick`` suite has a resolution of its own. Without an executor it is done in this process; the
    progress is closed at the end. ``estimate``: errors of these runs are estimated, and bound the differences
    that count as agreement. ``further`` cases and solvers are run at the same time, for other evidence.
    ``solvers``, by default, are all for which the scene does not take too long.
    """
    store = store or Store()
    pairs = [*all_pairs(cases, solvers), *further]
    estimated = [case.name for case in cases] if estimate else []
    try:
        runs = run_all(pairs, executor, store, progress, estimated, max_steps, suite == "quick")
    finally:
        progress.close()
    scenes = []
    for case in cases:
        by_solver = {solver: runs[case.name, solver] for _, solver in all_pairs([case], solvers)}
        scenes.append(SceneComparison(case, by_solver, check_case(case, by_solver)))
    beside = {(case.name, solver): runs[case.name, solver] for case, solver in further}
    return SuiteComparison(suite, scenes, stamp(), store.seconds, beside)


def all_pairs(cases: Sequence[Case], solvers: Sequence[str] | None = None) -> list[tuple[Case, str]]:
    """Every scene with every solver named, or with all for which it does not take too long."""
    return [
        (case, solver)
        for case in cases
        for solver in solvers or [name for name in SOLVERS if name not in case.too_long_for]
    ]
