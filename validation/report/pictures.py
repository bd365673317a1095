"""matplotlib figures as figures of a document."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from validation.drawing import export
from validation.report.document import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

MISSING = "No figure: a run is missing."


def with_drawing(figure: Figure, drawing: Drawing | None, description: str = "") -> Figure:
    """The figure with its picture as SVG; without a drawing with the reason, the figure's own or ``MISSING``.

    ``description`` is for readers who do not see the picture; without one, the caption is.
    """
    if drawing is None:
        return replace(figure, missing=figure.missing or MISSING)
    return replace(figure, picture=export.svg(drawing, figure.name, description or figure.caption))


def valid_id(text: str) -> str:
    """Letters, digits and hyphens of any text, as ids in a page are."""
    return "".join(c if c.isascii() and c.isalnum() else "-" for c in text)
