"""The report of a suite: overview, other evidence, every scene; ``report.json`` and its other forms.

The keys of ``report.json`` are a fixed contract with whoever reads it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import asdict
from pathlib import Path
from typing import Any

from validation.compare import overview_figures, scene_page
from validation.compare.regression import Move, ReportComparison
from validation.compare.scene_page import anchor, skipped_work
from validation.compare.suite import SceneComparison, SuiteComparison
from validation.measure.difference import Check
from validation.report import html, junit, markdown
from validation.report import report as folders
from validation.report.document import (
    ABSENT,
    Bullets,
    Cell,
    DataTable,
    Document,
    Figure,
    Figures,
    LinkCell,
    Paragraph,
    Part,
    Record,
    Section,
    VerdictCell,
    counted,
    formatted,
    number,
    passed_or_not,
    plain,
)
from validation.report.report import Chapter
from validation.report.tables import costs, environment, of_checks, spent
from validation.runs.folder import to_json
from validation.runs.provenance import of_case, version
from validation.runs.run import summary as summary_of_run
from validation.runs.run import write_run
from validation.solvers import SOLVERS
from validation.solvers.base import QUICK_DIVISIONS

FORMAT = 1
MOST = 20
"""Moves since an earlier report that a summary lists, unless more are beyond tolerance."""
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
    """``report.json`` with what other evidence has to say."""
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
    drawn: list[tuple[Section, Figure]] = []
    for pair in drawing:
        drawn.append(pair)
        if progress is not None:
            progress(len(drawn) / len(compared.scenes))
    scenes = [
        Chapter(
            one.case.name,
            one.checks,
            (section,),
            seconds={name: run.wall_seconds for name, run in one.runs.items()},
        )
        for one, (section, _) in zip(compared.scenes, drawn, strict=True)
    ]
    judged = checks(compared, others)
    failures = [check for check in judged if not check.passed]
    earlier = [] if moved is None else [since(moved)]
    beside = [*earlier, *others]
    title = f"crosscontact report, suite {compared.suite}"
    opening = (lead(compared, judged),)
    parts = (
        overview(compared, failures, [small for _, small in drawn]),
        *(section for chapter in (*beside, *scenes) for section in chapter.sections),
        costs(list(compared.runs.values())),
        environment(compared.environment, compared.wall_seconds),
    )
    short = (*summary(compared, failures), *(part for chapter in beside for part in chapter.summary))
    whole = data(compared, others)
    for chapter in earlier:
        whole |= chapter.data
    folders.write(
        folder,
        Document(title, opening, parts),
        {
            "report.json": to_json(whole),
            "junit.xml": junit.text(
                f"crosscontact {compared.suite}", [*scenes, *beside], compared.wall_seconds
            ),
            "summary.md": markdown.text(Document(title, opening, short)),
        },
    )


def lead(compared: SuiteComparison, judged: Sequence[Check]) -> Paragraph:
    """How many checks, and how many not passed."""
    failed = sum(not check.passed for check in judged)
    verdict = f"{failed} not passed" if failed else "all passed"
    return Paragraph(
        f"{counted(len(judged), 'check')} on {counted(len(compared.scenes), 'scene')}: {verdict}.",
        not failed,
    )


def overview(compared: SuiteComparison, failures: Sequence[Check], small: Sequence[Figure] = ()) -> Section:
    """What did not pass; ``small`` figures, a chart of all errors, a line for each scene, and the solvers."""
    rows: Iterator[Record] = (
        {
            "scene": LinkCell(scene.case.name, anchor(scene)),
            "paper": scene.case.figure,
            "checks": _counted(scene),
            "verdict": passed_or_not(scene.passed),
            "closest to its limit": _closest(scene),
        }
        for scene in compared.scenes
    )
    resolution = (Paragraph(QUICK),) if compared.suite == "quick" else ()
    pictures: tuple[Part, ...] = (Paragraph(PICTURES), Figures(tuple(small), small=True))
    pictures = (*pictures, Figures((overview_figures.cost(compared.scenes),))) if small else ()
    lines = Section("Scene by scene", (DataTable.of(rows), Paragraph(EXPLAINED), *resolution))
    parts: tuple[Part, ...] = (*pictures, lines, *solvers(compared))
    if failures:
        parts = (Section("Not passed", (_failures(compared, failures),), "not-passed"), *parts)
    return Section("Overview", parts, "overview")


def solvers(compared: SuiteComparison) -> tuple[Part, ...]:
    """The solvers of the runs, with their methods in words; nothing without a run."""
    names = dict.fromkeys(name for scene in compared.scenes for name in scene.runs)
    known = [SOLVERS[name] for name in names if name in SOLVERS]
    rows: Iterator[Record] = (
        {"solver": one.name, "method": one.title, "how it works": one.description} for one in known
    )
    return (Section("The solvers", (DataTable.of(rows),)),) if known else ()


def _failures(compared: SuiteComparison, failures: Sequence[Check]) -> DataTable:
    """Every check that did not pass, in the order of the scenes; details are in their sections."""
    anchors = {scene.case.name: anchor(scene) for scene in compared.scenes}
    rows: Iterator[Record] = (
        {
            "scene": LinkCell(one.scene, anchors[one.scene]) if one.scene in anchors else one.scene,
            "solver": one.solver,
            "quantity": plain(one.quantity),
            "found": number(one.found),
            "expected": number(one.expected),
            "difference": formatted(one.difference, "+.1e"),
            "allowed": formatted(one.limit, ".1e"),
            "why": one.note or one.source,
        }
        for one in failures
    )
    return DataTable.of(rows)


def summary(compared: SuiteComparison, failures: Sequence[Check]) -> tuple[Part, ...]:
    """The same for a summary: pull-off forces and outcomes, work left out, and what did not pass."""
    solvers = tuple(dict.fromkeys(name for scene in compared.scenes for name in scene.runs))
    left_out = tuple(f"{scene.case.name}: {skipped_work(scene)}" for scene in compared.scenes)
    parts: tuple[Part, ...] = (
        Paragraph(f"{compared.wall_seconds:.0f} s on {compared.environment['processor']}."),
        DataTable.of(_line(scene, solvers) for scene in compared.scenes),
        Paragraph("Left out, by the counters of work:"),
        Bullets(left_out),
    )
    if failures:
        parts += (Section("Not passed", (of_checks(failures, with_scene=True),)),)
    return parts


def _line(scene: SceneComparison, solvers: Iterable[str]) -> Record:
    """What the solvers have to say of a scene; some of them may not have been asked."""
    forces = (run.measures.get("pull_off_force") for run in scene.runs.values())
    cells: dict[str, Cell] = {
        "scene": scene.case.name,
        "checks": _counted(scene),
        "verdict": passed_or_not(scene.passed),
        "pull-off force": " / ".join(number(force, 5) for force in forces),
    }
    for solver in solvers:
        run = scene.runs.get(solver)
        cells[solver] = ABSENT
        if run is not None:
            answered = run.trace is not None
            cells[solver] = f"{run.outcome}, {run.wall_seconds:.2g} s" if answered else run.ending
    return cells


def _counted(scene: SceneComparison) -> str:
    return f"{sum(check.passed for check in scene.checks)}/{len(scene.checks)}"


def _closest(scene: SceneComparison) -> str:
    """The check that uses the largest share of its limit."""
    shares = [
        (abs(check.difference) / check.limit, check)
        for check in scene.checks
        if check.difference is not None and check.limit
    ]
    if not shares:
        return ABSENT
    share, check = max(shares, key=lambda pair: pair[0])
    return f"{100 * share:.0f} %: {plain(check.quantity)}, {check.solver}"


def since(moved: ReportComparison) -> Chapter:
    """All moves since an earlier report; in short all that count and the largest of the rest."""
    changes = (Bullets(moved.changes),) if moved.changes else ()
    heading: tuple[Part, ...] = (*changes, Paragraph(moved.verdict))
    shown = moved.moves[: max(len(moved.beyond), MOST)]
    more = len(moved.moves) - len(shown)
    rest = (Paragraph(f"{more} smaller moves are in report.json."),) if more else ()
    title, moves = "Since the baseline", [asdict(move) for move in moved.moves]
    return Chapter(
        "baseline",
        moved.checks,
        (Section(title, (*heading, *_listed(moved.moves))),),
        (Section(title, (*heading, *_listed(shown), *rest)),),
        {"baseline": {"path": moved.path, "changes": list(moved.changes), "moves": moves}},
    )


def _listed(moves: tuple[Move, ...]) -> tuple[DataTable, ...]:
    return (DataTable.of(map(_move, moves)),) if moves else ()


def _move(move: Move) -> Record:
    return {
        "scene": move.scene,
        "solver": move.solver or ABSENT,
        "what": plain(move.what),
        "before": number(move.before, 8),
        "after": number(move.after, 8),
        "change": formatted(move.change, "+.1e"),
        "tolerance": formatted(move.tolerance, ".0e"),
        "beyond": VerdictCell("BEYOND" if move.beyond else "no", not move.beyond),
    }
