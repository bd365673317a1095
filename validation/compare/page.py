"""The report of a suite: overview, other evidence, every scene; ``report.json`` and its other forms.

The keys of ``report.json`` are a fixed contract with whoever reads it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from validation.compare import scene_page
from validation.compare.regression import ReportComparison
from validation.compare.scene_page import anchor, skipped_work
from validation.compare.suite import SceneComparison, SuiteComparison
from validation.drawing.figure import INK, SIZE, curve_style, drawing, format_axes
from validation.measure.difference import Check
from validation.report import document as doc
from validation.report import html
from validation.report import report as folders
from validation.report.report import Chapter
from validation.report.tables import costs, environment, of_checks, spent
from validation.report.texts import markdown
from validation.runs.folder import to_json
from validation.runs.provenance import of_case, version
from validation.runs.run import summary as summary_of_run
from validation.runs.run import write_run
from validation.solvers import REFERENCE, SOLVERS
from validation.solvers.base import QUICK_DIVISIONS

FORMAT = 1
LEAST = 1e-9
"""Error at which smaller ones, those of rounding, are drawn."""
CURVE_ERROR = "F(t), RMS"
"""The check whose difference stands for the error of a run in the chart."""
EXPLAINED = (
    "Differences are relative; each stands beside the error estimates of solver and reference and beside the "
    "scene's tolerance. Two runs agree where they differ by no more than both estimates together, at most by "
    "the tolerance; where an estimate is missing, by the tolerance. A coarse or failed run stays in the "
    "tables and figures."
)
PICTURES = (
    "Force against penetration of each scene, all solvers laid over each other, in the colours of the chart "
    "below; a click leads to the scene."
)
QUICK = (
    f"The quick suite is solved at {QUICK_DIVISIONS} divisions of the process zone at most, where that is "
    "cheaper than a solver's default; its checks ask for no more."
)


def checks(compared: SuiteComparison, others: Sequence[Chapter]) -> list[Check]:
    """All checks, those of other evidence last."""
    return [*compared.checks, *(check for chapter in others for check in chapter.checks)]


def data(compared: SuiteComparison, others: Sequence[Chapter] = ()) -> dict[str, Any]:
    """Contents of ``report.json``, with the keys of other evidence."""
    judged = checks(compared, others)
    failed = sum(not check.passed for check in judged)
    whole = {
        "format": FORMAT,
        "suite": compared.suite,
        "passed": not failed,
        "checks": len(judged),
        "failed": failed,
        "wall_seconds": compared.wall_seconds,
        "cpu_seconds": sum(map(spent, compared.runs.values())),
        "environment": compared.environment,
        "program": version(),
        "scenes": [_data_of(scene) for scene in compared.scenes],
    }
    for chapter in others:
        whole |= chapter.data
    return whole


def _data_of(scene: SceneComparison) -> dict[str, Any]:
    return {
        "name": scene.case.name,
        "title": scene.case.scene.title,
        "figure": scene.case.figure,
        "statement": scene.case.statement,
        "premises": of_case(scene.case),
        "left_out": skipped_work(scene),
        "passed": scene.passed,
        "runs": {
            solver: summary_of_run(run) | {"traceback": run.details or None}
            for solver, run in scene.runs.items()
        },
        "checks": [asdict(check) for check in scene.checks],
    }


def write(
    compared: SuiteComparison,
    folder: Path,
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
    others: Sequence[Chapter] = (),
    moved: ReportComparison | None = None,
) -> None:
    """Write ``index.html``, ``summary.md``, ``report.json``, ``junit.xml``, ``runs/SCENE/SOLVER/``.

    The executor draws (without one, this process); ``progress`` takes the share of the scenes drawn, 0 to 1.
    What has moved since an earlier report are cases of ``junit.xml``, but no checks of this report.
    """
    (folder / html.INDEX).unlink(missing_ok=True)  # where it exists, the set is complete
    drawing = (map if executor is None else executor.map)(scene_page.drawn, compared.scenes)
    for one in compared.scenes:  # while the others draw
        for solver, run in one.runs.items():
            write_run(folder / "runs" / one.case.name / solver, one.case.scene, run)
    scenes, pictures = [], []
    for one, (section, picture) in zip(compared.scenes, drawing, strict=True):
        seconds = {name: run.wall_seconds for name, run in one.runs.items()}
        scenes.append(Chapter(one.case.name, one.checks, (section,), seconds=seconds))
        pictures.append(picture)
        if progress is not None:
            progress(len(scenes) / len(compared.scenes))
    failures = [check for check in checks(compared, others) if not check.passed]
    beside = [*([] if moved is None else [moved.chapter()]), *others]
    title, opening = f"crosscontact report, suite {compared.suite}", (lead(compared, others),)
    parts = (
        overview(compared, failures, pictures),
        *(section for chapter in (*beside, *scenes) for section in chapter.sections),
        costs(list(compared.runs.values())),
        environment(compared.environment, compared.wall_seconds),
    )
    short = (*summary(compared, failures), *(part for chapter in beside for part in chapter.summary))
    whole = data(compared, others) | dict(beside[0].data if moved is not None else {})
    cases = folders.junit(f"crosscontact {compared.suite}", [*scenes, *beside], compared.wall_seconds)
    files = {
        "report.json": to_json(whole),
        "junit.xml": cases,
        "summary.md": markdown(doc.Document(title, opening, short)),
    }
    folders.write(folder, doc.Document(title, opening, parts), files)


def lead(compared: SuiteComparison, others: Sequence[Chapter] = ()) -> doc.Paragraph:
    """How many checks, and how many not passed."""
    judged = checks(compared, others)
    failed = sum(not check.passed for check in judged)
    verdict = f"{failed} not passed" if failed else "all passed"
    return doc.Paragraph(
        f"{doc.counted(len(judged), 'check')} on {doc.counted(len(compared.scenes), 'scene')}: {verdict}.",
        not failed,
    )


def overview(
    compared: SuiteComparison, failures: Sequence[Check], small: Sequence[doc.Figure] = ()
) -> doc.Section:
    """What did not pass; ``small`` figures, a chart of all errors, a line for each scene, and the solvers."""
    rows: Iterator[doc.Record] = (
        {
            "scene": doc.LinkCell(scene.case.name, anchor(scene)),
            "paper": scene.case.figure,
            "checks": _counted(scene),
            "verdict": doc.passed_or_not(scene.passed),
            "closest to its limit": _closest(scene),
        }
        for scene in compared.scenes
    )
    parts: list[doc.Part] = []
    if failures:
        anchors = {scene.case.name: anchor(scene) for scene in compared.scenes}
        parts.append(doc.Section("Not passed", (of_checks(failures, anchors),), "not-passed"))
    if small:
        parts += [
            doc.Paragraph(PICTURES),
            doc.Figures(tuple(small), small=True),
            doc.Figures((_cost(compared.scenes),)),
        ]
    resolution = (doc.Paragraph(QUICK),) if compared.suite == "quick" else ()
    parts.append(
        doc.Section("Scene by scene", (doc.DataTable.of(rows), doc.Paragraph(EXPLAINED), *resolution))
    )
    names = dict.fromkeys(name for scene in compared.scenes for name in scene.runs)
    solvers = doc.DataTable.of(
        {"solver": name, "method": SOLVERS[name].title, "how it works": SOLVERS[name].description}
        for name in names
        if name in SOLVERS
    )
    if solvers.rows:
        parts.append(doc.Section("The solvers", (solvers,)))
    return doc.Section("Overview", tuple(parts), "overview")


def summary(compared: SuiteComparison, failures: Sequence[Check]) -> tuple[doc.Part, ...]:
    """Parts of ``summary.md``: pull-off forces and outcomes, work left out, and what did not pass."""
    solvers = tuple(dict.fromkeys(name for scene in compared.scenes for name in scene.runs))
    parts: tuple[doc.Part, ...] = (
        doc.Paragraph(f"{compared.wall_seconds:.0f} s on {compared.environment['processor']}."),
        doc.DataTable.of(_line(scene, solvers) for scene in compared.scenes),
        doc.Paragraph("Left out, by the counters of work:"),
        doc.Bullets(tuple(f"{scene.case.name}: {skipped_work(scene)}" for scene in compared.scenes)),
    )
    return (*parts, doc.Section("Not passed", (of_checks(failures, {}),))) if failures else parts


def _line(scene: SceneComparison, solvers: Sequence[str]) -> doc.Record:
    """What the solvers have to say of a scene; some of them may not have been asked."""
    forces = (run.measures.get("pull_off_force") for run in scene.runs.values())
    cells: dict[str, doc.Cell] = {
        "scene": scene.case.name,
        "checks": _counted(scene),
        "verdict": doc.passed_or_not(scene.passed),
        "pull-off force": " / ".join(doc.number(force, 5) for force in forces),
    }
    for solver in solvers:
        run = scene.runs.get(solver)
        cells[solver] = doc.ABSENT
        if run is not None:
            answered = run.trace is not None
            cells[solver] = f"{run.outcome}, {run.wall_seconds:.2g} s" if answered else run.ending
    return cells


def _counted(scene: SceneComparison) -> str:
    return f"{sum(check.passed for check in scene.checks)}/{len(scene.checks)}"


def _closest(scene: SceneComparison) -> str:
    """The check that uses the largest share of its limit."""
    shares = {
        f"{doc.plain(check.quantity)}, {check.solver}": abs(check.difference) / check.limit
        for check in scene.checks
        if check.difference is not None and check.limit
    }
    if not shares:
        return doc.ABSENT
    closest = max(shares, key=lambda name: shares[name])
    return f"{100 * shares[closest]:.0f} %: {closest}"


def _cost(scenes: Sequence[SceneComparison]) -> doc.Figure:
    """Error of the force over the run against processor time, a mark for each run of each solver."""
    points: dict[str, list[tuple[float, float]]] = {}
    for scene in scenes:
        found = {check.solver: check.difference for check in scene.checks if check.quantity == CURVE_ERROR}
        for solver, run in scene.runs.items():
            error = run.errors.get("force") if solver == REFERENCE else found.get(solver)
            if error and run.cpu_seconds > 0.0:
                points.setdefault(solver, []).append((run.cpu_seconds, max(abs(error), LEAST)))
    figure = doc.Figure(
        "error-over-time",
        "Error of the force over the whole run, relative to its largest, against processor time: all scenes. "
        f"Difference from the reference; of the reference, its own error estimate; {LEAST:g} at least.",
        missing="No figure: no run has an error.",
    )
    if not points:
        return doc.with_drawing(figure, None)
    picture, axes = drawing((1.6 * SIZE[0], SIZE[1]))
    axes.set(xscale="log", yscale="log", xlabel="processor time (s)", ylabel="error of F(t), RMS")
    for solver, found_points in points.items():
        style = curve_style(solver)
        seconds, errors = zip(*found_points, strict=True)
        marker = {"marker": style["marker"] or "D", "color": style["color"], "fillstyle": "none"}
        axes.plot(seconds, errors, linestyle="none", markersize=5, label=solver, **marker)
    format_axes(axes)
    axes.legend(frameon=False, labelcolor=INK, fontsize="small")
    return doc.with_drawing(figure, picture)
