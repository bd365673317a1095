"""The reference of the Python interface: every public name of ``crosscontact``, from its docstring."""

from __future__ import annotations

import inspect
from collections.abc import Iterator

import crosscontact as cc

GROUPS = {
    "crosscontact": "Solving, comparing, results",
    "contact_scene.scene": "Scenes",
    "contact_scene.indenter": "Indenters",
    "contact_scene.adhesion": "Adhesion",
    "contact_scene.load": "Loading",
    "contact_scene.material": "Materials",
    "contact_scene.trace": "Traces",
    "": "Further names",
}
"""Headings by the beginning of the name of the module that defines a name."""


def page() -> str:
    """One entry a name, grouped by what it is about."""
    members: dict[str, list[str]] = {heading: [] for heading in GROUPS.values()}
    for name in cc.__all__:
        if not name.startswith("__"):
            members[_heading(getattr(cc, name))].append(name)
    lines = ["# Python interface", "", "All of it is found in the module `crosscontact`.", ""]
    for heading, names in members.items():
        if names:
            lines += [f"## {heading}", "", *(line for name in names for line in _entry(name))]
    return "\n".join(lines) + "\n"


def _heading(thing: object) -> str:
    module = getattr(thing, "__module__", "")
    return next(heading for start, heading in GROUPS.items() if module.startswith(start))


def _entry(name: str) -> Iterator[str]:
    thing = getattr(cc, name)
    yield "```{eval-rst}"
    if inspect.isclass(thing):
        yield f".. autoclass:: crosscontact.{name}"
        if not issubclass(thing, BaseException):
            yield "   :members:"
    elif callable(thing):
        yield f".. autofunction:: crosscontact.{name}"
    else:
        yield f".. autodata:: crosscontact.{name}"
    yield "```"
    yield ""
