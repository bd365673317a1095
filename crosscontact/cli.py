"""The command line: ``crosscontact scenes | solve | compare | study | fields | stability | report``.

Parser and dispatch; what a command does is in ``commands``, one file each. Exit codes: 0 all well; 1 a check
failed or a run did not finish, interrupted ones included; 2 bad input, reported in one line. Nothing heavy is
imported until a command needs it.
"""

from __future__ import annotations

import argparse
import math
import os
import sys
from typing import NoReturn

from crosscontact import __version__
from crosscontact.commands import scenes
from crosscontact.limits import SMALLEST_RESOLUTION
from validation.execution.memory import keep_freed
from validation.execution.signals import interrupting
from validation.scenes import SUITES

# The dense systems here are small: more threads than one cost time, and results must not depend on them.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

AXIS_NAMES = (
    "contrast",
    "relaxation-time",
    "spectrum",
    "poisson",
    "speed",
    "step",
    "adhesion",
    "indenter",
    "loading",
    "dead-load",
    "scale",
)
"""Axes of the stability matrix, as ``validation.stability.matrix`` has them, which takes NumPy."""


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


def _solver(text: str) -> str:
    from crosscontact import registry

    if text not in registry.names():
        names = ", ".join(registry.names())
        raise argparse.ArgumentTypeError(f"invalid choice: {text!r:.40} (choose from {names})")
    return text


