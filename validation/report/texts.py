"""A document, or a part of it, as text: for a terminal, and as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from validation.report import document as doc

INDENT = "  "


def for_terminal(part: doc.Part) -> str:
    """One part for a terminal: sections with their title on the first line, figures left out."""
    return "\n".join(lines(part)) + "\n"


def lines(part: doc.Part) -> list[str]:
    """One part, line by line."""
    if isinstance(part, doc.Paragraph):
        return [part.text]
    if isinstance(part, doc.Bullets):
        return [f"- {item}" for item in part.items]
    if isinstance(part, doc.DataTable):
        return _aligned_table(part)
    if isinstance(part, doc.Figures):
        return []
    return [part.title, *(line for one in part.parts for line in lines(one))]


def aligned(rows: Sequence[Sequence[str]], kinds: Sequence[str] = ()) -> list[str]:
    """Rows in aligned columns, those of the kind "number" to the right."""
    columns = list(zip(*rows, strict=True))
    widths = [max(map(len, column)) for column in columns]
    kinds = kinds or ["text"] * len(columns)
    return [
        INDENT
        + "  ".join(
            cell.rjust(width) if kind == "number" else cell.ljust(width)
            for cell, width, kind in zip(row, widths, kinds, strict=True)
        ).rstrip()
        for row in rows
    ]


def _aligned_table(table: doc.DataTable) -> list[str]:
    return ([table.caption] if table.caption else []) + aligned(table.texts, table.columns)


def markdown(document: doc.Document) -> str:
    """The whole document, as in the summary of a CI job: figures as links, folded parts in full."""
    lines = [f"# {document.title}", ""]
    for part in (*document.lead, *document.parts):
        lines += _part(part, 2)
    return "\n".join(lines).rstrip() + "\n"


def _part(part: doc.Part, level: int) -> list[str]:
    """Lines of one part, an empty one last."""
    if isinstance(part, doc.Paragraph):
        return [f"**{_line(part.text)}**" if part.passed is False else _line(part.text), ""]
    if isinstance(part, doc.Bullets):
        return [*(f"- {_line(item)}" for item in part.items), ""]
    if isinstance(part, doc.DataTable):
        return _table(part)
    if isinstance(part, doc.Figures):
        shown = [(one.caption, name) for one in part.figures for name in list(one.files)[:1]]
        return [line for caption, name in shown for line in (f"![{caption}](figures/{name})", "")]
    title = f"{'#' * level} {_line(part.title)}"
    verdict = getattr(part, "verdict", None)
    lines = [title if verdict is None else f"{title}: {_cell(verdict)}", ""]
    for one in part.parts:
        lines += _part(one, level + 1)
    return lines


def _table(table: doc.DataTable) -> list[str]:
    if not table.head:
        return []
    rule = ("---:" if kind == "number" else "---" for kind in table.columns)
    return [
        *((f"**{table.caption}**", "") if table.caption else ()),
        _row(table.head),
        f"|{'|'.join(rule)}|",
        *map(_row, table.rows),
        "",
    ]


def _row(cells: Iterable[doc.Cell]) -> str:
    return f"| {' | '.join(map(_cell, cells))} |"


def _cell(cell: doc.Cell) -> str:
    shown = _line(str(cell)).replace("|", "\\|")
    return f"**{shown}**" if isinstance(cell, doc.VerdictCell) and cell.passed is False else shown


def _line(text: str) -> str:
    return " ".join(text.split())
