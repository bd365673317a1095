"""``crosscontact study``: refinement ladders and error against run time."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from crosscontact.commands.interruption import telling_what_is_kept
from crosscontact.commands.refusals import load_taken
from validation.execution.files import output_folder
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.report import terminal
from validation.report.report_folder import STUDY, check_report_unused
from validation.report.sections.study import short
from validation.report.write import write_study
from validation.solvers import solvers
from validation.studies.study import study


def run(
    names: Sequence[str], out: str | None, jobs: int, fresh: bool = False, *, max_steps: int | None = None
) -> int:
    """Refine every solver on the given scenes.

    Parameters
    ----------
    names : sequence of str
        Scene files or names of built-in scenes.
    out : str or None
        Folder of the report, if one is to be written.
    jobs : int
        Processes for what is not timed.
    fresh : bool
        Whether levels stored by an earlier, interrupted command are ignored, and what the folder holds does
        not matter.
    max_steps : int or None
        Of every run, accepted and rejected together; ``None``: the solver's own bound.

    Returns
    -------
    int
        1 if a level gave no answer.

    Raises
    ------
    SceneError
        If all solvers refuse a scene, or the folder holds results on another scene, of another command or
        another program.
    """
    loaded = load_taken(names, lambda case: solvers())
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        check_report_unused(folder, STUDY, loaded)
    store = Store(folder, fresh)
    with telling_what_is_kept(folder, store):
        progress = Progress("study")
        progress.phase("runs")
        result = study(loaded, jobs, progress, store, max_steps)
    print(terminal.text(short(result)))
    if folder is not None:
        with Progress("study") as writing:
            writing.phase("drawing and writing")
            write_study(result, folder)
        store.clear()
        print(f"written to {folder / 'index.html'}")
    for scene in result.scenes:
        for ladder, level in scene.failed:
            name = f"{scene.case.name}: {ladder.ladder.scheme}: {ladder.ladder.kind} {level.level.label}"
            print(f"failed: {name}: {level.failure}", file=sys.stderr)
    return 1 if any(scene.failed for scene in result.scenes) else 0
