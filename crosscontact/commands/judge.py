"""``crosscontact judge``: grade the traces of other codes against the reference."""

from __future__ import annotations

import sys
from pathlib import Path

from crosscontact.commands.interruption import telling_what_is_kept
from validation.exam.answer_folder import read_folder
from validation.exam.judge import judge_folder
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.report import exam_report, terminal
from validation.report.exam_report import lead, overview
from validation.report.report_folder import EXAM, check_report_unused


def run(folder: str, out: str | None, jobs: int, fresh: bool = False) -> int:
    """Judge everything in a folder and print the verdicts.

    Parameters
    ----------
    folder : str
        With the answers.
    out : str or None
        Folder of the report, if one is to be written.
    jobs : int
        Processes.
    fresh : bool
        Whether runs stored by an earlier, interrupted command are ignored, and what the folder holds is
        replaced.

    Returns
    -------
    int
        1 if an answer failed.
    """
    found = read_folder(Path(folder))
    target = None if out is None else output_folder(out)
    if target is not None and not fresh:
        check_report_unused(target, EXAM)
    store, progress = Store(target, fresh), Progress("judge")
    progress.phase("reference")
    try:
        with (
            telling_what_is_kept(target, store),
            processes(min(jobs, len(found.cases))) as executor,
        ):
            judgement = judge_folder(found, executor, store, progress)
    finally:
        progress.close()
    print(terminal.text(overview(judgement)))
    print(lead(judgement).text)
    if target is not None:
        exam_report.write(judgement, target, store.seconds)
        store.clear()
        print(f"written to {target / 'index.html'}")
    sys.stdout.flush()
    failed = [check for check in judgement.checks if not check.passed]
    for check in failed:
        print(f"failed: {check.scene}: {check.solver}: {check.note}", file=sys.stderr)
    return 1 if failed else 0
