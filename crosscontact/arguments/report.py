"""The arguments of ``crosscontact report``."""

from __future__ import annotations

import argparse

from crosscontact.arguments.shared_options import fresh_option, jobs_option
from validation.scenes import SUITES


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Suite, folder, and what the report holds."""
    command.add_argument("--suite", choices=SUITES, default="quick")
    command.add_argument("--out", metavar="DIR", default="out/report", help="default: %(default)s")
    jobs_option(command)
    command.add_argument(
        "--estimates",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="judge agreement by error estimates, each from a coarser run (default), or by tolerances alone",
    )
    command.add_argument(
        "--baseline",
        metavar="OLD.json",
        help="an earlier report.json: list what moved, exit 1 when beyond tolerance",
    )
    command.add_argument(
        "--fields",
        action="store_true",
        help="draw what happens under the surface along the cycle of Fig. 3 too; a minute or two more",
    )
    fresh_option(command)


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Run a suite of scenes by all solvers and write the report."""
    from crosscontact import registry
    from crosscontact.commands import report

    registry.usable()  # names those that cannot be loaded
    return report.run(
        options.suite,
        options.out,
        jobs,
        estimate=options.estimates,
        baseline=options.baseline,
        fresh=options.fresh,
        fields=options.fields,
    )
