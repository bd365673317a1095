"""The arguments of ``crosscontact exam``."""

from __future__ import annotations

import argparse
from typing import Any

from crosscontact.arguments.shared_options import jobs_option
from crosscontact.arguments.value_types import comma_separated, resolution
from validation.scenes import SUITES


def _solvers(text: str) -> tuple[str, ...]:
    from crosscontact import registry

    names = tuple(dict.fromkeys(comma_separated(text)))
    known = registry.selectable()
    unknown: list[Any] = [name for name in names if name not in known]
    if unknown:
        raise argparse.ArgumentTypeError(f"got {unknown[0]!r:.40}; allowed: of {', '.join(known)}")
    return names


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Its actions: export, answer, reproduce."""
    actions = command.add_subparsers(dest="action", metavar="ACTION", required=True)
    export = actions.add_parser("export", help="write a folder for each scene: TOML, JSON, a page in words")
    export.add_argument("folder", metavar="DIR")
    export.add_argument("--suite", choices=SUITES, default="quick")
    export.add_argument(
        "--with-reference",
        action="store_true",
        help="write the reference's trace and measures with their errors beside each scene",
    )
    jobs_option(export)
    answer = actions.add_parser("answer", help="answer an exported exam by registered solvers")
    answer.add_argument("folder", metavar="DIR")
    answer.add_argument("--solvers", type=_solvers, required=True, metavar="A,B", help="peers included")
    answer.add_argument(
        "--resolution",
        type=resolution,
        nargs="+",
        default=[None],
        metavar="N",
        help="one answer for each; default: the solver's choice",
    )
    jobs_option(answer, "processes; default: 1, so that run times are not those of a busy machine")
    again = actions.add_parser("reproduce", help="compute a trace again from its header alone")
    again.add_argument("file", metavar="FILE", help="such as DIR/SCENE/reference.csv")


def carry_out(options: argparse.Namespace, jobs: int) -> int:
    """Export scenes, answer them, or reproduce a trace."""
    from crosscontact.commands import exam

    if options.action == "export":
        return exam.export(options.folder, options.suite, options.with_reference, jobs)
    if options.action == "answer":
        return exam.answer(options.folder, options.solvers, options.resolution, options.jobs or 1)
    return exam.again(options.file)
