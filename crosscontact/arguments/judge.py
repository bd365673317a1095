"""The arguments of ``crosscontact judge``."""

from __future__ import annotations

import argparse

from crosscontact.arguments.shared_options import fresh_option, jobs_option


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Folders of the answers and of the report."""
    command.add_argument("folder", metavar="DIR", help="holds answers: SCENE/trace.csv at any depth")
    command.add_argument("--out", metavar="REPORT", help="write page, Markdown, JSON and JUnit there")
    jobs_option(command)
    fresh_option(command)


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Grade the traces of other codes."""
    from crosscontact.commands import judge

    return judge.run(options.folder, options.out, jobs, options.fresh)
