"""From scenes to a report: run and check."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from validation.cases import Case
from validation.claims import evidence
from validation.claims.all import judge
from validation.compare.against_reference import check_case
from validation.compare.suite import SceneComparison
from validation.execution.checkpoints import question
from validation.execution.environment import stamp
from validation.execution.processes import processes
from validation.execution.runs import Run, output_times, run_all
from validation.execution.store import Store
from validation.report.report import Claims, Report
from validation.solvers import SOLVERS

if TYPE_CHECKING:
    from validation.execution.progress import Progress


def build(
    suite: str,
    loaded: list[Case],
    workers: int,
    progress: Progress,
    estimate: bool = True,
    claims: bool = False,
    store: Store | None = None,
) -> Report:
    """Run every solver on every scene, in parallel processes if there is more than one worker.

    With ``estimate`` every run on these scenes is judged by a coarser one, and agreement by what they say of
    their errors. With ``claims`` the paper's statements are judged too, on these runs and those they need
    beside them; a question that comes up in both is asked once. Runs that ``store`` holds are taken over.
    """
    store = store or Store()
    tasks = [(case, solver) for case in loaded for solver in SOLVERS]
    if claims:
        tasks += evidence.outstanding(tasks)
    estimated = {case.name for case in loaded} if estimate else set()
    asked = {(c.name, solver): run_question(c, solver, c.name in estimated) for c, solver in tasks}
    finished = 0

    def keep(result: Run) -> None:
        if result.trace is not None or result.refused:  # a breakdown is tried again
            store.put(asked[result.scene, result.solver], result)
        tell(result)

    def tell(result: Run) -> None:
        nonlocal finished
        finished += 1
        kind = result.trace.outcome.kind if result.trace else "no answer"
        progress(
            finished / len(tasks),
            f"{finished}/{len(tasks)} {result.scene} {result.solver}: {kind}, {result.wall_seconds:.1f} s",
        )

    try:
        results: dict[tuple[str, str], Run] = {}
        for (name, solver), key in asked.items():
            kept = store.get(key)
            if kept is not None:
                results[name, solver] = replace(kept, scene=name)
        if results:
            finished = len(results)
            progress(finished / len(tasks), f"{finished}/{len(tasks)} taken over from an earlier attempt")
        missing = [(case, solver) for case, solver in tasks if (case.name, solver) not in results]
        with processes(min(workers, len(missing))) as executor:
            results |= run_all(missing, executor, keep, estimated)
    finally:
        progress.close()
    pages = []
    for case in loaded:
        runs = {solver: results[case.name, solver] for solver in SOLVERS}
        pages.append(SceneComparison(case, runs, check_case(case, runs)))
    judged = None
    if claims:
        found = evidence.collect(tasks, results)
        judged = Claims(judge(found), found)
    return Report(suite, pages, stamp(), store.seconds, claims=judged)


def run_question(case: Case, solver: str, estimate: bool) -> str:
    """What makes two runs of a report the same."""
    return question("run", case.scene, solver, output_times(case), estimate)
