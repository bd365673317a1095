"""``crosscontact exam``: export scenes for other codes, answer them by solvers of ours, reproduce a trace."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from contact_scene import SceneError
from contact_scene.errors import shown
from crosscontact import arguments
from crosscontact.commands import shared
from crosscontact.commands.shared import flag, value
from validation.exam.own_answers import ANSWERS, answer_all, export_reference, reproduce
from validation.exam.question import exam_cases, export_scenes, listed_cases
from validation.report.document import counted
from validation.runs.folder import claim, output_folder
from validation.runs.pool import processes
from validation.runs.progress import Progress
from validation.scenes import SUITES


def _known(names: list[str]) -> tuple[str, ...]:
    for name in names:
        arguments.check_solver(name, "", arguments.selectable())
    return tuple(dict.fromkeys(names))


FOLDER = {"folder": {"metavar": "DIR"}}
ACTIONS = {
    "export": (
        "write a folder for each scene: TOML, JSON, a page in words",
        {
            **FOLDER,
            "--suite": {"choices": SUITES, "default": "quick"},
            "--with-reference": flag(
                "write the reference's trace and measures with their errors beside each scene"
            ),
            **shared.jobs(),
        },
    ),
    "answer": (
        "answer an exported exam by registered solvers",
        {
            **FOLDER,
            "--solvers": value("A,B", "peers included", type=shared.comma_separated(_known), required=True),
            **shared.resolution(
                "one answer for each; default: the solver's choice", nargs="+", default=[None]
            ),
            **shared.jobs("processes; default: 1, so that run times are not those of a busy machine"),
        },
    ),
    "reproduce": (
        "compute a trace again from its header alone",
        {"file": value("FILE", "such as DIR/SCENE/reference.csv")},
    ),
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Export scenes, answer them, or reproduce a trace."""
    if options.action == "export":
        return _export(options, jobs)
    return _answer(options) if options.action == "answer" else _reproduce(options.file)


def _export(options: argparse.Namespace, jobs: int) -> int:
    """Write the scenes of a suite; 1 if the reference has no answer to one."""
    target, cases = output_folder(options.folder, "DIR"), exam_cases(options.suite)
    claim(target, "an exam", {}, "DIR")
    export_scenes(target, cases)
    failures = []
    if options.with_reference:
        try:
            with Progress("exam export") as progress, processes(min(jobs, len(cases))) as executor:
                runs = export_reference(target, cases, executor, progress)
        except KeyboardInterrupt:
            shared.say(f"{target} holds the scenes; answers of the reference are kept only when all are done")
            raise
        failures = [f"failed: {run.scene}: {run.ending}" for run in runs if not run.finished]
    code = shared.failed(failures)
    print(f"{counted(len(cases), 'scene')} in {target}: see {target / 'README.md'}")
    return code


def _answer(options: argparse.Namespace) -> int:
    """Answer an exported exam by registered solvers, by one process unless told; 1 if a run broke down."""
    target = Path(options.folder)
    cases = listed_cases(target)
    try:
        with Progress("exam answer") as progress, processes(options.jobs or 1) as executor:
            failed = answer_all(target, cases, options.solvers, options.resolution, executor, progress)
    except KeyboardInterrupt:
        shared.say("answers are kept only when all are done")
        raise
    code = shared.failed(
        [f"failed: {one.scene}: {one.solver}: {one.failure or one.ending}" for one in failed]
    )
    print(f"written to {target / ANSWERS}")
    return code


def _reproduce(file: str) -> int:
    """Compute a trace again from its header alone; 1 if it is not the same bit for bit."""
    if not os.path.isfile(file):
        raise SceneError("FILE", f"got {shown(file)}", "a trace with its header, such as reference.csv")
    differs, rows = reproduce(Path(file))
    if differs:
        return shared.failed([f"{file}: {differs}"])
    print(f"{file}: the same bit for bit, {counted(rows, 'row')}")
    return 0
