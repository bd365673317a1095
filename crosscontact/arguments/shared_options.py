"""Options that several commands have."""

from __future__ import annotations

import argparse
from collections.abc import Iterable

from crosscontact.arguments.value_types import Names, count


def _solver_names() -> Iterable[str]:
    from crosscontact import registry

    return registry.selectable()


def solver_option(command: argparse.ArgumentParser, help: str) -> None:
    """``--solver``: one of those that can be selected; ``help`` says what happens without it."""
    command.add_argument(
        "--solver", choices=Names(_solver_names), metavar="NAME", help=f"one of %(choices)s; {help}"
    )


def jobs_option(
    command: argparse.ArgumentParser, help: str = "processes; default: the number of cores"
) -> None:
    """``--jobs``: a number of processes."""
    command.add_argument("--jobs", type=count, metavar="N", help=help)


def max_steps_option(command: argparse.ArgumentParser) -> None:
    """``--max-steps``: the step budget of a run."""
    command.add_argument(
        "--max-steps",
        type=count,
        metavar="N",
        help="end a run after so many steps, accepted and rejected together; default: 200,000, or five times "
        "as many as are expected",
    )


def fresh_option(command: argparse.ArgumentParser, replaces: bool = False) -> None:
    """``--fresh``: ignore what is stored; with ``replaces`` also overwrite the results of another
    scene, solver or command."""
    replaced = ", and replace the results of another scene, solver or command" if replaces else ""
    command.add_argument(
        "--fresh",
        action="store_true",
        help=f"start anew{replaced}; otherwise an interrupted command with the same --out is continued",
    )
