"""The reference of the command line, from its parser."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from crosscontact.arguments import parser


def page() -> str:
    """Every command with its usage, arguments and options."""
    top = parser()
    (commands,) = (one for one in top._actions if isinstance(one, argparse._SubParsersAction))
    helps = {choice.dest: choice.help for choice in commands._choices_actions}
    lines = [
        "# Commands",
        "",
        "Written from the parser; `crosscontact COMMAND --help` says the same.",
        "",
    ]
    lines += ["| command | |", "|---|---|"]
    lines += [f"| [`{name}`](#{name}) | {_cell(helps.get(name))} |" for name in commands.choices]
    for name, command in commands.choices.items():
        lines += ["", f"({name})=", f"## {name}", "", f"{_sentence(helps.get(name))}", ""]
        lines += ["```text", _usage(command), "```", "", *_options(command)]
    return "\n".join(lines) + "\n"


def _usage(command: argparse.ArgumentParser) -> str:
    words = command.format_usage().removeprefix("usage: ").split()
    lines, line = [], ""
    for word in words:
        if line and len(line) + len(word) > 90:
            lines.append(line)
            line = "   "
        line += f" {word}" if line else word
    return "\n".join([*lines, line])


def _options(command: argparse.ArgumentParser) -> Iterator[str]:
    formatter = command._get_formatter()
    actions = [action for action in command._actions if not isinstance(action, argparse._HelpAction)]
    if actions:
        yield from ("| argument | |", "|---|---|")
    for action in actions:
        values = "" if action.nargs == 0 else formatter._format_args(action, _placeholder(action))
        names = ", ".join(f"`{name}{f' {values}' if values else ''}`" for name in action.option_strings)
        yield f"| {names or f'`{values}`'} | {_cell(formatter._expand_help(action) if action.help else '')} |"


def _placeholder(action: argparse.Action) -> str:
    if action.choices is not None and action.metavar is None:
        return "|".join(map(str, action.choices))
    return action.metavar if isinstance(action.metavar, str) else action.dest.upper()


def _cell(text: str | None) -> str:
    return " ".join((text or "").split()).replace("|", "\\|").replace("<", "&lt;")


def _sentence(text: str | None) -> str:
    shown = _cell(text)
    return f"{shown[:1].upper()}{shown[1:]}." if shown else ""
