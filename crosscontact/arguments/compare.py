"""The arguments of ``crosscontact compare``."""

from __future__ import annotations

import argparse

from crosscontact.arguments.shared_options import fresh_option, jobs_option, max_steps_option
from crosscontact.arguments.value_types import comma_separated


def _solvers(text: str) -> tuple[str, ...]:
    from crosscontact import registry

    try:
        return registry.chosen(comma_separated(text), "")
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Scenes and solvers."""
    command.add_argument("scenes", metavar="SCENE", nargs="+", help="TOML files or built-in names")
    command.add_argument(
        "--solvers",
        type=_solvers,
        metavar="A,B",
        help="these only, the reference among them; default: all",
    )
    command.add_argument("--out", metavar="DIR", help="write the report and every run there")
    max_steps_option(command)
    jobs_option(command)
    fresh_option(command)


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Compare solvers on scenes."""
    from crosscontact import registry
    from crosscontact.commands import compare

    if not options.solvers:
        registry.usable()  # names those that cannot be loaded
    return compare.run(
        options.scenes, options.solvers, options.out, jobs, options.fresh, max_steps=options.max_steps
    )
