"""Parts of a document as plain text for a terminal, tables in aligned columns."""

from __future__ import annotations

from collections.abc import Sequence

from validation.report.document import Bullets, DataTable, Figures, Paragraph, Part

INDENT = "  "


def text(part: Part) -> str:
    """One part; sections with their title on the first line, figures left out."""
    return "\n".join(lines(part)) + "\n"


def lines(part: Part) -> list[str]:
    """One part, line by line."""
    if isinstance(part, Paragraph):
        return [part.text]
    if isinstance(part, Bullets):
        return [f"- {item}" for item in part.items]
    if isinstance(part, DataTable):
        return _table(part)
    if isinstance(part, Figures):
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


def _table(table: DataTable) -> list[str]:
    return ([table.caption] if table.caption else []) + aligned(table.texts, table.columns)
