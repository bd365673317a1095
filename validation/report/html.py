"""A document as one HTML page that loads nothing: for screen, phone and paper, light and dark.

Beside the text stands a table of contents that stays in sight. A script of the page sorts tables by a column
and opens the fold that a link leads to; without it the page shows the same. A document too large for one page
has its folded sections on pages of their own.
"""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined

from validation.report.document import Document, Fold, Paragraph, Part, Section, VerdictCell, valid_id

INDEX = "index.html"
FOLDER = "pages"
"""Of the pages that folded sections have for themselves."""
MOST_BYTES = 1_900_000
"""Of the first page: below two megabytes, which a telephone loads in seconds and a mail still carries."""
ON_PAGES = "What passed has pages of its own, to which the overview and the contents lead."


@dataclass(frozen=True)
class ContentsEntry:
    """A line of the table of contents, and those below it."""

    title: str
    address: str
    verdict: VerdictCell | None
    entries: tuple[ContentsEntry, ...]


def pages(document: Document) -> dict[str, str]:
    """All pages of a document, by their paths: ``index.html``, and ``pages/ANCHOR.html`` of folded sections.

    The latter only where the first would have more than ``MOST_BYTES``. Links work from a folder as from a
    server.
    """
    whole = text(document)
    moved = tuple(
        part for part in document.parts if isinstance(part, Section) and part.folded and part.anchor
    )
    if len(whole.encode()) <= MOST_BYTES or not moved:
        return {INDEX: whole}
    addresses = {part.anchor: f"{FOLDER}/{part.anchor}.html" for part in moved}
    lead = (*document.lead, Paragraph(ON_PAGES))
    found = {INDEX: _page(replace(document, lead=lead), addresses)}
    for part in moved:
        verdict = () if part.verdict is None else (Paragraph(part.verdict.text, part.verdict.passed),)
        found[addresses[part.anchor]] = _page(Document(part.title, verdict, part.parts), {}, document.title)
    return found


def text(document: Document) -> str:
    """The whole document as one page, style sheet and script inside it."""
    return _page(document, {})


def _page(document: Document, addresses: Mapping[str, str], up: str = "") -> str:
    """A page of a document, without the parts that have ``addresses`` elsewhere, by their anchors.

    ``up`` is the title of the first page, where this is another.
    """
    listed = _with_anchors(document.parts, document.contents_depth, set())
    parts = tuple(part for part in listed if getattr(part, "anchor", "") not in addresses)
    page = (
        _templates()
        .get_template("document.html")
        .render(
            document=replace(document, parts=parts),
            contents=tuple(_entries(listed, document.contents_depth, addresses)),
            addresses=addresses,
            up=up,
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


def _entries(parts: Iterable[Part], depth: int, addresses: Mapping[str, str]) -> Iterator[ContentsEntry]:
    for part in parts:
        if isinstance(part, (Section, Fold)) and depth > 0:
            below = tuple(_entries(part.parts, depth - 1, {})) if part.anchor not in addresses else ()
            address = addresses.get(part.anchor, f"#{part.anchor}")
            yield ContentsEntry(part.title, address, getattr(part, "verdict", None), below)


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
