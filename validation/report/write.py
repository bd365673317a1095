"""Documents of each kind of report, and the folder they are written to."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path

from validation.cases import Case
from validation.claims.all import checks as claim_checks
from validation.drawing import export
from validation.execution.files import to_json, write_whole
from validation.execution.provenance import stamp
from validation.execution.run_folder import write_run
from validation.report import html, json_data, junit, markdown
from validation.report.document import Document, Figure, Section, figures_of
from validation.report.figures import zone_chart
from validation.report.report import Report
from validation.report.report_folder import REPORT, STABILITY, STUDY, poisson_json, zones_json
from validation.report.sections import (
    claims,
    costs,
    environment,
    fields,
    overview,
    poisson,
    regression,
    scene,
    stability,
    study,
    zones,
)
from validation.stability.checks import checks as stability_checks
from validation.stability.runner import StabilityMatrix
from validation.studies.poisson import CompressibilityComparison
from validation.studies.study import Study
from validation.studies.zones import ZoneRun


def page(report: Report, scenes: Sequence[tuple[Section, Figure]]) -> Document:
    """Everything, with figures; ``scenes`` are the sections of its scenes and their small figures."""
    parts = [overview.section(report, [small for _, small in scenes])]
    parts += [] if report.baseline is None else [regression.section(report.baseline)]
    parts += [] if report.claims is None else [claims.section(report.claims)]
    parts += [] if report.stability is None else [stability.section(report.stability)]
    parts += [] if report.fields is None else [fields.section(report.fields)]
    parts += [section for section, _ in scenes]
    parts += [costs.section(report.runs), environment.section(report.environment, report.wall_seconds)]
    return Document(overview.title(report), (overview.lead(report),), tuple(parts))


def summary(report: Report) -> Document:
    """Short enough for the summary of a CI job: one line a scene, and whatever did not pass."""
    parts = list(overview.summary(report))
    parts += [] if report.claims is None else [claims.summary(report.claims)]
    parts += [] if report.stability is None else [stability.summary(report.stability)]
    parts += [] if report.baseline is None else [regression.summary(report.baseline)]
    return Document(overview.title(report), (overview.lead(report),), tuple(parts))


def suites(report: Report) -> list[junit.CheckSuite]:
    """Checks grouped by scene and kind of evidence."""
    made = [
        junit.CheckSuite(
            one.case.name, one.checks, {name: run.wall_seconds for name, run in one.runs.items()}
        )
        for one in report.scenes
    ]
    if report.claims is not None:
        findings = report.claims.findings
        made.append(junit.CheckSuite("claims", claim_checks(findings), outputs=claims.outputs(findings)))
    if report.baseline is not None:
        made.append(junit.CheckSuite("baseline", report.baseline.checks))
    if report.stability is not None:
        matrix = report.stability
        made.append(junit.CheckSuite("stability", stability_checks(matrix.cells), {"": matrix.wall_seconds}))
    return made


def write(
    report: Report,
    folder: Path,
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
) -> None:
    """Write ``index.html``, ``summary.md``, ``report.json``, ``junit.xml``, ``runs/SCENE/SOLVER/``.

    What passed has pages of its own in ``pages/`` where one page would be too large. Figures of the paper, of
    the matrix and of fields also come as files in ``figures/``.

    Parameters
    ----------
    report : Report
    folder : Path
    executor : Executor or None
        Draws; ``None``: this process.
    progress : callable or None
        Called with the share of the scenes that are drawn, 0 to 1.
    """
    (folder / "index.html").unlink(missing_ok=True)  # if it is there, the set is complete
    drawn = (map if executor is None else executor.map)(scene.drawn, report.scenes)
    for one in report.scenes:  # while the others draw
        for solver, run in one.runs.items():
            write_run(folder / "runs" / one.case.name / solver, one.case.scene, run)
    write_whole(folder / REPORT, to_json(json_data.of_report(report)))
    checks = junit.text(f"crosscontact {report.suite}", suites(report), report.wall_seconds)
    write_whole(folder / "junit.xml", checks)
    write_whole(folder / "summary.md", markdown.text(summary(report)))
    scenes = []
    for one_drawn in drawn:
        scenes.append(one_drawn)
        if progress is not None:
            progress(len(scenes) / len(report.scenes))
    _write_page(page(report, scenes), folder)


def write_study(result: Study, folder: Path) -> None:
    """Write ``index.html``, ``study.md``, ``study.json`` and ``figures/SCENE-NAME.png`` and ``.svg``."""
    document = study.document(result)
    write_whole(folder / STUDY, to_json(json_data.of_study(result)))
    write_whole(folder / "study.md", markdown.text(document))
    _write_page(document, folder)


def write_matrix(matrix: StabilityMatrix, folder: Path) -> None:
    """Write ``index.html``, ``stability.md``, ``stability.json`` and ``figures/``."""
    write_cells(matrix, folder, complete=True)
    title, lead = "crosscontact stability", (stability.lead(matrix),)
    write_whole(folder / "stability.md", markdown.text(Document(title, lead, (stability.summary(matrix),))))
    parts = stability.section(matrix), environment.section(stamp(), matrix.wall_seconds)
    _write_page(Document(title, lead, parts), folder)


def write_cells(matrix: StabilityMatrix, folder: Path, complete: bool) -> None:
    """Write ``stability.json`` alone, which also holds the cells of an interrupted run."""
    write_whole(folder / STABILITY, to_json(json_data.of_matrix(matrix, complete)))


def write_poisson(case: Case, compressibilities: list[CompressibilityComparison], folder: Path) -> Path:
    """Write ``poisson-NAME.md`` and ``.json``; returns the first."""
    section, path = poisson.section(case.name, compressibilities), folder / poisson_json(case.name)
    write_whole(path, to_json(json_data.of_compressibilities(case, compressibilities)))
    page = path.with_suffix(".md")
    write_whole(page, markdown.text(Document(section.title, (), section.parts)))
    return page


def write_zones(case: Case, runs: list[ZoneRun], folder: Path) -> Path:
    """Write ``zones-NAME.md``, ``.json``, ``.png`` and ``.svg``; returns the first."""
    section, path = zones.section(case.name, runs), folder / zones_json(case.name)
    write_whole(path, to_json(json_data.of_zones(case, runs)))
    page = path.with_suffix(".md")
    write_whole(page, markdown.text(Document(section.title, (), section.parts)))
    figure = zone_chart.draw(runs)
    write_whole(path.with_suffix(".png"), export.png(figure))
    write_whole(path.with_suffix(".svg"), export.svg_file(figure))
    return page


def _write_page(document: Document, folder: Path) -> None:
    """Write the copies of the figures, further pages and, last, ``index.html``."""
    for figure in figures_of(document.parts):
        for name, data in figure.files.items():
            (folder / "figures").mkdir(exist_ok=True)
            write_whole(folder / "figures" / name, data)
    for old in (folder / html.FOLDER).glob("*.html"):
        old.unlink()
    for name, text in reversed(html.pages(document).items()):
        (folder / name).parent.mkdir(exist_ok=True)
        write_whole(folder / name, text)
