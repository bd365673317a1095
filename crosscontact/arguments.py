"""The arguments of each command. Nothing heavy is imported before an option is used that needs it."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable, Iterator
from typing import NoReturn

from crosscontact import __version__
from crosscontact.exam_arguments import add_exam, add_judge
from crosscontact.limits import SMALLEST_RESOLUTION
from validation.scenes import SUITES


class Names:
    """Names for an option, looked up where they are needed: in its ``--help``, and where it is used.

    Parameters
    ----------
    load : callable
        Gives the names; may import heavy packages.
    """

    def __init__(self, load: Callable[[], Iterable[str]]) -> None:
        self._load = load

    def __iter__(self) -> Iterator[str]:
        return iter(self._load())

    def __contains__(self, name: object) -> bool:
        return name in tuple(self)


def _solver_names() -> Iterable[str]:
    from crosscontact import registry

    return registry.selectable()


def _axis_names() -> Iterable[str]:
    from validation.stability.matrix import AXES

    return AXES


def _quantity_names() -> Iterable[str]:
    from validation.fields.figures.quantities import QUANTITIES

    return QUANTITIES


class _Parser(argparse.ArgumentParser):
    """Reports bad input in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {' '.join(message.split())}\n")


def _resolution(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < SMALLEST_RESOLUTION:
        raise argparse.ArgumentTypeError(
            f"got {text!r:.40}; allowed: a whole number >= {SMALLEST_RESOLUTION}"
        )
    return value


def _solvers(text: str) -> tuple[str, ...]:
    from crosscontact import registry

    try:
        return registry.chosen([name.strip() for name in text.split(",")], "")
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _count(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: a whole number >= 1")
    return int(text)


def _number(is_allowed: Callable[[float], bool], allowed: str) -> Callable[[str], float]:
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


_bulk = _number(lambda value: 2.0 / 3.0 < value < 1e6, "a number above 2/3, below 1e6")
_ratio = _number(lambda value: 1e-8 <= value <= 0.2, "a number from 1e-8 to 0.2")
_time = _number(lambda value: 0.0 <= value < math.inf, "times >= 0")


def parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    top = _Parser(
        prog="crosscontact",
        description="Adhesive viscoelastic contact of a rigid indenter, solved independently and compared.",
    )
    top.add_argument("--version", action="version", version=f"crosscontact {__version__}")
    commands = top.add_subparsers(dest="command", metavar="COMMAND")
    commands.add_parser("scenes", help="list the built-in scenes")
    _solve_arguments(commands.add_parser("solve", help="run one solver on one scene"))
    _compare_arguments(
        commands.add_parser("compare", help="run all solvers on scenes; exit 1 when out of tolerance")
    )
    _study_arguments(
        commands.add_parser("study", help="refinement ladders and error against run time, every solver")
    )
    _fields_arguments(
        commands.add_parser("fields", help="stresses, energies and losses in the body, for ParaView")
    )
    _sweep_arguments(
        commands.add_parser("sweep", help="one scene over many values of its keys, as a data set and maps")
    )
    _stability_arguments(
        commands.add_parser("stability", help="stiff and extreme cases: where each solver holds")
    )
    _report_arguments(
        commands.add_parser("report", help="run a suite of built-in scenes, check and draw everything")
    )
    _material_arguments(
        commands.add_parser("material", help="read a Prony series, or fit one to measured moduli")
    )
    add_exam(
        commands.add_parser("exam", help="scenes for other codes to answer: export, answer, reproduce"),
        _count,
        _resolution,
    )
    add_judge(
        commands.add_parser("judge", help="grade the traces of other codes; exit 1 when one fails"), _count
    )
    _fit_arguments(commands.add_parser("fit", help="material and adhesion from measured curves, with errors"))
    return top


def _fit_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("data", metavar="DATA", nargs="+", help="CSV files, or files that afmformats reads")
    command.add_argument("scene", metavar="SCENE", help="the first guess: a TOML file or a built-in name")
    command.add_argument(
        "--vary",
        nargs="+",
        default=[],
        metavar="PATH[=LOW:HIGH]",
        help="numbers of the scene, as adhesion.work or material.branches[0].time=0.1:10",
    )
    command.add_argument(
        "--per-curve", nargs="+", default=[], metavar="PATH", help="the same, another value for each curve"
    )
    command.add_argument(
        "--tie", nargs="+", default=[], metavar="PATH=OTHER", help="PATH keeps its ratio to OTHER"
    )
    command.add_argument(
        "--free",
        nargs="+",
        default=[],
        metavar="NAME",
        help="of each curve: contact_point, baseline, drift, time_offset",
    )
    command.add_argument(
        "--prony", nargs="+", type=float, default=[], metavar="TIME", help="moduli on these relaxation times"
    )
    command.add_argument(
        "--regularisation",
        type=float,
        metavar="X",
        help="weight of the bending of these moduli; default: 0.1",
    )
    command.add_argument("--starts", type=_count, default=3, metavar="N", help="default: %(default)s")
    command.add_argument("--seed", type=int, default=0, metavar="N", help="of the starts that are drawn")
    command.add_argument(
        "--profile", nargs="+", default=[], metavar="NAME", help="profile likelihood of these, or all"
    )
    _solver_option(command, "default: the reference")
    command.add_argument("--check-solver", default="bem", metavar="NAME", help="or none; default: bem")
    command.add_argument("--resolution", type=_resolution, metavar="N", help="default: by the noise")
    command.add_argument("--out", metavar="DIR", help="write page, fit.json, scene.toml and figure there")
    command.add_argument("--jobs", type=_count, metavar="N", help="processes; default: the number of cores")
    _fresh(command, replaces=True)


def _solve_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("scene", metavar="SCENE", help="a TOML file or the name of a built-in scene")
    _solver_option(command, "default: the reference")
    command.add_argument(
        "--resolution",
        type=_resolution,
        metavar="N",
        help="divisions per process zone (without adhesion: per hundredth of the largest contact radius), "
        "N >= 4; default: the solver's choice",
    )
    command.add_argument("--out", metavar="DIR", help="write trace.csv, summary.json and scene.toml there")
    command.add_argument(
        "--estimate",
        action="store_true",
        help="estimate the errors, by a second, coarser run where the solver has no estimate of its own",
    )
    command.add_argument(
        "--plot",
        action="store_true",
        help="draw force.png and force.svg, into --out or the current folder",
    )
    _max_steps(command)
    _fresh(command, replaces=True)


def _compare_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("scenes", metavar="SCENE", nargs="+", help="TOML files or built-in names")
    command.add_argument(
        "--solvers",
        type=_solvers,
        metavar="A,B",
        help="these only, the reference among them; default: all",
    )
    command.add_argument("--out", metavar="DIR", help="write the report and every run there")
    command.add_argument("--jobs", type=_count, metavar="N", help="processes; default: the number of cores")
    _fresh(command, replaces=True)


def _study_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("scenes", metavar="SCENE", nargs="+", help="TOML files or built-in names")
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and figures there")
    command.add_argument("--jobs", type=_count, metavar="N", help="processes for what is not timed")
    command.add_argument(
        "--poisson",
        type=_bulk,
        nargs="*",
        metavar="K/G",
        help="instead: elastic bulk of these ratios to the relaxed shear modulus (10 to 1000), against a "
        "constant Poisson's ratio",
    )
    command.add_argument(
        "--zones",
        type=_ratio,
        nargs="*",
        metavar="RATIO",
        help="instead: steps, points, time and error of every solver with process zones of these ratios to "
        "the contact radius (5e-2 to 1e-7)",
    )
    _fresh(command)


def _fields_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("scene", metavar="SCENE", help="a TOML file or the name of a built-in scene")
    command.add_argument(
        "--at",
        type=_time,
        nargs="+",
        default=[],
        metavar="T",
        help="times, stepped onto exactly; where the load jumps, the state before",
    )
    command.add_argument("--pull-off", action="store_true", help="the moment of largest tension")
    command.add_argument(
        "--every",
        type=_count,
        default=0,
        metavar="N",
        help="every N-th accepted step, the start included; not drawn",
    )
    command.add_argument(
        "--resolution", type=_resolution, metavar="N", help="divisions per process zone, as for solve"
    )
    _max_steps(command)
    command.add_argument("--out", metavar="DIR", help="default: out/fields/SCENE")
    _fresh(command, replaces=True)
    drawn = command.add_argument_group("figures", "sections are drawn at all moments; where asked for, also")
    drawn.add_argument("--strip", action="store_true", help="the key moments of the run side by side")
    drawn.add_argument(
        "--animate", action="store_true", help="the whole run as an animated GIF; no files for ParaView"
    )
    drawn.add_argument("--revolve", action="store_true", help="the body in three dimensions")
    drawn.add_argument(
        "--show", action="store_true", help="the last moment in a window, where there is a screen"
    )
    drawn.add_argument(
        "--alike",
        action="store_true",
        help="one magnification, view and range of colours for all sections of the run",
    )
    drawn.add_argument(
        "--quantity",
        nargs="+",
        choices=Names(_quantity_names),
        metavar="Q",
        help="what to draw, of %(choices)s; default: von_mises stress_zz dissipation_rate",
    )
    drawn.add_argument("--no-figures", action="store_true", help="files for ParaView only")


def _sweep_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "plan",
        metavar="PLAN",
        nargs="?",
        help="a TOML file or the name of a built-in plan; without: list those",
    )
    command.add_argument(
        "--out", metavar="DIR", help="keep every run and write data set, table and figures there"
    )
    command.add_argument("--jobs", type=_count, metavar="N", help="processes; default: the number of cores")
    command.add_argument(
        "--dask",
        metavar="ADDRESS",
        help="run on the workers of this Dask scheduler, or of a cluster of its own: local",
    )
    command.add_argument(
        "--dry-run", action="store_true", help="say how many runs there are, how long they take, how large"
    )
    command.add_argument("--plot", metavar="DIR", help="draw the figures of an earlier sweep again")
    _fresh(command)


def _stability_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and heat maps there")
    command.add_argument("--jobs", type=_count, metavar="N", help="processes; default: the number of cores")
    _solver_option(command, "this one only; default: all")
    command.add_argument(
        "--only", choices=Names(_axis_names), metavar="AXIS", help="this axis only: one of %(choices)s"
    )
    _fresh(command)


def _report_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("--suite", choices=SUITES, default="quick")
    command.add_argument("--out", metavar="DIR", default="out/report", help="default: %(default)s")
    command.add_argument("--jobs", type=_count, metavar="N", help="processes; default: the number of cores")
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
    _fresh(command)


def _material_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "file",
        metavar="FILE",
        help="a series (pyvisco, RepTate, columns tau, E) or data (columns t, E or w, E', E'')",
    )
    command.add_argument("--format", metavar="NAME", help="of FILE; default: told by its columns")
    command.add_argument("--poisson", type=float, default=0.5, metavar="NU", help="default: %(default)s")
    command.add_argument(
        "--modulus", type=float, metavar="E0", help="relaxed Young's modulus, where FILE has none"
    )
    command.add_argument(
        "--tolerance",
        type=float,
        metavar="X",
        help="drop branches as long as the misfit (relative, root mean square) stays below X; default: 0.001",
    )
    command.add_argument("--out", metavar="DIR", help="write material.toml, the table of a scene, there")
    command.add_argument(
        "--plot",
        action="store_true",
        help="draw material.png and material.svg, into --out or the current folder",
    )


def _solver_option(command: argparse.ArgumentParser, help: str) -> None:
    command.add_argument(
        "--solver", choices=Names(_solver_names), metavar="NAME", help=f"one of %(choices)s; {help}"
    )


def _max_steps(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--max-steps",
        type=_count,
        metavar="N",
        help="end the run after so many steps, accepted and rejected together; default: the solver's choice",
    )


def _fresh(command: argparse.ArgumentParser, replaces: bool = False) -> None:
    replaced = ", and replace the results of another scene" if replaces else ""
    command.add_argument(
        "--fresh",
        action="store_true",
        help=f"start anew{replaced}; otherwise an interrupted command with the same --out is continued",
    )
