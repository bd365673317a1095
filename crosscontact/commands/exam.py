"""``crosscontact exam``: export scenes for other codes, answer them by solvers of ours, reproduce a trace."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from contact_scene import SceneError
from contact_scene.errors import shown
from validation.exam.answer_folder import listed_cases
from validation.exam.export import exam_cases, export_reference, export_scenes
from validation.exam.judge import reference_runs
from validation.exam.own_answers import ANSWERS, answer_all, reproduce
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.report.document import counted


def export(folder: str, suite: str, with_reference: bool, jobs: int) -> int:
    """Write the scenes of a suite.

    Parameters
    ----------
    folder, suite, with_reference
        As of :func:`crosscontact.exam.export_exam`.
    jobs : int
        Processes.

    Returns
    -------
    int
        1 if the reference has no answer to a scene.
    """
    target, cases = output_folder(folder, "DIR"), exam_cases(suite)
    export_scenes(target, cases)
    code = 0
    if with_reference:
        progress = Progress("exam export")
        try:
            with processes(min(jobs, len(cases))) as executor:
                runs = reference_runs(cases, executor, progress=progress)
        except KeyboardInterrupt:
            kept = f"{target} holds the scenes; answers of the reference are kept only when all are done"
            print(f"crosscontact: {kept}", file=sys.stderr)
            raise
        finally:
            progress.close()
        export_reference(target, cases, runs)
        for run in runs.values():
            if not run.finished:
                print(f"failed: {run.scene}: {run.ending}", file=sys.stderr)
                code = 1
    print(f"{counted(len(cases), 'scene')} in {target}: see {target / 'README.md'}")
    return code


def answer(folder: str, solvers: Sequence[str], resolutions: Sequence[int | None], jobs: int) -> int:
    """Answer an exported exam by registered solvers.

    Parameters
    ----------
    folder : str
        Of the exam.
    solvers : sequence of str
        Names.
    resolutions : sequence of int or None
        ``None``: the solver's choice.
    jobs : int
        Processes; run times are those of a quiet machine with one only.

    Returns
    -------
    int
        1 if a run broke down.
    """
    target = Path(folder)
    cases = listed_cases(target)
    progress = Progress("exam answer")
    try:
        with processes(jobs) as executor:
            failed = answer_all(target, cases, solvers, resolutions, executor, progress)
    except KeyboardInterrupt:
        print("crosscontact: answers are kept only when all are done", file=sys.stderr)
        raise
    finally:
        progress.close()
    for run in failed:
        print(f"failed: {run.scene}: {run.solver}: {run.failure or run.ending}", file=sys.stderr)
    print(f"written to {target / ANSWERS}")
    return 1 if failed else 0


def again(file: str) -> int:
    """Compute a trace again from its header alone; 1 if it is not the same bit for bit."""
    path = Path(file)
    if not os.path.isfile(path):
        raise SceneError("FILE", f"got {shown(file)}", "a trace with its header, such as reference.csv")
    found = reproduce(path)
    if found.same:
        print(f"{path}: the same bit for bit, {counted(found.rows, 'row')}")
        return 0
    differs = f"largest difference {found.largest:.2g}"
    if found.rows != found.rows_again:
        differs = f"{counted(found.rows_again, 'row')} instead of {found.rows}"
    print(f"{path}: {differs}", file=sys.stderr)
    return 1
