"""From scenes to a report: run, check, and write every form of it into one folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from validation.cases import Case
from validation.claims import evidence
from validation.claims.all import judge
from validation.compare.checks import Check
from validation.compare.regression import Comparison
from validation.compare.suite import SceneComparison, all_pairs, compare_scenes
from validation.execution.environment import stamp
from validation.execution.files import write_whole
from validation.execution.run_folder import write_run
from validation.execution.runs import Run
from validation.execution.store import Store
from validation.report import fields_section, stability_section
from validation.report.claims_section import Claims, pictures
from validation.report.fields_section import FieldsSection
from validation.stability.runner import StabilityMatrix

if TYPE_CHECKING:
    from validation.execution.progress import Progress


@dataclass(frozen=True)
class Report:
    """Everything a report says; the writers only give it a form."""

    suite: str
    pages: list[SceneComparison]
    environment: dict[str, object]
    wall_seconds: float
    baseline: Comparison | None = None
    claims: Claims | None = None
    fields: FieldsSection | None = None
    stability: StabilityMatrix | None = None

    @property
    def checks(self) -> list[Check]:
        """All verdicts."""
        found = [check for page in self.pages for check in page.checks]
        found += [] if self.claims is None else self.claims.checks
        return found if self.stability is None else found + stability_section.checks(self.stability)

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
    solvers: Sequence[str] | None = None,
) -> Report:
    """Run every solver on every scene and check the runs.

    Parameters
    ----------
    suite : str
        Name, for the title.
    loaded : list of Case
    workers, progress, estimate, store, solvers
        As of :func:`~validation.compare.suite.compare_scenes`.
    claims : bool
        Whether the paper's statements are judged too, on these runs and those they need beside them; a run
        that both need is done once.

    Returns
    -------
    Report
    """
    store = store or Store()
    pairs = all_pairs(loaded, solvers)
    further = evidence.outstanding(pairs) if claims else []
    pages, runs = compare_scenes(loaded, workers, progress, estimate, store, further, solvers)
    judged = None
    if claims:
        collected = evidence.collect([*pairs, *further], runs)
        judged = Claims(judge(collected), collected)
    return Report(suite, pages, stamp(), store.seconds, claims=judged)


def write(report: Report, folder: Path) -> None:
    """Write ``index.html``, ``summary.md``, ``report.json``, ``junit.xml`` and ``runs/SCENE/SOLVER/``.

    With the paper's statements also ``figures/``, the paper's figures as PNG.
    """
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
