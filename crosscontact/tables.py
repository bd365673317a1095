"""Tables as lines of text and as HTML, and what stands in their cells."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape


def cell(value: object) -> str:
    """A number in six digits; words as they are."""
    return "-" if value is None else format(value, ".6g") if isinstance(value, float) else str(value)


def aligned(rows: list[tuple[str, ...]]) -> list[str]:
    """The rows of a table as lines, columns aligned."""
    widths = [
        max(24 if column == 0 else 16, *map(len, cells))
        for column, cells in enumerate(zip(*rows, strict=True))
    ]
    return [
        "  " + "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def html_table(rows: Sequence[tuple[str, ...]]) -> str:
    """The rows of a table as HTML; the first is its heading."""
    head, *body = rows
    cells = "".join(f"<th>{escape(name)}</th>" for name in head)
    lines = "".join(f"<tr>{''.join(f'<td>{escape(text)}</td>' for text in row)}</tr>" for row in body)
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{lines}</tbody></table>"
