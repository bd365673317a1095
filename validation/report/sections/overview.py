"""The head of a report, a line for each scene, and what did not pass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from validation.compare.suite import SceneComparison
from validation.report.document import (
    ABSENT,
    Bullets,
    Cell,
    DataTable,
    Figure,
    Figures,
    LinkCell,
    Paragraph,
    Part,
    Record,
    Section,
    counted,
    formatted,
    number,
    passed_or_not,
    plain,
)
from validation.report.figures import overview_figures
from validation.report.report import Report
from validation.report.sections import checks
from validation.report.sections.scene import anchor, skipped_work
from validation.solvers import SOLVERS
from validation.solvers.base import QUICK_DIVISIONS

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


def title(report: Report) -> str:
    """Title of the page and of the summary."""
    return f"crosscontact report, suite {report.suite}"


def lead(report: Report) -> Paragraph:
    """How many checks, and how many not passed."""
    failed = len(report.failures)
    verdict = f"{failed} not passed" if failed else "all passed"
    return Paragraph(
        f"{counted(len(report.checks), 'check')} on {counted(len(report.scenes), 'scene')}: {verdict}.",
        not failed,
    )


def section(report: Report, small: Sequence[Figure] = ()) -> Section:
    """What did not pass; ``small`` figures, a chart of all errors, a line for each scene, and the solvers."""
    rows: Iterator[Record] = (
        {
            "scene": LinkCell(scene.case.name, anchor(scene)),
            "paper": scene.case.figure,
            "checks": _counted(scene),
            "verdict": passed_or_not(scene.passed),
            "closest to its limit": _closest(scene),
        }
        for scene in report.scenes
    )
    resolution = (Paragraph(QUICK),) if report.suite == "quick" else ()
    pictures: tuple[Part, ...] = (Paragraph(PICTURES), Figures(tuple(small), small=True))
    pictures = (*pictures, Figures((overview_figures.cost(report.scenes),))) if small else ()
    lines = Section("Scene by scene", (DataTable.of(rows), Paragraph(EXPLAINED), *resolution))
    parts: tuple[Part, ...] = (*pictures, lines, *solvers(report))
    if report.failures:
        parts = (Section("Not passed", (_failures(report),), "not-passed"), *parts)
    return Section("Overview", parts, "overview")


def solvers(report: Report) -> tuple[Part, ...]:
    """The solvers of the runs, with their methods in words; nothing without a run."""
    names = dict.fromkeys(name for scene in report.scenes for name in scene.runs)
    known = [SOLVERS[name] for name in names if name in SOLVERS]
    rows: Iterator[Record] = (
        {"solver": one.name, "method": one.title, "how it works": one.description} for one in known
    )
    return (Section("The solvers", (DataTable.of(rows),)),) if known else ()


def _failures(report: Report) -> DataTable:
    """Every check that did not pass, in the order of the scenes; details are in their sections."""
    anchors = {scene.case.name: anchor(scene) for scene in report.scenes}
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
        for one in report.failures
    )
    return DataTable.of(rows)


def summary(report: Report) -> tuple[Part, ...]:
    """The same for a summary: pull-off forces and outcomes, work left out, and what did not pass."""
    solvers = tuple(dict.fromkeys(name for scene in report.scenes for name in scene.runs))
    left_out = tuple(f"{scene.case.name}: {skipped_work(scene)}" for scene in report.scenes)
    parts: tuple[Part, ...] = (
        Paragraph(f"{report.wall_seconds:.0f} s on {report.environment['processor']}."),
        DataTable.of(_line(scene, solvers) for scene in report.scenes),
        Paragraph("Left out, by the counters of work:"),
        Bullets(left_out),
    )
    if report.failures:
        parts += (Section("Not passed", (checks.table(report.failures, with_scene=True),)),)
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
