"""``crosscontact judge``: grade the traces of other codes against the reference."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from crosscontact.commands import shared
from crosscontact.commands.shared import value
from validation.exam import judge
from validation.exam.answer import read_folder
from validation.report.texts import for_terminal
from validation.runs.pool import processes
from validation.runs.progress import Progress

OPTIONS = {
    "folder": value("DIR", "holds answers: SCENE/trace.csv at any depth"),
    "--out": value("REPORT", "write page, Markdown, JSON and JUnit there"),
    **shared.jobs(),
    **shared.FRESH,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Judge everything in a folder and print the verdicts; 1 if an answer failed."""
    found = read_folder(Path(options.folder))
    with (
        Progress("judge", "reference") as progress,
        shared.long_work("judge", options, "verdicts on an exam") as work,
        processes(min(jobs, len(found.cases))) as executor,
    ):
        judgement = judge.judge_folder(found, executor, work.store, progress)
        print(for_terminal(judge.overview(judgement)))
        print(judge.lead(judgement).text)
        work.write(lambda folder, writing: judge.write(judgement, folder, work.store.seconds))
    sys.stdout.flush()
    failures = [check for check in judgement.checks if not check.passed]
    return shared.failed([f"failed: {check.scene}: {check.solver}: {check.note}" for check in failures])
