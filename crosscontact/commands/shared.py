"""What commands share: options and their values, refusals, what is said on stderr."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from contact_scene import OutcomeKind, Scene, SceneError
from crosscontact import arguments
from validation import cases
from validation.cases import Case
from validation.drawing.export import png, svg_file
from validation.measure.check import Check
from validation.report.document import number as in_digits
from validation.runs.folder import write_whole
from validation.runs.process import interrupting
from validation.runs.store import Store
from validation.solvers import Solver

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS_PER_INCH = 110
"""Resolution of the figures of ``--plot``."""


class Names:
    """Names for an option, looked up where they are needed: in its ``--help``, and where it is used."""

    def __init__(self, load: Callable[[], Iterable[str]]) -> None:
        self._load = load

    def __iter__(self) -> Iterator[str]:
        return iter(self._load())

    def __contains__(self, name: object) -> bool:
        return name in tuple(self)


def comma_separated(text: str) -> list[str]:
    """The names in ``A,B``."""
    return [name.strip() for name in text.split(",")]


def whole(least: int) -> Callable[[str], int]:
    """The type of an option that is a whole number, at least this."""

    def parse(text: str) -> int:
        if not text.isdecimal() or int(text) < least:
            raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: a whole number >= {least}")
        return int(text)

    return parse


def number(is_allowed: Callable[[float], bool], allowed: str) -> Callable[[str], float]:
    """The type of an option that is a number; ``allowed`` says in words which numbers are."""

    def parse(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not is_allowed(value):
            raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: {allowed}")
        return value

    return parse


count = whole(1)
resolution = whole(arguments.SMALLEST_RESOLUTION)


def scene_argument(command: argparse.ArgumentParser, *, many: bool = False) -> None:
    """``SCENE``: one, or several."""
    if many:
        command.add_argument("scenes", metavar="SCENE", nargs="+", help="TOML files or built-in names")
    else:
        command.add_argument("scene", metavar="SCENE", help="a TOML file or the name of a built-in scene")


def solver_option(command: argparse.ArgumentParser, help: str) -> None:
    """``--solver``: one of those that can be selected; ``help`` says what happens without it."""
    choices = Names(arguments.selectable)
    command.add_argument("--solver", choices=choices, metavar="NAME", help=f"one of %(choices)s; {help}")


def run_options(
    command: argparse.ArgumentParser,
    *,
    jobs: str = "processes; default: the number of cores",
    max_steps: bool = False,
    fresh: bool = True,
    keeps_runs: bool = True,
) -> None:
    """``--max-steps``, ``--jobs`` (its help; empty: none), ``--fresh``: how runs are carried out and kept."""
    if max_steps:
        command.add_argument(
            "--max-steps",
            type=count,
            metavar="N",
            help="end a run after so many steps, accepted and rejected together; default: 200,000, more for "
            "many cycles",
        )
    if jobs:
        command.add_argument("--jobs", type=count, metavar="N", help=jobs)
    if fresh:
        kept = "; otherwise the runs that an interrupted command has finished there are taken over"
        command.add_argument(
            "--fresh",
            action="store_true",
            help=f"replace what --out holds, of another scene, solver or command{kept if keeps_runs else ''}",
        )


def say(words: str) -> None:
    """A line on stderr."""
    print(f"crosscontact: {words}", file=sys.stderr)


def warn(warnings: Iterable[str]) -> None:
    """Say what makes an answer doubtful, one line each."""
    for warning in warnings:
        say(f"warning: {warning}")


def failed(lines: Collection[str]) -> int:
    """Exit code 1 if anything failed or did not finish, each said on stderr in one line; else 0."""
    for line in lines:
        print(line, file=sys.stderr)
    return 1 if lines else 0


def exit_code(failures: Collection[Check]) -> int:
    """The same of checks."""
    return failed(
        [
            f"failed: {check.scene}: {check.solver}: {check.quantity}: found {in_digits(check.found)}, "
            f"expected {check.relation} {in_digits(check.expected)}{' ' + check.note if check.note else ''}"
            for check in failures
        ]
    )


def step_hint(kind: OutcomeKind | None) -> str:
    """How to get further than the step budget, where that has ended a run."""
    return "; --max-steps N allows more" if kind is OutcomeKind.STEP_BUDGET else ""


def draw(figure: Figure, folder: Path, name: str) -> None:
    """The figure of ``--plot``, as PNG and SVG."""
    files = folder / f"{name}.png", folder / f"{name}.svg"
    write_whole(files[0], png(figure, DOTS_PER_INCH))
    write_whole(files[1], svg_file(figure))
    print(f"drawn in {files[0]} and {files[1]}")


@contextmanager
def telling_what_is_kept(folder: Path | None, store: Store) -> Iterator[None]:
    """Let an interruption pass and say what of the finished parts the same command finds."""
    try:
        with interrupting():
            yield
    except KeyboardInterrupt:
        if folder is None:
            say("without --out DIR nothing is kept")
        elif store.holds_answers:
            say(f"{folder} holds what is done: the same command goes on with it")
        else:
            say("no run is done: there is nothing to keep")
        raise


def load_taken(names: Iterable[str], methods: Callable[[Case], Iterable[Solver]]) -> list[Case]:
    """Load scenes, each of which one of the solvers that are to run it has to take; repeated ones once."""
    sources = tuple(dict.fromkeys(names))
    loaded = cases.load_all(sources)
    for source, case in zip(sources, loaded, strict=True):
        check_taken(source, case.scene, methods(case))
    return loaded


def check_taken(source: str, scene: Scene, methods: Iterable[Solver], resolution: int | None = None) -> None:
    """Refuse a scene that none of the solvers takes, with the reason of each, once where they agree."""
    found: dict[str, SceneError] = {}
    for method in methods:
        try:
            method.check(scene, resolution)
            return
        except SceneError as error:
            found[method.name] = error
    if len({str(error) for error in found.values()}) == 1:
        raise next(iter(found.values())).in_file(source)
    if found:
        problem = ", ".join(f"{name}: {error.key}: {error.problem}" for name, error in found.items())
        raise SceneError("", f"no solver takes it: {problem}", "a scene that one of them takes", source)
