"""``crosscontact judge``: grade the traces of other codes against the reference."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from crosscontact.commands import shared
from validation.exam.answer import read_folder
from validation.exam.judge import judge_folder, lead, overview, write
from validation.report import terminal
from validation.runs.folder import claim, output_folder
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.runs.store import Store


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Folders of the answers and of the report."""
    command.add_argument("folder", metavar="DIR", help="holds answers: SCENE/trace.csv at any depth")
    command.add_argument("--out", metavar="REPORT", help="write page, Markdown, JSON and JUnit there")
    shared.run_options(command)


def run(options: argparse.Namespace, jobs: int) -> int:
    """Judge everything in a folder and print the verdicts; 1 if an answer failed."""
    found = read_folder(Path(options.folder))
    target = None if options.out is None else output_folder(options.out)
    if target is not None:
        claim(target, "verdicts on an exam", {}, fresh=options.fresh)
    store = Store(target, options.fresh)
    with (
        Progress("judge") as progress,
        shared.telling_what_is_kept(target, store),
        processes(min(jobs, len(found.cases))) as executor,
    ):
        progress.phase("reference")
        judgement = judge_folder(found, executor, store, progress)
    print(terminal.text(overview(judgement)))
    print(lead(judgement).text)
    if target is not None:
        write(judgement, target, store.seconds)
        store.clear()
        print(f"written to {target / 'index.html'}")
    sys.stdout.flush()
    return shared.failed(
        [
            f"failed: {check.scene}: {check.solver}: {check.note}"
            for check in judgement.checks
            if not check.passed
        ]
    )
