"""The judgement of a folder of answers: a verdict for every code on every scene, and its report."""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.cases import Case
from validation.drawing.figure import DASHES, INK, MARKERS, SERIES, SIZE, as_files, drawing, format_axes
from validation.exam.answer import AnswerFolder
from validation.exam.grading import BALANCE, COARSEST, Grade, GriffithTrack, counted, grade, griffith_track
from validation.exam.own_answers import reference_runs
from validation.exam.question import tags
from validation.measure.difference import Check
from validation.report import document as doc
from validation.report import report
from validation.report.report import Chapter
from validation.report.tables import environment
from validation.report.texts import markdown
from validation.runs.folder import to_json
from validation.runs.pool import TellProgress
from validation.runs.provenance import stamp
from validation.runs.run import Run
from validation.runs.store import Store

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


@dataclass(frozen=True)
class AnswerVerdict:
    """A code on a scene: its graded answers, the best one last, and what can be said of it.

    ``kind`` is passed, failed, at the Griffith limit, declined or no answer, ``verdict`` the same with more
    words, ``reason`` why it failed or declined; ``passed`` is ``None`` where there is nothing to judge.
    ``griffith_limit`` is the track of a code with a finite range of attraction.
    """

    code: str
    scene: str
    kind: str
    verdict: str
    passed: bool | None = None
    reason: str = ""
    answers: tuple[Grade, ...] = ()
    griffith_limit: GriffithTrack | None = None


@dataclass(frozen=True)
class SceneJudgement:
    """All codes on one scene, and the run of the reference they are graded against, if any answers."""

    case: Case
    reference: Run | None
    verdicts: tuple[AnswerVerdict, ...]


@dataclass(frozen=True)
class Judgement:
    """All scenes; ``remarks`` are lines on files that could not be used."""

    scenes: tuple[SceneJudgement, ...]
    codes: tuple[str, ...]
    remarks: tuple[str, ...]

    @property
    def checks(self) -> list[Check]:
        """A check for every verdict on answers."""
        least = f"passed at 1e-{COARSEST} or better"
        return [
            Check(one.scene, one.code, "verdict", "exam", least, one.verdict, one.passed, note=one.reason)
            for scene in self.scenes
            for one in scene.verdicts
            if one.passed is not None
        ]


def judge_folder(
    folder: AnswerFolder,
    executor: Executor | None = None,
    store: Store | None = None,
    progress: TellProgress | None = None,
) -> Judgement:
    """Judge everything in a folder; the reference is run as of ``run_tasks``."""
    answered = {one.header.scene for one in folder.answers}
    needed = [case for case in folder.cases if case.name in answered]
    runs, remarks, scenes = reference_runs(needed, executor, store, progress), list(folder.remarks), []
    for case in folder.cases:
        base = runs.get(case.name)
        if base is not None and base.curves is None:
            remarks.append(f"{case.name}: not judged: the reference has no answer: {base.ending}")
            continue
        verdicts = tuple(_verdict(folder, code, case, base) for code in folder.codes)
        scenes.append(SceneJudgement(case, base, verdicts))
    remarks += [remark for one in folder.answers for remark in one.remarks]
    return Judgement(tuple(scenes), folder.codes, tuple(remarks))


def _verdict(folder: AnswerFolder, code: str, case: Case, base: Run | None) -> AnswerVerdict:
    answers = [one for one in folder.answers if (one.header.code, one.header.scene) == (code, case.name)]
    if base is None or not answers:
        why = folder.declined.get((code, case.name))
        if why is None:
            return AnswerVerdict(code, case.name, "no answer", "no answer")
        return AnswerVerdict(
            code,
            case.name,
            "declined",
            f"declined {why}" if why.startswith("by tag") else "declined",
            reason=why,
        )
    graded = [grade(one, case.scene, base) for one in answers]
    graded.sort(key=lambda one: (one.decade, -one.counted))
    best, track = graded[-1], griffith_track(answers, case)
    if best.passed:
        kind, verdict, reasons = "passed", f"passed at 1e-{best.decade}", []
    elif track is not None and track.converges:
        kind, reasons = "at the Griffith limit", [track.in_words]
        verdict = "converges to the Griffith limit" if track.points else kind
    else:
        kind = verdict = "failed"
        reasons = [*best.faults, *([] if track is None else [track.in_words])]
    return AnswerVerdict(
        code, case.name, kind, verdict, kind != "failed", "; ".join(reasons), tuple(graded), track
    )


