"""From scenes to a report: run and check."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor

from validation.cases import Case
from validation.claims import evidence
from validation.claims.all import findings
from validation.compare.suite import all_pairs, compare_scenes
from validation.execution.progress import Progress
from validation.execution.provenance import stamp
from validation.execution.store import Store
from validation.report.report import Claims, Report


def build(
    suite: str,
    loaded: list[Case],
    executor: Executor | None,
    progress: Progress,
    *,
    estimate: bool = True,
    claims: bool = False,
    store: Store | None = None,
    solvers: Sequence[str] | None = None,
    max_steps: int | None = None,
) -> Report:
    """Run solvers, by default all, on every scene and check the runs.

    Parameters
    ----------
    suite : str
        Name, for the title; ``quick`` has a resolution of its own (``Solver.quick_resolution``).
    loaded : list of Case
    executor, progress, estimate, store, max_steps
        As of :func:`~validation.compare.suite.compare_scenes`.
    claims : bool
        Whether the paper's statements are judged too, on these runs and those they need beside them; a run
        that both need is done once.
    solvers : sequence of str, optional
        Names of the solvers, the reference among them.

    Returns
    -------
    Report
    """
    store = store or Store()
    pairs = all_pairs(loaded, solvers)
    further = evidence.missing_runs(pairs) if claims else []
    pages, runs = compare_scenes(
        loaded,
        executor,
        progress,
        estimate=estimate,
        store=store,
        further=further,
        solvers=solvers,
        max_steps=max_steps,
        quick=suite == "quick",
    )
    judged = None
    if claims:
        collected = evidence.collect([*pairs, *further], runs)
        judged = Claims(findings(collected), collected)
    return Report(suite, pages, stamp(), store.seconds, claims=judged)
