"""A matplotlib figure as a figure of a document, with copies for the folder of the report."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from validation.drawing import export
from validation.report.document import Figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

MISSING = "No figure: a run is missing."


def picture(
    drawing: Drawing | None,
    name: str,
    caption: str,
    description: str = "",
    wide: bool = False,
    files: Mapping[str, bytes] | None = None,
) -> Figure:
    """One figure of a page, as SVG.

    Parameters
    ----------
    drawing : matplotlib Figure or None
        ``None`` if a run it shows is missing.
    name : str
        Unique within the document, letters, digits and hyphens.
    caption : str
    description : str, optional
        For readers who do not see it; default: the caption.
    wide : bool
        As wide as the page.
    files : mapping of str to bytes, optional
        Copies for the folder of the report by file name.

    Returns
    -------
    Figure
    """
    if drawing is None:
        return Figure(name, caption, wide=wide, missing=MISSING)
    return Figure(name, caption, export.svg(drawing, name, description or caption), wide, files=files or {})
