"""The report of an exam: codes side by side, a section for each scene, a chart of error against run time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.drawing import export
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import DASHES, INK, MARKERS, SERIES
from validation.exam.grading import BALANCE, Grade, counted
from validation.exam.judge import CodeOnScene, Judgement, SceneJudgement
from validation.exam.tags import tags
from validation.report import document, junit, markdown, report
from validation.report.document import (
    ABSENT,
    Bullets,
    DataTable,
    Document,
    Figure,
    Figures,
    Fold,
    LinkCell,
    Paragraph,
    Part,
    Record,
    Section,
    VerdictCell,
    formatted,
    plain,
    valid_id,
    with_drawing,
)
from validation.report.report import Chapter
from validation.report.tables import environment
from validation.runs.files import to_json
from validation.runs.provenance import stamp
from validation.runs.report_folder import EXAM

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

FORMAT = 1
TITLE = "crosscontact exam"
EXPLAINED = (
    "An answer passes at 1e-k if every number and curve it gives differs from the reference by no more than "
    "1e-k, or than what the reference estimates its own error there to be; places of a maximum and states at "
    "a limit point count squared. At least 1e-2 is asked for. What an answer does not give is not judged. Of "
    "several answers of a code to a scene the best one counts; all stay in tables and figures."
)
LEAST = 1e-12
"""Smallest error drawn: below it an answer is the run it is graded against, or prescribes the quantity."""


def lead(judgement: Judgement) -> Paragraph:
    """How many verdicts, and how many failed."""
    checks = judgement.checks
    failed = sum(not check.passed for check in checks)
    codes, scenes = (
        document.counted(len(x), n) for x, n in ((judgement.codes, "code"), (judgement.scenes, "scene"))
    )
    verdicts, ended = document.counted(len(checks), "verdict"), f"{failed} failed" if failed else "all passed"
    return Paragraph(f"{codes} on {scenes}, {verdicts} on answers: {ended}.", not failed)


def overview(judgement: Judgement) -> Section:
    """A row for each scene, a column for each code."""
    rows = (
        {"scene": LinkCell(one.case.name, _anchor(one))}
        | {found.code: VerdictCell(found.verdict, found.passed) for found in one.verdicts}
        for one in judgement.scenes
    )
    parts: tuple[Part, ...] = (DataTable.of(rows), DataTable.of(_totals(judgement)))
    if judgement.remarks:
        parts += (Paragraph("Told of the files:"), Bullets(judgement.remarks))
    return Section("Verdicts", parts)


def _totals(judgement: Judgement) -> Iterator[Record]:
    for code in judgement.codes:
        verdicts = [one for scene in judgement.scenes for one in scene.verdicts if one.code == code]
        kinds = [one.passed for one in verdicts]
        least = min((one.best.decade for one in verdicts if one.best is not None), default=0)
        yield {
            "code": code,
            "passed": str(kinds.count(True)),
            "failed": str(kinds.count(False)),
            "declined or no answer": str(kinds.count(None)),
            "least decade": f"1e-{least}" if least else ABSENT,
        }


def _section(scene: SceneJudgement) -> Section:
    """All answers to a scene, the figure of error against run time, and every difference."""
    name, graded = scene.case.name, [one for verdict in scene.verdicts for one in verdict.answers]
    parts: list[Part] = [Paragraph(f"Tags: {', '.join(tags(scene.case.scene))}.")]
    if graded:
        parts.append(DataTable.of(map(_row, graded)))
    others = [f"{one.code}: {one.verdict} ({one.reason})" for one in scene.verdicts if one.reason]
    if others:
        parts.append(Bullets(tuple(others)))
    drawing = _drawn(scene)
    if drawing is not None:
        figure = f"exam-{valid_id(name)}"
        files = {f"{figure}.png": export.png(drawing), f"{figure}.svg": export.svg_file(drawing)}
        shown = Figure(figure, f"{name}: error against stated run time", files=files)
        parts.append(Figures((with_drawing(shown, drawing),)))
    folds = (Fold(_titled(one), (_differences(one),)) for one in graded)
    return Section(scene.case.scene.title or name, (*parts, *folds), _anchor(scene))


def _anchor(scene: SceneJudgement) -> str:
    return f"exam-scene-{valid_id(scene.case.name)}"


def _titled(grade: Grade) -> str:
    header = grade.answer.header
    return f"All differences: {header.code}{f', resolution {header.resolution}' if header.resolution else ''}"


def _row(grade: Grade) -> Record:
    header, worst = grade.answer.header, grade.worst
    reached = VerdictCell(f"1e-{grade.decade}" if grade.decade else "none", None)
    errors = {"F(t)": "force, curve", "a(t)": "contact_radius, curve", "energy balance": BALANCE}
    return {
        "code": header.label,
        "resolution": header.resolution or ABSENT,
        "seconds": formatted(header.seconds, ".3g"),
        **{title: formatted(grade.error(quantity), ".1e") for title, quantity in errors.items()},
        "worst": ABSENT if worst is None else f"{plain(worst.quantity)}: {abs(worst.error):.1e}",
        "decade": VerdictCell("cannot be read", False) if grade.answer.problem else reached,
        "told": "; ".join(grade.remarks) or ABSENT,
        "author": header.author or ABSENT,
    }


def _differences(grade: Grade) -> DataTable:
    return DataTable.of(
        {
            "quantity": plain(one.quantity),
            "difference": f"{one.error:+.1e}",
            "reference known to": f"{one.known_to or 0.0:.1e}",
            "counts as": f"{counted(one):.1e}",
            "note": one.note or ABSENT,
        }
        for one in sorted(grade.differences, key=lambda one: -counted(one))
    )


def _drawn(scene: SceneJudgement) -> Drawing | None:
    """Error against stated run time, a line for each code, answers that fail crossed; ``None`` if none is."""
    controls = {step.kind for step in scene.case.scene.loading.steps}
    prescribed = controls and controls <= {"force", "force-ramp"}
    quantity, symbol = ("contact_radius, curve", "a(t)") if prescribed else ("force, curve", "F(t)")
    lines = [_points(one, quantity) for one in scene.verdicts]
    if not any(lines):
        return None
    from matplotlib.figure import Figure as Drawing
    from matplotlib.ticker import NullFormatter

    drawing = Drawing(figsize=(1.4 * SIZE[0], SIZE[1]), layout="constrained")
    axes = drawing.add_subplot(xscale="log", yscale="log")
    for index, (one, points) in enumerate(zip(scene.verdicts, lines, strict=True)):
        if not points:
            continue
        colour = SERIES[index % len(SERIES)]  # a code has the same on every scene
        seconds, errors, passed = zip(*points, strict=True)
        style = {"color": colour, "linestyle": DASHES[index % len(DASHES)], "linewidth": 1.2}
        marker = MARKERS[index % (len(MARKERS) - 1)]
        axes.plot(seconds, errors, label=one.code, marker=marker, markersize=5, **style)
        failed = np.where(passed, np.nan, errors)
        axes.plot(seconds, failed, linestyle="none", marker="x", markersize=9, color=colour)
    axes.axhline(1e-2, color=INK, linewidth=0.7, linestyle=(0, (2, 3)))
    axes.set_xlabel("stated run time (s)")
    axes.set_ylabel(f"relative error of {symbol}")
    format_axes(axes)
    for axis in (axes.xaxis, axes.yaxis):  # labels between the decades would run into each other
        axis.set_minor_formatter(NullFormatter())
    low, high = np.log10(axes.get_xlim())
    axes.set_xlim(10.0 ** np.floor(low), 10.0 ** np.ceil(high))
    axes.legend(
        loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize="small", labelcolor=INK
    )
    return drawing


def _points(one: CodeOnScene, quantity: str) -> list[tuple[float, float, bool]]:
    """Seconds, error and whether it passed, of every answer that states its run time, fastest first."""
    found = ((grade.answer.header.seconds, grade.error(quantity), grade.passed) for grade in one.answers)
    return sorted((x, y, good) for x, y, good in found if x and y and LEAST < y < float("inf"))


def data(judgement: Judgement) -> dict[str, Any]:
    """``exam.json``: every number."""
    return {
        "format": FORMAT,
        "environment": stamp(),
        "remarks": list(judgement.remarks),
        "scenes": [
            {
                "name": scene.case.name,
                "reference_errors": None if scene.reference is None else scene.reference.errors,
                "verdicts": [_verdict(one) for one in scene.verdicts],
            }
            for scene in judgement.scenes
        ],
    }


def _verdict(one: CodeOnScene) -> dict[str, Any]:
    return {
        **{name: getattr(one, name) for name in ("code", "verdict", "kind", "passed", "reason")},
        "griffith_limit": None if one.track is None else asdict(one.track),
        "answers": [_answer(grade) for grade in one.answers],
    }


def _answer(grade: Grade) -> dict[str, Any]:
    stated = {name: value for name, value in vars(grade.answer.header).items() if name != "problem"}
    return stated | {
        "file": grade.answer.file,
        "decade": grade.decade,
        "unreadable": grade.answer.problem or None,
        "told": grade.remarks,
        "differences": [
            {"quantity": one.quantity, "error": one.error, "known_to": one.known_to or 0.0, "note": one.note}
            for one in grade.differences
        ],
    }


def write(judgement: Judgement, folder: Path, wall_seconds: float) -> None:
    """Write ``index.html``, ``exam.md``, ``exam.json``, ``junit.xml`` and ``figures/``, the page last."""
    parts = [overview(judgement), *map(_section, judgement.scenes), environment(stamp(), wall_seconds)]
    page = Document(TITLE, (lead(judgement), Paragraph(EXPLAINED)), tuple(parts))
    codes = [
        Chapter(code, [check for check in judgement.checks if check.solver == code])
        for code in judgement.codes
    ]
    texts = {
        EXAM: to_json(data(judgement)),
        "junit.xml": junit.text(TITLE, codes, wall_seconds),
        "exam.md": markdown.text(page),
    }
    report.write(folder, page, texts)
