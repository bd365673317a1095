"""``crosscontact sweep``: the runs of a plan, as a data set, a table and figures."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from contact_scene import SceneError
from crosscontact import registry
from crosscontact.tables import aligned
from validation.execution.engines import own_engine
from validation.execution.files import in_words
from validation.execution.folder_lock import locked_folder
from validation.execution.progress import Progress, duration
from validation.execution.run_table import RunTable
from validation.report.report_folder import SWEEP, check_kind
from validation.sweeps.dataset import FILE, check_installed, read_dataset
from validation.sweeps.forecast import SweepForecast, forecast
from validation.sweeps.plan import SweepPlan, plan_names, read_plan
from validation.sweeps.run_plan import carry_out
from validation.sweeps.traces import check_writable
from validation.sweeps.write import draw, endings, summary_rows, write_results

ENDINGS = 5
"""Ways to end that are listed; the table has all."""


def run(name: str, out: str | None, jobs: int, dask: str | None, dry_run: bool, fresh: bool) -> int:
    """Carry out a plan.

    Parameters
    ----------
    name : str
        A plan file or the name of a built-in plan.
    out : str or None
        Folder of the results; for a forecast not needed.
    jobs : int
        Processes, or workers of a Dask cluster of this command's own.
    dask : str or None
        Address of a Dask scheduler, or "local".
    dry_run : bool
        Whether to say only what there is to do.
    fresh : bool
        Whether stored runs are ignored, and a folder is taken that another kind of command has written to.

    Returns
    -------
    int
        1 if a run did not reach its end, else 0.

    Raises
    ------
    SceneError
        If the plan is wrong, nothing could be written, or the folder holds what another kind of command has
        written.
    """
    plan = read_plan(name)
    registry.usable()  # names those that cannot be loaded
    if dry_run:
        there = out is not None and os.path.isdir(out)
        with RunTable(Path(str(out)) if there else None) as table:
            _say(plan, forecast(plan, table), jobs)
        return 0
    if out is None:
        raise SceneError("--out", "is missing", "a folder for the results, or --dry-run")
    check_installed()
    check_writable(plan)
    folder = Path(out)
    if not fresh:
        check_kind(folder, SWEEP)
    with RunTable(folder, fresh) as table:
        with Progress(f"sweep {Path(name).stem}") as progress, own_engine(jobs, dask) as engine:
            progress.phase("runs")
            try:
                runs = carry_out(plan, table, engine, lambda share, text: progress(share, detail=text))
            except (KeyboardInterrupt, OSError):
                print(f"crosscontact: kept in {folder}: the same command goes on", file=sys.stderr)
                raise
        with Progress(f"sweep {Path(name).stem}") as progress:
            progress.phase("drawing and writing")
            data = write_results(plan, runs, folder)
            draw(data, folder)
        unfinished = sum(not runs.record(key).finished for key in runs.keys)
    print(f"{plan.title or Path(name).stem}: {plan.count} runs of {plan.base.name} by {plan.solver}")
    for line in aligned(summary_rows(data)):
        print(line)
    for outcome, reason, count in endings(data)[:ENDINGS]:
        print(f"  {count} {outcome}: {reason}")
    print(f"written to {folder / FILE}")
    if unfinished:
        print(f"crosscontact: {unfinished} of {plan.count} runs did not reach their end", file=sys.stderr)
    return 1 if unfinished else 0


def plot(folder: str) -> int:
    """Draw the figures of a folder again; the exit code."""
    with locked_folder(folder, "--plot") as out:
        data = read_dataset(out)
        drawn = draw(data, out)
    for line in aligned(summary_rows(data)):
        print(line)
    print(f"drawn in {folder}: {', '.join(drawn) or 'nothing: no run has a measure of `drawn`'}")
    return 0


def list_plans() -> int:
    """Print the built-in plans; the exit code."""
    for name in plan_names():
        plan = read_plan(name)
        print(f"{name:16} {plan.count:6} runs  {plan.title}")
    return 0


def _say(plan: SweepPlan, ahead: SweepForecast, jobs: int) -> None:
    """A forecast, in words."""
    missing = ahead.runs - ahead.stored
    source = f"measured on {ahead.measured} stored runs" if ahead.measured else "measured on the first"
    print(f"{ahead.runs} runs of {plan.base.name} by {plan.solver}, {ahead.stored} stored, {missing} to do")
    print(
        f"  about {duration(ahead.seconds)} of processor time, {ahead.per_run:.3g} s a run ({source}); "
        f"about {duration(ahead.seconds / jobs)} by {jobs} process{'es' if jobs > 1 else ''}"
    )
    print(f"  about {in_words(ahead.bytes)} of results")
