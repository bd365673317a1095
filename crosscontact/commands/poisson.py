"""``crosscontact study --poisson``: an elastic bulk against a constant Poisson's ratio."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from crosscontact.commands.interruption import telling_what_is_kept
from crosscontact.commands.refusals import load_taken
from validation.execution.files import output_folder
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.execution.store import Store
from validation.report import terminal
from validation.report.report_folder import check_report_unused, poisson_json
from validation.report.sections.poisson import section
from validation.report.write import write_poisson
from validation.solvers import solvers
from validation.studies.poisson import RATIOS, CompressibilityComparison, compare_ratios


def run(
    names: Sequence[str],
    ratios: Sequence[float],
    out: str | None,
    jobs: int,
    resolution: int | None = None,
    fresh: bool = False,
    *,
    max_steps: int | None = None,
) -> int:
    """Compare an elastic bulk with a constant Poisson's ratio.

    Parameters
    ----------
    names : sequence of str
        Scene files or names of built-in scenes.
    ratios : sequence of float
        Bulk over relaxed shear modulus; empty: ``RATIOS``.
    out : str or None
        Folder of tables and numbers, if they are to be written.
    jobs : int
        Processes.
    resolution : int or None
        Divisions per process zone; ``None``: the solvers' choice.
    fresh : bool
        Whether runs stored by an earlier, interrupted command are ignored, and what the folder holds is
        replaced.
    max_steps : int or None
        Of every run, accepted and rejected together; ``None``: the solver's own bound.

    Returns
    -------
    int
        1 if a run does not finish, or the full path and the surface modulus disagree.

    Raises
    ------
    SceneError
        If the scene is refused, or the folder holds results on another scene, or of another program.
    """
    loaded = load_taken(names, lambda case: solvers())
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        for case in loaded:
            check_report_unused(folder, poisson_json(case.name), [case])
    code, store = 0, Store(folder, fresh)
    with telling_what_is_kept(folder, store), processes(jobs) as executor:
        for case in loaded:
            progress = Progress(f"{case.name} poisson")
            progress.phase("runs")
            try:
                comparisons = compare_ratios(
                    case, ratios or RATIOS, resolution, executor, progress, store, max_steps
                )
            finally:
                progress.close()
            print(terminal.text(section(case.name, comparisons)))
            if folder is not None:
                print(f"written to {write_poisson(case, comparisons, folder)}")
            code = max(code, _exit_code(case.name, comparisons))
    store.clear()
    return code


def _exit_code(name: str, comparisons: list[CompressibilityComparison]) -> int:
    failures = []
    for one in comparisons:
        where = f"{name}: K/G = {one.ratio:g}"
        unfinished = ((label, run) for label, run in one.runs.items() if not run.finished)
        failures += [f"not finished: {where}: {label}: {run.ending}" for label, run in unfinished]
        failures += [f"failed: {where}: {name}: beyond the error estimates" for name in one.disagreements]
    for line in failures:
        print(line, file=sys.stderr)
    return 1 if failures else 0
