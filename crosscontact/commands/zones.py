"""``crosscontact study --zones``: steps, time, memory and error over seven decades of the process zone."""

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
from validation.report.report_folder import check_report_unused, zones_json
from validation.report.sections.zones import section
from validation.report.write import write_zones
from validation.solvers import REFERENCE, SOLVERS, solvers
from validation.studies.zones import RATIOS, zone_runs


def run(
    names: Sequence[str],
    ratios: Sequence[float],
    out: str | None,
    fresh: bool = False,
    *,
    max_steps: int | None = None,
) -> int:
    """Run every solver with shorter and shorter zones; one after the other, for their time is measured.

    Parameters
    ----------
    names : sequence of str
        Scene files or names of built-in scenes.
    ratios : sequence of float
        Zones over the largest contact radius; empty: ``RATIOS``.
    out : str or None
        Folder of table, figure and numbers, if they are to be written.
    fresh : bool
        Whether runs stored by an earlier, interrupted command are ignored, and what the folder holds is
        replaced.
    max_steps : int or None
        Of every run, accepted and rejected together; ``None``: the solver's own bound.

    Returns
    -------
    int
        1 if a run that was started did not finish.

    Raises
    ------
    SceneError
        If the scene is refused, or the folder holds results on another scene, or of another program.
    """
    loaded = load_taken(names, lambda case: (SOLVERS[REFERENCE],))
    folder = None if out is None else output_folder(out)
    if folder is not None and not fresh:
        for case in loaded:
            check_report_unused(folder, zones_json(case.name), [case])
    asked = [one.name for one in solvers()]
    code, store = 0, Store(folder, fresh)
    for case in loaded:
        progress = Progress(f"{case.name} zones")
        try:
            with (
                telling_what_is_kept(folder, store),
                processes(1, isolated=True, tasks_per_process=1) as executor,
            ):
                runs = zone_runs(case, asked, ratios or RATIOS, progress, executor, store, max_steps)
        finally:
            progress.close()
        print(terminal.text(section(case.name, runs)))
        if folder is not None:
            print(f"written to {write_zones(case, runs, folder)}")
        for one in runs:
            if one.run is not None and not one.run.finished and not one.run.refused:
                where = f"{case.name}: {one.solver}, zone {one.ratio:g} of the radius"
                print(f"not finished: {where}: {one.run.ending}", file=sys.stderr)
                code = 1
    store.clear()
    return code
