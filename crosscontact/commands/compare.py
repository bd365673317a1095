"""``crosscontact compare``: several solvers on the given scenes, one table with error estimates."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from crosscontact.commands.failures import exit_code
from crosscontact.commands.interruption import telling_what_is_kept
from crosscontact.commands.refusals import load_taken
from validation.compare.suite import all_pairs
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.report import terminal
from validation.report.build import build
from validation.report.report_folder import REPORT, check_report_unused
from validation.report.sections.scene import verdicts
from validation.report.write import write
from validation.solvers import SOLVERS


def run(
    names: Sequence[str],
    solvers: Sequence[str] | None,
    out: str | None,
    jobs: int,
    fresh: bool = False,
    *,
    max_steps: int | None = None,
) -> int:
    """Compare and print.

    Parameters
    ----------
    names : sequence of str
        Scene files or names of built-in scenes.
    solvers : sequence of str or None
        Names, the reference among them; ``None``: all for which a scene does not take too long.
    out : str or None
        Folder of the report, if one is to be written.
    jobs : int
        Processes.
    fresh : bool
        Whether runs stored by an earlier, interrupted command are ignored, and what the folder holds is
        replaced.
    max_steps : int or None
        Of every run, accepted and rejected together; ``None``: the solver's own bound.

    Returns
    -------
    int
        2 if all solvers refuse a scene, else 1 if solvers disagree.

    Raises
    ------
    SceneError
        If all solvers refuse a scene, as far as that is told without solving it, or the folder holds
        results on another scene, of another command or another program.
    """
    loaded = load_taken(names, lambda case: [SOLVERS[name] for _, name in all_pairs([case], solvers)])
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        check_report_unused(folder, REPORT, loaded)
    pairs = all_pairs(loaded, solvers)
    store = Store(folder, fresh)
    with telling_what_is_kept(folder, store), processes(min(jobs, len(pairs))) as executor:
        progress = Progress("compare")
        progress.phase("runs")
        result = build(
            "compare", loaded, executor, progress, store=store, solvers=solvers, max_steps=max_steps
        )
        refused = [scene for scene in result.scenes if all(run.refused for run in scene.runs.values())]
        for scene in refused:
            reason = next(iter(scene.runs.values())).failure
            print(f"crosscontact: error: {scene.case.name}: {reason}", file=sys.stderr)
        if len(refused) == len(result.scenes):
            return 2
        for scene in result.scenes:
            print(terminal.text(verdicts(scene)))
        if folder is not None:
            with Progress("compare") as writing:
                writing.phase("drawing and writing")
                write(result, folder, executor, writing)
            store.clear()
            print(f"written to {folder / 'index.html'}")
    code = exit_code(result.failures)
    return 2 if refused else code
