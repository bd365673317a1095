"""A document as one HTML page that loads nothing: for screen, phone and paper, light and dark.

Beside the text stands a table of contents that stays in sight. A script of the page sorts tables by a column
and opens the fold that a link leads to; without it the page shows the same.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined

from validation.report.document import Document, Fold, Part, Section, VerdictCell
from validation.report.pictures import valid_id


@dataclass(frozen=True)
class ContentsEntry:
    """A line of the table of contents, and those below it."""

    title: str
    anchor: str
    verdict: VerdictCell | None
    entries: tuple[ContentsEntry, ...]


def text(document: Document) -> str:
    """The whole page, style sheet and script inside it."""
    parts = _with_anchors(document.parts, document.contents_depth, set())
    page = (
        _templates()
        .get_template("document.html")
        .render(
            document=replace(document, parts=parts),
            contents=tuple(_entries(parts, document.contents_depth)),
            style=source("style.css"),
            script=source("script.js"),
        )
    )
    return _rules_once(page)


def fragment(parts: Iterable[Part], level: int) -> str:
    """Some parts as a piece of a page that has the style and the script of :func:`source`.

    ``level`` is the rank of the first headings.
    """
    macro = _templates().get_template("parts.html").module.part  # type: ignore[attr-defined]
    return _rules_once("\n".join(str(macro(part, level)) for part in parts))


def source(name: str) -> str:
    """The style sheet or the script of every page."""
    templates = _templates()
    assert templates.loader is not None
    return templates.loader.get_source(templates, name)[0]


def _rules_once(page: str) -> str:
    """The page with each rule of its pictures stated once, where it is first needed."""
    stated: set[str] = set()

    def new(found: re.Match[str]) -> str:
        rules = [rule for rule in re.findall(r"[^{}]+\{[^}]*\}", found.group(2)) if rule not in stated]
        stated.update(rules)
        return f"{found.group(1)}{''.join(rules)}</style>" if rules else ""

    return re.sub(r'(<style type="text/css">)(.*?)</style>', new, page, flags=re.DOTALL)


def _with_anchors(parts: Iterable[Part], depth: int, taken: set[str]) -> tuple[Part, ...]:
    """The parts, of which those in the table of contents have anchors, each another."""
    anchored: list[Part] = []
    for part in parts:
        if isinstance(part, (Section, Fold)) and depth > 0:
            below = _with_anchors(part.parts, depth - 1, taken)
            part = replace(part, parts=below, anchor=part.anchor or _free_anchor(part.title, taken))
        anchored.append(part)
    return tuple(anchored)


def _free_anchor(title: str, taken: set[str]) -> str:
    name = f"part-{valid_id(title)}"
    while name in taken:
        name += "-"
    taken.add(name)
    return name


def _entries(parts: Iterable[Part], depth: int) -> Iterator[ContentsEntry]:
    for part in parts:
        if isinstance(part, (Section, Fold)) and depth > 0:
            below = tuple(_entries(part.parts, depth - 1))
            yield ContentsEntry(part.title, part.anchor, getattr(part, "verdict", None), below)


@cache
def _templates() -> Environment:
    made = Environment(
        loader=PackageLoader("validation.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["data_address"] = _data_address
    return made


def _data_address(picture: bytes) -> str:
    """A PNG or GIF file as part of the page."""
    kind = "gif" if picture.startswith(b"GIF") else "png"
    return f"data:image/{kind};base64,{base64.b64encode(picture).decode('ascii')}"
