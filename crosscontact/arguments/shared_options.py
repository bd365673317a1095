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


def fresh_option(command: argparse.ArgumentParser, keeps_runs: bool = True) -> None:
    """``--fresh``: replace what the folder holds of another scene, solver or command, and kept runs."""
    kept = "; otherwise the runs that an interrupted command has finished there are taken over"
    command.add_argument(
        "--fresh",
        action="store_true",
        help=f"replace what --out holds, of another scene, solver or command{kept if keeps_runs else ''}",
    )
