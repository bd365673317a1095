"""The arguments of ``crosscontact stability``."""

from __future__ import annotations

import argparse
from collections.abc import Iterable

from crosscontact.arguments.shared_options import fresh_option, jobs_option, solver_option
from crosscontact.arguments.value_types import Names


def _axis_names() -> Iterable[str]:
    from validation.stability.matrix import AXES

    return AXES


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Solver and axis, if not all."""
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and heat maps there")
    jobs_option(command)
    solver_option(command, "this one only; default: all")
    command.add_argument(
        "--only", choices=Names(_axis_names), metavar="AXIS", help="this axis only: one of %(choices)s"
    )
    fresh_option(command)


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Run the matrix of stiff and extreme cases."""
    from crosscontact import registry
    from crosscontact.commands import stability

    if not options.solver:
        registry.usable()  # names those that cannot be loaded
    return stability.run(options.out, jobs, options.solver, options.only, options.fresh)
