"""``crosscontact compare``: several solvers on the given scenes, one table with error estimates."""

from __future__ import annotations

from collections.abc import Sequence

from crosscontact.commands.failures import exit_code
from validation import cases
from validation.execution.files import output_folder
from validation.execution.progress import Progress
from validation.execution.run_folder import check_unused
from validation.execution.store import Store
from validation.report import terminal
from validation.report.build import build
from validation.report.sections.scene import verdicts
from validation.report.write import write


def run(
    names: Sequence[str], solvers: Sequence[str] | None, out: str | None, jobs: int, fresh: bool = False
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
        Whether runs stored by an earlier, interrupted command are ignored, and another scene's replaced.

    Returns
    -------
    int
        1 if solvers disagree.

    Raises
    ------
    SceneError
        If the folder holds runs on another scene of the same name, or a run of another program.
    """
    loaded = cases.load_all(names)
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        for case in loaded:
            check_unused(folder, case.scene)
            for earlier in (folder / "runs" / case.name).glob("*"):
                check_unused(earlier, case.scene)
    store = Store(folder, fresh)
    progress = Progress("compare")
    progress.phase("runs")
    result = build("compare", loaded, jobs, progress, store=store, solvers=solvers)
    for scene in result.scenes:
        print(terminal.text(verdicts(scene)))
    if folder is not None:
        with Progress("compare") as writing:
            writing.phase("drawing and writing")
            write(result, folder)
        store.clear()
        print(f"written to {folder / 'index.html'}")
    return exit_code(result.failures)
