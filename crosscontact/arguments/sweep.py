"""The arguments of ``crosscontact sweep``."""

from __future__ import annotations

import argparse

from crosscontact.arguments.shared_options import fresh_option, jobs_option

WITH_PLAN = ("--out", "--jobs", "--dask", "--dry-run", "--fresh")
"""Options that say how a plan is carried out."""


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Plan, folder, and what carries the runs out."""
    command.add_argument(
        "plan",
        metavar="PLAN",
        nargs="?",
        help="a TOML file or the name of a built-in plan; without: list those",
    )
    command.add_argument(
        "--out", metavar="DIR", help="keep every run and write data set, table and figures there"
    )
    jobs_option(command)
    command.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="run on the workers of this Dask scheduler, or of a cluster of its own: local",
    )
    command.add_argument(
        "--dry-run", action="store_true", help="say how many runs there are, how long they take, how large"
    )
    command.add_argument("--plot", metavar="DIR", help="draw the figures of an earlier sweep again")
    fresh_option(command)


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Carry out a plan, draw an earlier sweep again, or list the plans."""
    from contact_scene import SceneError
    from crosscontact.commands import sweep

    beside = [name for name in WITH_PLAN if getattr(options, name.strip("-").replace("-", "_"))]
    if options.plot is not None:
        if options.plan is not None or beside:
            given = ", ".join(beside) or "PLAN"
            raise SceneError("--plot", f"given beside {given}", "the folder of an earlier sweep, alone")
        return sweep.plot(options.plot)
    if options.plan is None:
        if beside:
            raise SceneError("PLAN", f"is missing beside {', '.join(beside)}", "a file, or a built-in plan")
        return sweep.list_plans()
    return sweep.run(options.plan, options.out, jobs, options.dask, options.dry_run, options.fresh)
