"""Put the solvers of this program and its peers to the exam and write how they do.

``python docs/make_exam.py [FOLDER] [--scenes A,B]`` writes ``docs/how-to/exam-results.md`` and the figures it
shows; FOLDER keeps the answers and the whole report. With ``--scenes`` only these are answered, and the page
is written into FOLDER. Takes about five minutes on a core of its own.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Collection
from pathlib import Path

import crosscontact as cc
from crosscontact.cli import main
from validation.exam.export import exam_cases, export_scenes
from validation.exam.judge import Judgement
from validation.report import markdown
from validation.report.document import Document, Paragraph
from validation.report.figures import exam_chart
from validation.report.pictures import valid_id
from validation.report.sections import exam as sections
from validation.solvers import PEERS
from validation.solvers.peers.peer import EXTRA

HOW_TO = Path(__file__).parent / "how-to"
RESOLUTIONS = {
    "bem": (4, 8),
    "fem": (4, 8),
    "reference": (4, 6),
    "tamaas": (16, 32, 64),
    "contact-mechanics": (16, 32, 64),
    "adhesion-jkr": (400,),
    "maugis-dugdale": (5, 10, 20, 40),
}
"""By solver; each in its own terms."""
SCENES = (
    "adhesionless-force",
    "cone-pull",
    "cycle-v0.02",
    "dwell-10",
    "elastic-press",
    "elastic-relaxed",
    "fixed-stress-si",
    "force-4",
    "hysteresis-si",
    "pdms-retraction-1um",
    "punch-programme",
    "rated-edge-si",
    "repressed-profile",
    "spring-elastic",
    "three-branches",
)
"""Those that a peer answers, and at least one of every tag."""
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


def write(folder: Path, scenes: Collection[str], target: Path) -> None:
    """Export, answer, judge, and write the page into ``target``."""
    export_scenes(folder, [case for case in exam_cases("full") if case.name in scenes])
    for solver, sizes in RESOLUTIONS.items():
        if solver in PEERS and not PEERS[solver].installed:
            sys.exit(f"{solver} is not installed: {EXTRA}")
        main(["exam", "answer", str(folder), "--solvers", solver, "--resolution", *map(str, sizes)])
    judgement = cc.judge(folder, folder / "report")
    (target / "figures").mkdir(parents=True, exist_ok=True)
    (target / "exam-results.md").write_text(page(judgement), encoding="utf-8")
    for one in judgement.scenes:
        drawing = exam_chart.draw(one)
        if drawing is not None:
            name = f"exam-{valid_id(one.case.name)}"  # as the page links it
            (target / "figures" / f"{name}.png").write_bytes(exam_chart.files(drawing, name)[f"{name}.png"])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", nargs="?", type=Path, metavar="FOLDER")
    parser.add_argument("--scenes", type=lambda text: text.split(","), metavar="A,B")
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        kept = asked.folder or Path(made)
        write(kept, asked.scenes or SCENES, kept if asked.scenes else HOW_TO)
