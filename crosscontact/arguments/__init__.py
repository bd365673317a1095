"""The arguments of the command line, a module a command.

A module has ``add_arguments(command)``, which adds its arguments to a parser, and
``carry_out(options, jobs)``, which hands them to what is in ``crosscontact.commands`` and returns the exit
code. Nothing heavy is imported before an option is used, or a command carried out, that needs it.
"""

from __future__ import annotations

import argparse
from typing import NoReturn

import crosscontact
from crosscontact.arguments import (
    compare,
    exam,
    fields,
    fit,
    judge,
    material,
    report,
    scenes,
    solve,
    stability,
    study,
    sweep,
)

COMMANDS = (
    ("scenes", scenes, "list the built-in scenes"),
    ("solve", solve, "run one solver on one scene"),
    ("compare", compare, "run all solvers on scenes; exit 1 when out of tolerance"),
    ("study", study, "refinement ladders and error against run time, every solver"),
    ("fields", fields, "stresses, energies and losses in the body, for ParaView"),
    ("sweep", sweep, "one scene over many values of its keys, as a data set and maps"),
    ("stability", stability, "stiff and extreme cases: where each solver holds"),
    ("report", report, "run a suite of built-in scenes, check and draw everything"),
    ("material", material, "read a Prony series, or fit one to measured moduli"),
    ("exam", exam, "scenes for other codes to answer: export, answer, reproduce"),
    ("judge", judge, "grade the traces of other codes; exit 1 when one fails"),
    ("fit", fit, "material and adhesion from measured curves, with errors"),
)
"""Name, module and one line of help of every command, in the order of ``--help``."""


class _Parser(argparse.ArgumentParser):
    """Reports bad input in one line."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {' '.join(message.split())}\n")


class _Version(argparse.Action):
    """Looks the version up where it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *given: object) -> NoReturn:
        print(f"crosscontact {crosscontact.__version__}")
        parser.exit()


def parser() -> argparse.ArgumentParser:
    """The parser of the whole command line; ``carry_out`` of what it parses runs the command."""
    top = _Parser(
        prog="crosscontact",
        description="Adhesive viscoelastic contact of a rigid indenter, solved independently and compared.",
    )
    top.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = top.add_subparsers(dest="command", metavar="COMMAND")
    for name, module, text in COMMANDS:
        command = commands.add_parser(name, help=text)
        module.add_arguments(command)
        command.set_defaults(carry_out=module.carry_out)
    return top
