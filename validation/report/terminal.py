"""Parts of a document as plain text for a terminal, tables in aligned columns."""

from __future__ import annotations

from validation.report.document import Bullets, DataTable, Figures, Paragraph, Part

INDENT = "  "


def text(part: Part) -> str:
    """One part; sections with their title on the first line, figures left out."""
    return "\n".join(lines(part)) + "\n"


def lines(part: Part) -> list[str]:
    """The same line by line."""
    if isinstance(part, Paragraph):
        return [part.text]
    if isinstance(part, Bullets):
        return [f"- {item}" for item in part.items]
    if isinstance(part, DataTable):
        return _table(part)
    if isinstance(part, Figures):
        return []
    return [part.title, *(line for one in part.parts for line in lines(one))]


def _table(table: DataTable) -> list[str]:
    rows = [table.head, *(tuple(map(str, row)) for row in table.rows)]
    kinds = table.columns
    widths = [max(len(row[column]) for row in rows) for column in range(len(kinds))]
    aligned = []
    for row in rows:
        cells = [
            cell.rjust(width) if kind == "number" else cell.ljust(width)
            for cell, width, kind in zip(row, widths, kinds, strict=True)
        ]
        aligned.append((INDENT + "  ".join(cells)).rstrip())
    return ([table.caption] if table.caption else []) + aligned
