"""``crosscontact sweep``: the runs of a plan, as a data set, a table and figures."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from contact_scene import SceneError
from crosscontact import arguments
from crosscontact.commands import shared
from crosscontact.commands.shared import flag, say, value
from validation.report.texts import aligned
from validation.runs.folder import claim, in_words, locked_folder
from validation.runs.pool import own_engine
from validation.runs.progress import Progress, duration
from validation.sweeps import dataset
from validation.sweeps.batch_runs import BATCH
from validation.sweeps.figures import draw
from validation.sweeps.plan import SweepPlan, plan_names, read_plan
from validation.sweeps.run_plan import SweepForecast, carry_out, forecast, solved_again, store_of

ENDINGS = 5
"""Ways to end that are listed; the table has all."""
WITH_PLAN: shared.Options = {
    "--out": value("DIR", "keep every run and write data set, table and figures there"),
    **shared.jobs(),
    "--dask": value(
        "ADDRESS", "run on the workers of this Dask scheduler, or of a cluster of its own: local"
    ),
    "--dry-run": flag("say how many runs there are, how long they take, how large"),
    **shared.FRESH,
}
"""Options that say how a plan is carried out."""
OPTIONS = {
    "plan": value("PLAN", "a TOML file or the name of a built-in plan; without: list those", nargs="?"),
    "--plot": value("DIR", "draw the figures of an earlier sweep again"),
    **WITH_PLAN,
}


def run(options: argparse.Namespace, jobs: int) -> int:
    """Carry out a plan, draw an earlier sweep again, or list the plans; 1 if a run did not reach its end."""
    beside = [name for name in WITH_PLAN if getattr(options, name.strip("-").replace("-", "_"))]
    if options.plot is not None:
        if options.plan is not None or beside:
            given = ", ".join(beside) or "PLAN"
            raise SceneError("--plot", f"given beside {given}", "the folder of an earlier sweep, alone")
        return _plot(options.plot)
    if options.plan is None:
        if beside:
            raise SceneError("PLAN", f"is missing beside {', '.join(beside)}", "a file, or a built-in plan")
        for name in plan_names():
            plan = read_plan(name)
            print(f"{name:16} {plan.count:6} runs  {plan.title}")
        return 0
    plan = read_plan(options.plan)
    arguments.usable()  # names those that cannot be loaded
    if options.dry_run:
        there = options.out is not None and os.path.isdir(options.out)
        with store_of(Path(options.out) if there else None) as store:
            _say_forecast(plan, forecast(plan, store), jobs)
        return 0
    if options.out is None:
        raise SceneError("--out", "is missing", "a folder for the results, or --dry-run")
    return _carry_out(plan, Path(options.plan).stem, Path(options.out), jobs, options)


def _carry_out(plan: SweepPlan, name: str, folder: Path, jobs: int, options: argparse.Namespace) -> int:
    dataset.check_writable(plan)
    claim(folder, "a sweep", {}, fresh=options.fresh)
    with store_of(folder, options.fresh) as store:
        with Progress(f"sweep {name}", "runs") as progress, own_engine(jobs, options.dask) as engine:

            def tell(share: float, text: str) -> None:
                progress(share, detail=text)

            try:
                runs = carry_out(plan, store, engine, tell)
                if plan.solver == BATCH:
                    progress.phase("a sample by the reference")
                runs = solved_again(plan, runs, engine, tell)
            except (KeyboardInterrupt, OSError):
                kept = f"kept in {folder}: the same command goes on"
                say(kept if store.holds_answers else "no run is done: there is nothing to keep")
                raise
        with Progress(f"sweep {name}", "drawing and writing") as progress:
            data = dataset.write_results(plan, runs, folder)
            draw(data, folder)
    print(f"{plan.title or name}: {plan.count} runs of {plan.scene.name} by {plan.solver}")
    for line in aligned(dataset.summary_rows(data)):
        print(line)
    for outcome, reason, count in dataset.endings(data)[:ENDINGS]:
        print(f"  {count} {outcome}: {reason}")
    if apart := {name: one.attrs[dataset.APART] for name, one in data.items() if dataset.APART in one.attrs}:
        worst, again = max(apart, key=lambda name: apart[name]), data.attrs[dataset.AGAIN]
        print(f"  {again} runs solved again by the reference: {apart[worst]:.1e} apart at most, in {worst}")
    print(f"written to {folder / dataset.FILE}")
    if unfinished := data.attrs[dataset.UNFINISHED_RUNS]:
        say(f"{unfinished} of {plan.count} runs did not reach their end")
    return 1 if unfinished else 0


def _plot(folder: str) -> int:
    """Draw the figures of a folder again."""
    with locked_folder(folder, "--plot") as out:
        data = dataset.read_dataset(out)
        drawn = draw(data, out)
    for line in aligned(dataset.summary_rows(data)):
        print(line)
    print(f"drawn in {folder}: {', '.join(drawn) or 'nothing: no run has a measure of `drawn`'}")
    return 0


def _say_forecast(plan: SweepPlan, ahead: SweepForecast, jobs: int) -> None:
    missing = ahead.runs - ahead.stored
    source = f"measured on {ahead.measured} stored runs" if ahead.measured else "measured on the first"
    print(f"{ahead.runs} runs of {plan.scene.name} by {plan.solver}, {ahead.stored} stored, {missing} to do")
    print(
        f"  about {duration(ahead.seconds)} of processor time, {ahead.per_run:.3g} s a run ({source}); "
        f"about {duration(ahead.seconds / jobs)} by {jobs} process{'es' if jobs > 1 else ''}"
    )
    print(f"  about {in_words(ahead.bytes)} of results")
