"""All statements of the paper in its order, their verdicts, and the paper's figures redrawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from validation.claims import cycles, retractions
from validation.claims.claim import Claim, Finding, Verdict
from validation.claims.evidence import Evidence
from validation.claims.paper_figures import FIGURES, draw_figure
from validation.drawing.figure import png
from validation.report import document as doc
from validation.report.report import Chapter

CLAIMS = tuple(one for room in (cycles, retractions) for one in vars(room).values() if isinstance(one, Claim))
TITLE = "What the paper says"
COUNTED = dict(zip(Verdict, ("hold", "hold in part", "do not hold", "could not be judged"), strict=True))
EXPLAINED = (
    "Statements of the paper, paraphrased, each judged on boundary-element runs (and on the reference "
    "where it says so). A statement that does not hold as worded is a finding, not a failed check; a "
    "verdict that is no longer the recorded one is. Within a line, NOT marks what does not hold. The "
    "process zone has the paper's length, 0.013 R, and is part of the model: the elastic pull-off force "
    "is then 1.027 (soft) to 1.058 (stiff) times that of JKR."
)


def findings(evidence: Evidence) -> tuple[Finding, ...]:
    """Every claim judged on the same runs."""
    return tuple(one.finding(evidence) for one in CLAIMS)


def chapter(found: Sequence[Finding], evidence: Evidence) -> Chapter:
    """Figures and every statement; in short the count, and whatever does not simply hold."""
    said, figures = doc.Paragraph(in_words(found)), doc.Figures(tuple(_figures(evidence)))
    notable = (one for one in found if one.verdict is not Verdict.HOLDS or one.changed)
    whole = doc.Section(
        TITLE, (said, doc.Paragraph(EXPLAINED), figures, doc.DataTable.of(map(cells, found))), "claims"
    )
    return Chapter(
        "claims",
        [one.check for one in found],
        (whole,),
        (doc.Section(TITLE, (said, doc.DataTable.of(map(cells, notable)))),),
        {"claims": list(map(data, found))},
        outputs=[f"{one.verdict}: {one.wording} Found: {one.shown}" for one in found],
    )


def data(finding: Finding) -> dict[str, Any]:
    """A finding in ``report.json``."""
    shown = {"verdict": str(finding.verdict), "changed": finding.changed, "found": finding.shown}
    return asdict(finding) | shown


def in_words(found: Sequence[Finding]) -> str:
    """How many statements hold, and how many not."""
    counts = ((sum(one.verdict is verdict for one in found), text) for verdict, text in COUNTED.items())
    verdicts = ", ".join(f"{count} {text}" for count, text in counts if count)
    changed = sum(one.changed for one in found)
    changes = f"{changed or 'no'} verdict{'s' if changed > 1 else ''}"
    return f"{doc.counted(len(found), 'statement')}: {verdicts}; {changes} changed."


def _figures(evidence: Evidence) -> list[doc.Figure]:
    figures = []
    for paper in FIGURES:
        drawing = draw_figure(paper, evidence)
        files = {} if drawing is None else {f"{paper.name}.png": png(drawing)}
        figure = doc.Figure(f"paper-{paper.name}", paper.caption, wide=paper.wide, files=files)
        figures.append(doc.with_drawing(figure, drawing))
    return figures


def cells(finding: Finding) -> doc.Record:
    verdict = str(finding.verdict) + (f" (recorded: {finding.recorded})" if finding.changed else "")
    passed = False if finding.changed else True if finding.verdict is Verdict.HOLDS else None
    return {
        "verdict": doc.VerdictCell(verdict, passed),
        "place in the paper": finding.place,
        "what it says": finding.wording,
        "what was found": finding.shown,
    }
