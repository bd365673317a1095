"""From scenes to a report: run, check, and write every form of it into one folder."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from validation.cases import Case
from validation.claims import evidence
from validation.claims.all import checks as claim_checks
from validation.claims.all import findings
from validation.compare.against_reference import check_case
from validation.compare.regression import ReportComparison
from validation.execution.checkpoints import question
from validation.execution.environment import stamp
from validation.execution.files import write_whole
from validation.execution.processes import processes
from validation.execution.runs import Run, output_times, run_all
from validation.execution.store import Store
from validation.measure.check import Check
from validation.report import fields_section, stability_section
from validation.report.claims_section import Claims, pictures
from validation.report.fields_section import FieldsSection
from validation.solvers import SOLVERS
from validation.stability.checks import checks as stability_checks
from validation.stability.runner import Matrix

if TYPE_CHECKING:
    from validation.execution.progress import Progress


@dataclass(frozen=True)
class Page:
    """One scene of a report: its runs by solver, and the verdicts on them."""

    case: Case
    runs: dict[str, Run]
    checks: list[Check]

    @property
    def passed(self) -> bool:
        """Whether every check on this scene passed."""
        return all(check.passed for check in self.checks)


@dataclass(frozen=True)
class Report:
    """Everything a report says; the writers only give it a form."""

    suite: str
    pages: list[Page]
    environment: dict[str, object]
    wall_seconds: float
    baseline: ReportComparison | None = None
    claims: Claims | None = None
    fields: FieldsSection | None = None
    stability: Matrix | None = None

    @property
    def checks(self) -> list[Check]:
        """All verdicts."""
        found = [check for page in self.pages for check in page.checks]
        found += [] if self.claims is None else claim_checks(self.claims.findings)
        return found if self.stability is None else found + stability_checks(self.stability.cells)

    @property
    def runs(self) -> list[Run]:
        """All runs, those behind the paper's statements too; each once."""
        found = [run for page in self.pages for run in page.runs.values()]
        if self.claims is not None:
            found += self.claims.evidence.runs.values()
        return list({(run.scene, run.solver): run for run in found}.values())

    @property
    def failures(self) -> list[Check]:
        """Verdicts that are not fulfilled."""
        return [check for check in self.checks if not check.passed]


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
        tasks += evidence.missing_runs(tasks)
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
        pages.append(Page(case, runs, check_case(case, runs)))
    judged = None
    if claims:
        found = evidence.collect(tasks, results)
        judged = Claims(findings(found), found)
    return Report(suite, pages, stamp(), store.seconds, claims=judged)


def run_question(case: Case, solver: str, estimate: bool) -> str:
    """What makes two runs of a report the same."""
    return question("run", case.scene, solver, output_times(case), estimate)


def write(report: Report, folder: Path) -> None:
    """Write ``index.html``, ``summary.md``, ``report.json``, ``junit.xml`` and ``runs/SCENE/SOLVER/``.

    With the paper's statements also ``figures/``, the paper's figures as PNG.
    """
    from crosscontact.commands.all_commands import write_run
    from validation.report import html, jsonreport, junit, markdown

    (folder / "index.html").unlink(missing_ok=True)  # whoever finds it finds a whole set
    for page in report.pages:
        for solver, result in page.runs.items():
            write_run(folder / "runs" / page.case.name / solver, page.case.scene, result)
    drawn = {} if report.claims is None else pictures(report.claims)
    drawn |= {} if report.fields is None else fields_section.files(report.fields)
    drawn |= {} if report.stability is None else stability_section.pictures(report.stability)
    if drawn:
        (folder / "figures").mkdir(exist_ok=True)
    for name, picture in drawn.items():
        write_whole(folder / "figures" / name, picture)
    for name, form in (
        ("report.json", jsonreport.text),
        ("junit.xml", junit.text),
        ("summary.md", markdown.text),
        ("index.html", html.text),
    ):
        write_whole(folder / name, form(report))
