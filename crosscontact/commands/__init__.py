"""The commands, one file each: its options as data (``OPTIONS``, or ``ACTIONS`` of those that have some) and
what it does (``run``).

The file of a command is imported when the command is used, and then whole: the list of commands, the version
and the built-in scenes come at once.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any, NoReturn

import crosscontact

COMMANDS = {
    "scenes": "list the built-in scenes",
    "solve": "run one solver on one scene",
    "compare": "run all solvers on scenes; exit 1 when out of tolerance",
    "study": "refinement ladders and error against run time, every solver",
    "fields": "stresses, energies and losses in the body, for ParaView",
    "sweep": "one scene over many values of its keys, as a data set and maps",
    "explore": "a page with sliders for up to three keys of a scene",
    "stability": "stiff and extreme cases: where each solver holds",
    "report": "run a suite of built-in scenes, check and draw everything",
    "material": "read a Prony series, or fit one to measured moduli",
    "exam": "scenes for other codes to answer: export, answer, reproduce",
    "judge": "grade the traces of other codes; exit 1 when one fails",
    "curve": "what measured curves show of themselves: contact, pull-off, background",
    "fit": "material and adhesion from measured curves, with errors",
}
"""One line of help of every command, in the order of ``--help``."""


class Parser(argparse.ArgumentParser):
    """Reports bad input in one line; takes the options of a command from its file when it is used."""

    def __init__(self, *, command: str = "", **settings: Any) -> None:
        super().__init__(**settings)
        self._command = command

    def _load(self) -> None:
        if not self._command:
            return
        module = import_module(f"crosscontact.commands.{self._command}")
        self._command = ""
        self._add(getattr(module, "OPTIONS", {}))
        self.set_defaults(run=module.run)
        if hasattr(module, "ACTIONS"):
            actions = self.add_subparsers(dest="action", metavar="ACTION", required=True)
            for name, (text, options) in module.ACTIONS.items():
                actions.add_parser(name, help=text)._add(options)

    def _add(self, options: Mapping[str, Mapping[str, Any]]) -> None:
        for name, settings in options.items():
            self.add_argument(name, **settings)

    def parse_known_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> Any:  # type: ignore[override]
        self._load()
        return super().parse_known_args(args, namespace)

    def format_help(self) -> str:
        self._load()
        return super().format_help()

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: error: {' '.join(message.split())}\n")


class _Version(argparse.Action):
    """Looks the version up where it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *given: object) -> NoReturn:
        print(f"crosscontact {crosscontact.__version__}")
        parser.exit()


def parser() -> Parser:
    """The parser of the whole command line; ``run`` of what it parses carries the command out."""
    top = Parser(
        prog="crosscontact",
        description="Adhesive viscoelastic contact of a rigid indenter, solved independently and compared.",
    )
    top.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = top.add_subparsers(dest="command", metavar="COMMAND")
    for name, text in COMMANDS.items():
        commands.add_parser(name, help=text, command=name)
    return top