# The report


def lead(judgement: Judgement) -> doc.Paragraph:
    """How many verdicts, and how many failed."""
    checks = judgement.checks
    failed = sum(not check.passed for check in checks)
    codes = doc.counted(len(judgement.codes), "code")
    scenes = doc.counted(len(judgement.scenes), "scene")
    verdicts, ended = doc.counted(len(checks), "verdict"), f"{failed} failed" if failed else "all passed"
    return doc.Paragraph(f"{codes} on {scenes}, {verdicts} on answers: {ended}.", not failed)


def overview(judgement: Judgement) -> doc.Section:
    """A row for each scene, a column for each code; in the last row how many passed and failed."""
    rows: list[doc.Record] = [
        {"scene": doc.LinkCell(one.case.name, _anchor(one))}
        | {found.code: doc.VerdictCell(found.verdict, found.passed) for found in one.verdicts}
        for one in judgement.scenes
    ]
    ends = {
        code: [check.passed for check in judgement.checks if check.solver == code] for code in judgement.codes
    }
    totals = {code: f"{sum(found)}/{len(found)} passed" for code, found in ends.items()}
    parts: tuple[doc.Part, ...] = (doc.DataTable.of([*rows, {"scene": ""} | totals]),)
    if judgement.remarks:
        parts += (doc.Paragraph("Told of the files:"), doc.Bullets(judgement.remarks))
    return doc.Section("Verdicts", parts)


def _section(scene: SceneJudgement) -> doc.Section:
    """All answers to a scene, the figure of error against run time, and every difference."""
    name, graded = scene.case.name, [one for verdict in scene.verdicts for one in verdict.answers]
    parts: list[doc.Part] = [doc.Paragraph(f"Tags: {', '.join(tags(scene.case.scene))}.")]
    if graded:
        parts.append(doc.DataTable.of(map(_row, graded)))
    others = [f"{one.code}: {one.verdict} ({one.reason})" for one in scene.verdicts if one.reason]
    if others:
        parts.append(doc.Bullets(tuple(others)))
    drawing = _drawn(scene)
    if drawing is not None:
        figure = f"exam-{doc.valid_id(name)}"
        caption = f"{name}: error against stated run time"
        shown = doc.Figure(figure, caption, files=as_files(drawing, figure))
        parts.append(doc.Figures((doc.with_drawing(shown, drawing),)))
    folds = (doc.Fold(f"All differences: {one.answer.header.title}", (_differences(one),)) for one in graded)
    return doc.Section(scene.case.scene.title or name, (*parts, *folds), _anchor(scene))


def _anchor(scene: SceneJudgement) -> str:
    return f"exam-scene-{doc.valid_id(scene.case.name)}"


def _row(grade: Grade) -> doc.Record:
    header, worst = grade.answer.header, grade.worst
    reached = doc.VerdictCell(f"1e-{grade.decade}" if grade.decade else "none", None)
    errors = {"F(t)": "force, curve", "a(t)": "contact_radius, curve", "energy balance": BALANCE}
    return {
        "code": f"{header.code} {header.version}",
        "resolution": header.resolution or doc.ABSENT,
        "seconds": doc.formatted(header.seconds, ".3g"),
        **{title: doc.formatted(grade.error(quantity), ".1e") for title, quantity in errors.items()},
        "worst": doc.ABSENT if worst is None else f"{doc.plain(worst.quantity)}: {abs(worst.error):.1e}",
        "decade": doc.VerdictCell("cannot be read", False) if grade.answer.problem else reached,
        "told": "; ".join(grade.remarks) or doc.ABSENT,
        "author": header.author or doc.ABSENT,
    }


def _differences(grade: Grade) -> doc.DataTable:
    return doc.DataTable.of(
        {
            "quantity": doc.plain(one.quantity),
            "difference": f"{one.error:+.1e}",
            "reference known to": f"{one.known_to or 0.0:.1e}",
            "counts as": f"{counted(one):.1e}",
            "note": one.note or doc.ABSENT,
        }
        for one in sorted(grade.differences, key=lambda one: -counted(one))
    )