def _solvers(text: str) -> tuple[str, ...]:
    from crosscontact import registry

    try:
        return registry.chosen([name.strip() for name in text.split(",")], "")
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _jobs(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: a whole number >= 1")
    return int(text)


def _bulk(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 2.0 / 3.0 < value < 1e6:
        raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: a number above 2/3, below 1e6")
    return value


def _ratio(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 1e-8 <= value <= 0.2:
        raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: a number from 1e-8 to 0.2")
    return value


def _time(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise argparse.ArgumentTypeError(f"got {text!r:.40}; allowed: times >= 0")
    return value


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
    _stability_arguments(
        commands.add_parser("stability", help="stiff and extreme cases: where each solver holds")
    )
    _report_arguments(
        commands.add_parser("report", help="run a suite of built-in scenes, check and draw everything")
    )
    return top


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
    _fresh(command)


def _compare_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("scenes", metavar="SCENE", nargs="+", help="TOML files or built-in names")
    command.add_argument(
        "--solvers",
        type=_solvers,
        metavar="A,B",
        help="these only, the reference among them; default: all",
    )
    command.add_argument("--out", metavar="DIR", help="write the report and every run there")
    command.add_argument("--jobs", type=_jobs, metavar="N", help="processes; default: the number of cores")
    _fresh(command)


def _study_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("scenes", metavar="SCENE", nargs="+", help="TOML files or built-in names")
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and figures there")
    command.add_argument("--jobs", type=_jobs, metavar="N", help="processes for what is not timed")
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
        help="instead: steps, time and error of every solver with process zones of these ratios to "
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
        type=_jobs,
        default=0,
        metavar="N",
        help="every N-th accepted step, the start included; not drawn",
    )
    command.add_argument(
        "--resolution", type=_resolution, metavar="N", help="divisions per process zone, as for solve"
    )
    command.add_argument("--out", metavar="DIR", help="default: out/fields/SCENE")
    drawn = command.add_argument_group("figures", "sections are drawn at all moments; where asked for, also")
    drawn.add_argument("--strip", action="store_true", help="the key moments of the run side by side")
    drawn.add_argument("--animate", action="store_true", help="the whole run as an animated GIF")
    drawn.add_argument("--revolve", action="store_true", help="the body in three dimensions")
    drawn.add_argument(
        "--show", action="store_true", help="the last moment in a window, where there is a screen"
    )
    drawn.add_argument(
        "--quantity",
        nargs="+",
        metavar="Q",
        help="what to draw; default: von-mises stress-zz dissipation-rate",
    )
    drawn.add_argument("--no-figures", action="store_true", help="files for ParaView only")


def _stability_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("--out", metavar="DIR", help="write page, Markdown, JSON and heat maps there")
    command.add_argument("--jobs", type=_jobs, metavar="N", help="processes; default: the number of cores")
    _solver_option(command, "this one only; default: all")
    command.add_argument("--only", choices=AXIS_NAMES, metavar="AXIS", help=f"one of {', '.join(AXIS_NAMES)}")
    _fresh(command)


def _report_arguments(command: argparse.ArgumentParser) -> None:
    command.add_argument("--suite", choices=SUITES, default="quick")
    command.add_argument("--out", metavar="DIR", default="out/report", help="default: %(default)s")
    command.add_argument("--jobs", type=_jobs, metavar="N", help="processes; default: the number of cores")
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


def _solver_option(command: argparse.ArgumentParser, help: str) -> None:
    command.add_argument("--solver", type=_solver, metavar="NAME", help=help)


def _fresh(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--fresh",
        action="store_true",
        help="start anew; otherwise an interrupted command with the same --out is continued",
    )


def main(arguments: list[str] | None = None) -> int:
    """Run the command line and return the exit code."""
    options = parser().parse_args(arguments)
    if options.command is None:
        parser().print_help()
        return 0
    try:
        with interrupting():
            code = _run(options)
            sys.stdout.flush()
            return code
    except KeyboardInterrupt:
        print("crosscontact: interrupted", file=sys.stderr)
        return 1
    except BrokenPipeError:  # the reader of our output has gone, e.g. `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        return 0
    except Exception as error:
        from contact_scene.errors import SceneError

        if isinstance(error, SceneError):
            print(f"crosscontact: error: {error}", file=sys.stderr)
            return 2
        if isinstance(error, OSError):
            print(f"crosscontact: error: {' '.join(str(error).split())}", file=sys.stderr)
            return 1
        raise


def _run(options: argparse.Namespace) -> int:
    """Run the command, alone in its folder."""
    if getattr(options, "out", None) is None:
        return _command(options)
    from validation.execution.folder_lock import locked_folder

    with locked_folder(options.out):
        return _command(options)


def _command(options: argparse.Namespace) -> int:
    keep_freed()
    jobs = getattr(options, "jobs", None) or _available_cores()
    if options.command == "scenes":
        return scenes.run()
    from crosscontact import registry

    if options.command == "solve":
        from crosscontact.commands import solve

        return solve.run(
            options.scene,
            options.solver or registry.REFERENCE,
            options.resolution,
            options.out,
            fresh=options.fresh,
            estimate=options.estimate,
            plot=options.plot,
        )
    if options.command == "compare":
        from crosscontact.commands import compare

        solvers = options.solvers or registry.names()
        return compare.run(options.scenes, solvers, options.out, jobs, options.fresh)
    if options.command == "study" and options.poisson is not None:
        from crosscontact.commands import poisson

        return poisson.run(options.scenes, options.poisson, options.out, jobs)
    if options.command == "study" and options.zones is not None:
        from crosscontact.commands import zones

        return zones.run(options.scenes, options.zones, options.out)
    if options.command == "study":
        from crosscontact.commands import study

        return study.run(options.scenes, options.out, jobs, options.fresh)
    if options.command == "stability":
        from crosscontact.commands import stability

        return stability.run(options.out, jobs, options.solver, options.only, options.fresh)
    if options.command == "fields":
        from crosscontact.commands import fields
        from validation.fields.figures.figure_set import of_options

        return fields.run(
            options.scene,
            options.at,
            options.pull_off,
            options.every,
            options.resolution,
            options.out,
            of_options(options),
        )
    from crosscontact.commands import report

    return report.run(
        options.suite, options.out, jobs, options.estimates, options.baseline, options.fresh, options.fields
    )


def _available_cores() -> int:
    """Cores this process may use, not those of the machine."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


if __name__ == "__main__":
    sys.exit(main())
