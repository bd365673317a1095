"""The arguments of ``crosscontact exam`` and ``crosscontact judge``."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

from validation.scenes import SUITES


def add_exam(
    command: argparse.ArgumentParser, count: Callable[[str], int], size: Callable[[str], int]
) -> None:
    """Arguments of ``exam``; ``count`` and ``size`` read a number of processes and a resolution."""
    actions = command.add_subparsers(dest="action", metavar="ACTION", required=True)
    export = actions.add_parser("export", help="write a folder for each scene: TOML, JSON, a page in words")
    export.add_argument("folder", metavar="DIR")
    export.add_argument("--suite", choices=SUITES, default="quick")
    export.add_argument(
        "--with-reference",
        action="store_true",
        help="write the reference's trace and measures with their errors beside each scene",
    )
    _jobs(export, count)
    answer = actions.add_parser("answer", help="answer an exported exam by registered solvers")
    answer.add_argument("folder", metavar="DIR")
    answer.add_argument("--solvers", type=_names, required=True, metavar="A,B", help="peers included")
    answer.add_argument(
        "--resolution",
        type=size,
        nargs="+",
        default=[None],
        metavar="N",
        help="one answer for each; default: the solver's choice",
    )
    answer.add_argument(
        "--jobs",
        type=count,
        metavar="N",
        help="processes; default: 1, so that run times are not those of a busy machine",
    )
    again = actions.add_parser("reproduce", help="compute a trace again from its header alone")
    again.add_argument("file", metavar="FILE", help="such as DIR/SCENE/reference.csv")


def add_judge(command: argparse.ArgumentParser, count: Callable[[str], int]) -> None:
    """Arguments of ``judge``."""
    command.add_argument("folder", metavar="DIR", help="holds answers: SCENE/trace.csv at any depth")
    command.add_argument("--out", metavar="REPORT", help="write page, Markdown, JSON and JUnit there")
    _jobs(command, count)
    command.add_argument("--fresh", action="store_true", help="start anew instead of continuing")


def run_exam(options: argparse.Namespace, jobs: int) -> int:
    """Carry out ``exam``."""
    from crosscontact.commands import exam

    if options.action == "export":
        return exam.export(options.folder, options.suite, options.with_reference, jobs)
    if options.action == "answer":
        return exam.answer(options.folder, options.solvers, options.resolution, options.jobs or 1)
    return exam.again(options.file)


def run_judge(options: argparse.Namespace, jobs: int) -> int:
    """Carry out ``judge``."""
    from crosscontact.commands import judge

    return judge.run(options.folder, options.out, jobs, options.fresh)


def _jobs(command: argparse.ArgumentParser, count: Callable[[str], int]) -> None:
    command.add_argument("--jobs", type=count, metavar="N", help="processes; default: the number of cores")


def _names(text: str) -> tuple[str, ...]:
    from crosscontact import registry

    names = tuple(dict.fromkeys(name.strip() for name in text.split(",")))
    known = registry.selectable()
    unknown: list[Any] = [name for name in names if name not in known]
    if unknown:
        raise argparse.ArgumentTypeError(f"got {unknown[0]!r:.40}; allowed: of {', '.join(known)}")
    return names
