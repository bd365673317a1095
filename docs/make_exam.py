"""Put the solvers of this program and its peers to the exam and write how they do.

``python docs/make_exam.py [FOLDER]`` writes ``docs/how-to/exam-results.md`` and the figures it shows; FOLDER
keeps the answers and the whole report. Takes about ten minutes on a core.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import crosscontact as cc
from crosscontact.cli import main
from validation.exam.export import exam_cases, export_scenes
from validation.exam.judge import Judgement
from validation.report import markdown
from validation.report.document import Document, Paragraph
from validation.report.figures import exam_chart
from validation.report.sections import exam as sections
from validation.solvers import PEERS
from validation.solvers.peers.peer import EXTRA

HOW_TO = Path(__file__).parent / "how-to"
RESOLUTIONS = {
    "bem": (4, 8),
    "fem": (4, 8),
    "reference": (4, 8),
    "tamaas": (32, 64, 128),
    "contact-mechanics": (16, 24, 32, 48),
    "adhesion-jkr": (400,),
    "maugis-dugdale": (5, 10, 20, 40),
}
"""By solver; each in its own terms."""
SCENES = ("adhesionless-force", "elastic-press", "elastic-relaxed")
"""Those that a peer answers."""
NOTE = (
    "Computed by `python docs/make_exam.py`, one process. Run times are those of the machine at that time. "
    "The reference that grades has twice its default resolution."
)


def page(judgement: Judgement) -> str:
    """Verdicts and all answers."""
    parts = [sections.overview(judgement)]
    parts += [sections.answers(one) for one in judgement.scenes]
    lead = (sections.lead(judgement), Paragraph(NOTE))
    return markdown.text(Document("How solvers and peers do in the exam", lead, tuple(parts)))


def write(folder: Path) -> None:
    """Export, answer, judge, write."""
    export_scenes(folder, [case for case in exam_cases("quick") if case.name in SCENES])
    for solver, sizes in RESOLUTIONS.items():
        if solver in PEERS and not PEERS[solver].installed:
            sys.exit(f"{solver} is not installed: {EXTRA}")
        main(["exam", "answer", str(folder), "--solvers", solver, "--resolution", *map(str, sizes)])
    judgement = cc.judge(folder, folder / "report")
    (HOW_TO / "exam-results.md").write_text(page(judgement), encoding="utf-8")
    for one in judgement.scenes:
        drawing = exam_chart.draw(one)
        if drawing is not None:
            files = exam_chart.files(drawing, f"exam-{one.case.name}")
            (HOW_TO / "figures").mkdir(exist_ok=True)
            (HOW_TO / "figures" / f"exam-{one.case.name}.png").write_bytes(files[f"exam-{one.case.name}.png"])


if __name__ == "__main__":
    if len(sys.argv) > 1:
        write(Path(sys.argv[1]))
    else:
        with tempfile.TemporaryDirectory() as made:
            write(Path(made))
