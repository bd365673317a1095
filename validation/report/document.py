"""A report before it has a form: sections of paragraphs, lists, tables and figures.

Each kind of evidence builds its own; HTML, Markdown and terminal have one renderer each.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar

from validation.drawing.figure import svg

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

ABSENT = "–"  # a cell without a value
MISSING = "No figure: a run is missing."
_NUMBER = re.compile(r"[≤≥<+−-]*\s?\d[\d.,]*(e[+-]?\d+)?( s| %)?|[+-]?inf|nan")


@dataclass(frozen=True)
class VerdictCell:
    """A word marked as good or bad; ``passed`` is ``None`` where it is neither."""

    text: str
    passed: bool | None

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True)
class LinkCell:
    """A word that leads to a section by its ``anchor``."""

    text: str
    anchor: str

    def __str__(self) -> str:
        return self.text


Cell = str | VerdictCell | LinkCell
Record = Mapping[str, Cell]  # a row by the titles of its columns


@dataclass(frozen=True)
class Paragraph:
    """Plain text; ``passed`` marks a whole verdict."""

    kind: ClassVar[str] = "paragraph"
    text: str
    passed: bool | None = None


@dataclass(frozen=True)
class Bullets:
    """A list of sentences."""

    kind: ClassVar[str] = "bullets"
    items: tuple[str, ...]


@dataclass(frozen=True)
class DataTable:
    """Rows of cells under a head; a head of empty strings is not shown.

    Cells of columns named in ``unbroken`` stay on one line. With ``numeric``, columns that mostly hold
    numbers are aligned to the right.
    """

    kind: ClassVar[str] = "table"
    head: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    caption: str = ""
    unbroken: tuple[str, ...] = ()
    numeric: bool = True

    @classmethod
    def of(cls, records: Iterable[Record], caption: str = "", unbroken: tuple[str, ...] = ()) -> DataTable:
        """A table of records with the same keys, which become its head."""
        rows = list(records)
        head = tuple(rows[0]) if rows else ()
        return cls(head, tuple(tuple(row.values()) for row in rows), caption, unbroken)

    @property
    def columns(self) -> tuple[str, ...]:
        """``number``, ``unbroken`` or ``text`` for each column; numbers if most of its cells are."""
        return tuple(self._column(index, title) for index, title in enumerate(self.head))

    @property
    def texts(self) -> list[tuple[str, ...]]:
        """Head and rows as text."""
        return [self.head, *(tuple(map(str, row)) for row in self.rows)]

    def _column(self, index: int, title: str) -> str:
        if title in self.unbroken:
            return "unbroken"
        cells = [text for row in self.rows if (text := str(row[index])) not in ("", ABSENT)]
        numbers = sum(_NUMBER.fullmatch(text) is not None for text in cells)
        return "number" if self.numeric and 2 * numbers > len(cells) else "text"


@dataclass(frozen=True)
class Figure:
    """One picture: an ``<svg>`` element whose colours are CSS variables, or a PNG or GIF file.

    From its ``name``, unique in the document, ids inside an SVG picture are made; ``missing`` says why there
    is no picture. Copies, ``files`` by their names, go to ``figures/`` beside the document; Markdown shows
    the first. A ``link`` stands below the picture instead of the caption, a ``verdict`` in its corner.
    """

    name: str
    caption: str
    picture: str | bytes = ""
    wide: bool = False
    missing: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict)
    link: LinkCell | None = None
    verdict: VerdictCell | None = None


@dataclass(frozen=True)
class Figures:
    """Pictures side by side; ``small`` ones as many as a page is wide, on paper too."""

    kind: ClassVar[str] = "figures"
    figures: tuple[Figure, ...]
    small: bool = False


@dataclass(frozen=True)
class Fold:
    """Parts that a page shows on demand; other forms show them under the title."""

    kind: ClassVar[str] = "fold"
    title: str
    parts: tuple[Part, ...]
    anchor: str = ""


@dataclass(frozen=True)
class Section:
    """A heading and its parts; sections within sections are headings of a lower rank.

    A page shows only the heading of one that is ``folded``, until it is opened.
    """

    kind: ClassVar[str] = "section"
    title: str
    parts: tuple[Part, ...]
    anchor: str = ""
    verdict: VerdictCell | None = None
    folded: bool = False


Part = Paragraph | Bullets | DataTable | Figures | Fold | Section


@dataclass(frozen=True)
class Document:
    """A whole report: what stands at its head, and its sections.

    ``contents_depth`` is the number of ranks of headings in a page's table of contents.
    """

    title: str
    lead: tuple[Paragraph, ...]
    parts: tuple[Part, ...]
    contents_depth: int = 1


def figures_of(parts: tuple[Part, ...]) -> Iterator[Figure]:
    """All figures of some parts, in order."""
    for part in parts:
        if isinstance(part, Figures):
            yield from part.figures
        elif isinstance(part, (Section, Fold)):
            yield from figures_of(part.parts)


def with_drawing(figure: Figure, drawing: Drawing | None, description: str = "") -> Figure:
    """The figure with its picture as SVG; without a drawing with the reason, the figure's own or ``MISSING``.

    ``description`` is for readers who do not see the picture; without one, the caption is.
    """
    if drawing is None:
        return replace(figure, missing=figure.missing or MISSING)
    return replace(figure, picture=svg(drawing, figure.name, description or figure.caption))


def valid_id(text: str) -> str:
    """Letters, digits and hyphens of any text, as ids in a page are."""
    return "".join(c if c.isascii() and c.isalnum() else "-" for c in text)


def number(value: object, digits: int = 6) -> str:
    """A number with enough digits to see a difference, ``ABSENT`` for ``None``; words as they are."""
    if value is None:
        return ABSENT
    return format(value, f".{digits}g") if isinstance(value, float) else str(value)


def counted(count: int, name: str) -> str:
    """A number of things, whose plural ends in s."""
    return f"{count} {name}{'' if count == 1 else 's'}"


def formatted(value: float | None, specification: str) -> str:
    """A number in the given format, ``ABSENT`` for ``None``."""
    return ABSENT if value is None else format(value, specification)


def plain(name: str) -> str:
    """The name of an observable or a counter in words."""
    return name.replace("_", " ")


def passed_or_not(passed: bool) -> VerdictCell:
    """The verdict of a check or a scene."""
    return VerdictCell("pass" if passed else "FAIL", passed)