def _drawn(scene: SceneJudgement) -> Drawing | None:
    """Error against stated run time, a line for each code, answers that fail crossed; ``None`` if none is."""
    controls = {step.kind for step in scene.case.scene.loading.steps}
    prescribed = controls and controls <= {"force", "force-ramp"}
    quantity, symbol = ("contact_radius, curve", "a(t)") if prescribed else ("force, curve", "F(t)")
    lines = [(one.code, _points(one, quantity)) for one in scene.verdicts]
    if not any(points for _, points in lines):
        return None
    from matplotlib.ticker import NullFormatter

    picture, axes = drawing((1.4 * SIZE[0], SIZE[1]))
    axes.set(xscale="log", yscale="log")
    for index, (code, points) in enumerate(lines):
        if not points:
            continue
        colour = SERIES[index % len(SERIES)]  # a code has the same on every scene
        seconds, errors, passed = zip(*points, strict=True)
        style = {"color": colour, "linestyle": DASHES[index % len(DASHES)], "linewidth": 1.2}
        marker = MARKERS[index % (len(MARKERS) - 1)]
        axes.plot(seconds, errors, label=code, marker=marker, markersize=5, **style)
        failed = np.where(passed, np.nan, errors)
        axes.plot(seconds, failed, linestyle="none", marker="x", markersize=9, color=colour)
    axes.axhline(10.0**-COARSEST, color=INK, linewidth=0.7, linestyle=(0, (2, 3)))
    axes.set(xlabel="stated run time (s)", ylabel=f"relative error of {symbol}")
    format_axes(axes)
    for axis in (axes.xaxis, axes.yaxis):  # labels between the decades would run into each other
        axis.set_minor_formatter(NullFormatter())
    low, high = np.log10(axes.get_xlim())
    axes.set_xlim(10.0 ** np.floor(low), 10.0 ** np.ceil(high))
    place: dict[str, Any] = {"loc": "center left", "bbox_to_anchor": (1.01, 0.5), "frameon": False}
    axes.legend(**place, fontsize="small", labelcolor=INK)
    return picture


def _points(one: AnswerVerdict, quantity: str) -> list[tuple[float, float, bool]]:
    """Seconds, error and whether it passed, of every answer that states its run time, fastest first."""
    found = ((grade.answer.header.seconds, grade.error(quantity), grade.passed) for grade in one.answers)
    return sorted((x, y, good) for x, y, good in found if x and y and LEAST < y < float("inf"))


def data(judgement: Judgement) -> dict[str, Any]:
    """``exam.json``: every number."""
    scenes = [
        {
            "name": scene.case.name,
            "reference_errors": None if scene.reference is None else scene.reference.errors,
            "verdicts": [_data_of(one) for one in scene.verdicts],
        }
        for scene in judgement.scenes
    ]
    return {"format": FORMAT, "environment": stamp(), "remarks": judgement.remarks, "scenes": scenes}


def _data_of(one: AnswerVerdict) -> dict[str, Any]:
    answers = []
    for graded in one.answers:
        header = graded.answer.header.stated() | {"problem": None}
        found = {
            "file": graded.answer.file,
            "unreadable": graded.answer.problem or None,
            "told": graded.remarks,
        }
        differences = [asdict(difference) for difference in graded.differences]
        answers.append(header | found | {"decade": graded.decade, "differences": differences})
    track = None if one.griffith_limit is None else asdict(one.griffith_limit)
    return vars(one) | {"griffith_limit": track, "answers": answers}


def write(judgement: Judgement, folder: Path, wall_seconds: float) -> None:
    """Write ``index.html``, ``exam.md``, ``exam.json``, ``junit.xml`` and ``figures/``, the page last."""
    parts = [overview(judgement), *map(_section, judgement.scenes), environment(stamp(), wall_seconds)]
    page = doc.Document(TITLE, (lead(judgement), doc.Paragraph(EXPLAINED)), tuple(parts))
    codes = [
        Chapter(code, [check for check in judgement.checks if check.solver == code])
        for code in judgement.codes
    ]
    texts = {
        "exam.json": to_json(data(judgement)),
        "junit.xml": report.junit(TITLE, codes, wall_seconds),
        "exam.md": markdown(page),
    }
    report.write(folder, page, texts)
