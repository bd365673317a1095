"""The arguments of ``crosscontact solve``."""

from __future__ import annotations

import argparse

from crosscontact.arguments.shared_options import fresh_option, max_steps_option, solver_option
from crosscontact.arguments.value_types import resolution


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Scene, solver, resolution, what is written and drawn."""
    command.add_argument("scene", metavar="SCENE", help="a TOML file or the name of a built-in scene")
    solver_option(command, "default: the reference")
    command.add_argument(
        "--resolution",
        type=resolution,
        metavar="N",
        help="divisions per process zone (without adhesion: per hundredth of the largest contact radius), "
        "N >= 4; default: the solver's choice",
    )
    command.add_argument("--out", metavar="DIR", help="write trace.csv, summary.json and scene.toml there")
    command.add_argument(
        "--estimate",
        action="store_true",
        help="estimate the errors, by a second, coarser run where the solver has no estimate of its own",
    )
    command.add_argument(
        "--plot",
        action="store_true",
        help="draw force.png and force.svg, into --out or the current folder",
    )
    max_steps_option(command)
    fresh_option(command, keeps_runs=False)


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Run one solver on one scene."""
    from crosscontact import registry
    from crosscontact.commands import solve

    return solve.run(
        options.scene,
        options.solver or registry.REFERENCE,
        options.resolution,
        options.out,
        fresh=options.fresh,
        estimate=options.estimate,
        plot=options.plot,
        max_steps=options.max_steps,
    )
