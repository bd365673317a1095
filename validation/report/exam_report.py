"""The report of an exam in its forms: HTML, Markdown, JSON, JUnit."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from validation.exam.judge import CodeOnScene, GradedAnswer, Judgement
from validation.execution.environment import stamp
from validation.execution.files import to_json, write_whole
from validation.report import html, junit, markdown
from validation.report.document import Document, Paragraph, figures_of
from validation.report.report_folder import EXAM
from validation.report.sections import environment, exam

FORMAT = 1
TITLE = "crosscontact exam"


def page(judgement: Judgement, wall_seconds: float) -> Document:
    """Everything, with figures."""
    parts = [exam.overview(judgement), *map(exam.section, judgement.scenes)]
    parts.append(environment.section(stamp(), wall_seconds))
    return Document(TITLE, (exam.lead(judgement), Paragraph(exam.EXPLAINED)), tuple(parts))


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
        "code": one.code,
        "verdict": one.verdict,
        "kind": str(one.kind),
        "passed": one.passed,
        "reason": one.reason,
        "griffith_limit": None if one.track is None else asdict(one.track),
        "answers": [_answer(graded) for graded in one.answers],
    }


def _answer(graded: GradedAnswer) -> dict[str, Any]:
    header, grade = graded.answer.header, graded.grade
    stated = {name: value for name, value in asdict(header).items() if name != "problem"}
    return stated | {
        "file": graded.answer.file,
        "decade": graded.decade,
        "unreadable": graded.answer.problem or None,
        "told": [] if grade is None else list(grade.remarks),
        "differences": [] if grade is None else [asdict(one) for one in grade.differences],
    }


def write(judgement: Judgement, folder: Path, wall_seconds: float) -> None:
    """Write ``index.html``, ``exam.md``, ``exam.json``, ``junit.xml`` and ``figures/``, the page last."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "index.html").unlink(missing_ok=True)
    document = page(judgement, wall_seconds)
    write_whole(folder / EXAM, to_json(data(judgement)))
    suites = [
        junit.CheckSuite(code, [check for check in judgement.checks if check.solver == code])
        for code in judgement.codes
    ]
    write_whole(folder / "junit.xml", junit.text(TITLE, suites, wall_seconds))
    write_whole(folder / "exam.md", markdown.text(document))
    for figure in figures_of(document.parts):
        for name, picture in figure.files.items():
            (folder / "figures").mkdir(exist_ok=True)
            write_whole(folder / "figures" / name, picture)
    write_whole(folder / "index.html", html.text(document))
