"""The verdicts of an exam: codes side by side, then a section for each scene."""

from __future__ import annotations

from collections.abc import Iterator

from validation.exam.grading import BALANCE, Difference
from validation.exam.judge import CodeOnScene, GradedAnswer, Judgement, SceneJudgement
from validation.exam.tags import tags
from validation.report.document import (
    ABSENT,
    Bullets,
    DataTable,
    Figure,
    Figures,
    Fold,
    LinkCell,
    Paragraph,
    Part,
    Record,
    Section,
    VerdictCell,
    counted,
    formatted,
    plain,
)
from validation.report.figures import exam_chart
from validation.report.pictures import valid_id, with_drawing

EXPLAINED = (
    "An answer passes at 1e-k if every number and curve it gives differs from the reference by no more than "
    "1e-k, or than what the reference estimates its own error there to be; places of a maximum and states at "
    "a limit point count squared. At least 1e-2 is asked for. What an answer does not give is not judged. Of "
    "several answers of a code to a scene the best one counts; all stay in tables and figures."
)


def lead(judgement: Judgement) -> Paragraph:
    """How many verdicts, and how many failed."""
    checks = judgement.checks
    failed = sum(not check.passed for check in checks)
    verdict = f"{failed} failed" if failed else "all passed"
    return Paragraph(
        f"{counted(len(judgement.codes), 'code')} on {counted(len(judgement.scenes), 'scene')}, "
        f"{counted(len(checks), 'verdict')} on answers: {verdict}.",
        not failed,
    )


def overview(judgement: Judgement) -> Section:
    """A row for each scene, a column for each code."""
    rows = (
        {"scene": LinkCell(one.case.name, anchor(one))}
        | {verdict.code: _cell(verdict) for verdict in one.verdicts}
        for one in judgement.scenes
    )
    parts: tuple[Part, ...] = (DataTable.of(rows), DataTable.of(_totals(judgement)))
    if judgement.remarks:
        parts += (Paragraph("Told of the files:"), Bullets(judgement.remarks))
    return Section("Verdicts", parts)


def _totals(judgement: Judgement) -> Iterator[Record]:
    for code in judgement.codes:
        kinds = [one.passed for scene in judgement.scenes for one in scene.verdicts if one.code == code]
        decades = [
            one.best.decade
            for scene in judgement.scenes
            for one in scene.verdicts
            if one.code == code and one.best is not None
        ]
        least = min(decades, default=0)
        yield {
            "code": code,
            "passed": str(kinds.count(True)),
            "failed": str(kinds.count(False)),
            "declined or no answer": str(kinds.count(None)),
            "least decade": f"1e-{least}" if least else ABSENT,
        }


def section(scene: SceneJudgement) -> Section:
    """All answers to a scene, the figure of error against run time, and every difference."""
    short = answers(scene)
    folds = tuple(
        Fold(_titled(one, graded), (_differences(graded),))
        for one in scene.verdicts
        for graded in one.answers
    )
    return Section(short.title, (*short.parts, *folds), short.anchor)


def answers(scene: SceneJudgement) -> Section:
    """The same without the single differences."""
    parts: list[Part] = [Paragraph(f"Tags: {', '.join(tags(scene.case.scene))}.")]
    rows = [_row(graded) for one in scene.verdicts for graded in one.answers]
    if rows:
        parts.append(DataTable.of(rows))
    others = [f"{one.code}: {one.verdict} ({one.reason})" for one in scene.verdicts if one.reason]
    if others:
        parts.append(Bullets(tuple(others)))
    drawing = exam_chart.draw(scene)
    if drawing is not None:
        name = f"exam-{valid_id(scene.case.name)}"
        caption = f"{scene.case.name}: error against stated run time"
        files = exam_chart.files(drawing, name)
        parts.append(Figures((with_drawing(Figure(name, caption, files=files), drawing),)))
    return Section(scene.case.scene.title or scene.case.name, tuple(parts), anchor(scene))


def anchor(scene: SceneJudgement) -> str:
    """Where the section is found in a page."""
    return f"exam-scene-{valid_id(scene.case.name)}"


def _cell(verdict: CodeOnScene) -> VerdictCell:
    return VerdictCell(verdict.verdict, verdict.passed)


def _titled(verdict: CodeOnScene, graded: GradedAnswer) -> str:
    size = graded.answer.header.resolution
    return f"All differences: {verdict.code}{f', resolution {size}' if size else ''}"


def _row(graded: GradedAnswer) -> Record:
    header, grade = graded.answer.header, graded.grade
    worst = None if grade is None else grade.worst
    reached = VerdictCell(f"1e-{graded.decade}" if graded.decade else "none", None)
    if grade is None:
        reached = VerdictCell("cannot be read", False)
    return {
        "code": header.label,
        "resolution": header.resolution or ABSENT,
        "seconds": formatted(header.seconds, ".3g"),
        "F(t)": formatted(None if grade is None else grade.error("force, curve"), ".1e"),
        "a(t)": formatted(None if grade is None else grade.error("contact_radius, curve"), ".1e"),
        "energy balance": formatted(None if grade is None else grade.error(BALANCE), ".1e"),
        "worst": ABSENT if worst is None else f"{plain(worst.quantity)}: {abs(worst.error):.1e}",
        "decade": reached,
        "told": "; ".join(grade.remarks) if grade is not None and grade.remarks else ABSENT,
        "author": header.author or ABSENT,
    }


def _differences(graded: GradedAnswer) -> DataTable:
    found: tuple[Difference, ...] = () if graded.grade is None else graded.grade.differences
    return DataTable.of(
        {
            "quantity": plain(one.quantity),
            "difference": f"{one.error:+.1e}",
            "reference known to": f"{one.known_to:.1e}",
            "counts as": f"{one.counted:.1e}",
            "note": one.note or ABSENT,
        }
        for one in sorted(found, key=lambda one: -one.counted)
    )
