"""Figures as SVG for a page or a file, and as PNG."""

from __future__ import annotations

import io
import re
from html import escape
from typing import TYPE_CHECKING

from validation.drawing.styles import CSS_VARIABLES

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def svg(figure: Figure, name: str, description: str) -> str:
    """An ``<svg>`` element for a page: transparent, colours as CSS variables, ids made unique by ``name``."""
    import matplotlib

    stream = io.StringIO()
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": name, "font.family": "sans-serif"}):
        figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    drawn = stream.getvalue()
    drawn = drawn[drawn.index("<svg") :]
    drawn = re.sub(r"<metadata>.*?</metadata>", "", drawn, flags=re.DOTALL)
    drawn = re.sub(r'\bid="([^"]+)"', rf'id="{name}-\1"', drawn)
    drawn = re.sub(r"url\(#([^)]+)\)", rf"url(#{name}-\1)", drawn)
    drawn = re.sub(r'xlink:href="#([^"]+)"', rf'xlink:href="#{name}-\1"', drawn)
    drawn = re.sub(r'^<svg ([^>]*?)width="[^"]*"', r"<svg \1", drawn, count=1)
    drawn = re.sub(r'^<svg ([^>]*?)height="[^"]*"', r"<svg \1", drawn, count=1)
    for colour, variable in CSS_VARIABLES.items():
        drawn = drawn.replace(colour, variable)
    return drawn.replace("<svg ", f'<svg role="img" aria-label="{escape(description)}" ', 1)


def svg_file(figure: Figure) -> bytes:
    """The figure as an SVG file on white, the same bytes each time."""
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", facecolor="white", metadata={"Date": None, "Creator": None})
    return stream.getvalue()


def png(figure: Figure, dots_per_inch: int = 120) -> bytes:
    """The figure as PNG on white."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=dots_per_inch, facecolor="white", metadata={"Software": None})
    return stream.getvalue()
