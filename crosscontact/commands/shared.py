"""What commands share: options, each declared once, refusals, what is said on stderr, and long work."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from contact_scene import OutcomeKind, Scene, SceneError
from contact_scene.value_checks import positive, whole_from
from crosscontact import arguments
from crosscontact.arguments import COUNT, RESOLUTION, option_type
from validation import cases
from validation.cases import Case
from validation.drawing.figure import as_files
from validation.measure.difference import Check
from validation.report.document import number as in_digits
from validation.runs.folder import claim, output_folder, scene_question, write_whole
from validation.runs.process import interrupting
from validation.runs.progress import Progress
from validation.runs.store import Store
from validation.solvers import Solver

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DOTS_PER_INCH = 110
"""Resolution of the figures of ``--plot``."""
Options = dict[str, dict[str, Any]]
"""Settings of ``argparse`` by the name of an option."""


class Names:
    """Names for an option, looked up where they are needed: in its ``--help``, and where it is used."""

    def __init__(self, load: Callable[[], Iterable[str]]) -> None:
        self._load = load

    def __iter__(self) -> Iterator[str]:
        return iter(self._load())

    def __contains__(self, name: object) -> bool:
        return name in tuple(self)


def value(metavar: str, help: str, **more: Any) -> dict[str, Any]:
    """An option with a value, or several."""
    return {"metavar": metavar, "help": help} | more


def flag(help: str) -> dict[str, Any]:
    """An option that is given or not."""
    return {"action": "store_true", "help": help}


def resolution(help: str, **more: Any) -> Options:
    """``--resolution``."""
    return {"--resolution": value("N", help, type=option_type(RESOLUTION), **more)}


def solver(otherwise: str, *more: str) -> Options:
    """``--solver``: one of those that can be selected, one ``more``, or what happens without it."""
    names = Names(lambda: (*arguments.selectable(), *more))
    return {"--solver": value("NAME", f"one of %(choices)s; {otherwise}", choices=names)}


def jobs(help: str = "processes; default: the number of cores") -> Options:
    """``--jobs``."""
    return {"--jobs": value("N", help, type=option_type(COUNT))}


SCENE = {"scene": value("SCENE", "a TOML file or the name of a built-in scene")}
SCENES = {"scenes": value("SCENE", "TOML files or built-in names", nargs="+")}
MAX_STEPS = {
    "--max-steps": value(
        "N",
        "end a run after so many steps, accepted and rejected together; default: 200,000, more for many "
        "cycles",
        type=option_type(COUNT),
    )
}
READING = {
    "--spring-constant": value("K", "in N/m, in place of what the file states", type=option_type(positive)),
    "--sensitivity": value("S", "deflection over signal, in m/V", type=option_type(positive)),
    "--sampling-rate": value("HZ", "rows a second, of a file without times", type=option_type(positive)),
    "--speed": value("V", "of the stage in m/s, of a file without times", type=option_type(positive)),
    "--enum": value("N", "only the curve of this number, from 0", type=option_type(whole_from(0))),
    "--segment": value("NAME", "only the longest approach, pause or retract, or segments I:J"),
    "--columns": value("C", "of a table: time=3,stage=1:1e-6,force=2 (number or name, factor to SI units)"),
}
"""What files of curves may leave open."""
REPLACE = {"--fresh": flag("replace what --out holds, of another scene, solver or command")}
FRESH = {
    "--fresh": flag(
        "replace what --out holds, of another scene, solver or command; otherwise the runs that an "
        "interrupted command has finished there are taken over"
    )
}


def comma_separated(names: Callable[[list[str]], tuple[str, ...]]) -> Callable[[str], tuple[str, ...]]:
    """The type of an option ``A,B`` whose names are checked."""

    def parse(text: str) -> tuple[str, ...]:
        try:
            return names([name.strip() for name in text.split(",")])
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return parse


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
    """Exit code 1 if there are failed checks, each said on stderr in one line; else 0."""
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
    files = {folder / file: content for file, content in as_files(figure, name, DOTS_PER_INCH).items()}
    for path, content in files.items():
        write_whole(path, content)
    print("drawn in {} and {}".format(*files))


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


@dataclass(frozen=True)
class Work:
    """A command of many runs: the folder it writes to, if there is one, and the runs it has finished."""

    name: str
    folder: Path | None
    store: Store

    def runs(self) -> Progress:
        """Progress of the runs."""
        return Progress(self.name, "runs")

    def write(self, write: Callable[[Path, Progress], Path | None]) -> None:
        """Write the results, if there is a folder, and say where."""
        if self.folder is not None:
            with Progress(self.name, "drawing and writing") as writing:
                page = write(self.folder, writing)
            print(f"written to {page or self.folder / 'index.html'}")


@contextmanager
def long_work(
    name: str, options: argparse.Namespace, kind: str, scenes: Sequence[Case] = ()
) -> Iterator[Work]:
    """Take ``--out`` for results of a kind on scenes; runs of an interrupted command are found in it.

    When all is done, what was stored is removed.
    """
    folder = None if options.out is None else output_folder(options.out)
    if folder is not None:
        question = scene_question(*((case.name, case.scene) for case in scenes))
        claim(folder, kind, question, fresh=options.fresh)
    store = Store(folder, options.fresh)
    with telling_what_is_kept(folder, store):
        yield Work(name, folder, store)
    store.clear()


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
