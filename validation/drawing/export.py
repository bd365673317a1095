"""Figures as SVG for a page or a file, and as PNG."""

from __future__ import annotations

import hashlib
import io
import re
from html import escape
from itertools import pairwise
from typing import TYPE_CHECKING

from validation.drawing.styles import CSS_VARIABLES, GRID

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DECIMALS = 1
"""Of a coordinate on a page, in points: rounded by at most a twentieth of a point, a tenth of the thinnest
line."""
SIMPLIFIED = 0.2
"""Distance in points by which a line on a page may miss points it is drawn through; a fifth of the thinner
lines of the solvers."""


def svg(figure: Figure, name: str, description: str) -> str:
    """An ``<svg>`` element for a page: transparent, colours as CSS variables, ids made unique by ``name``."""
    import matplotlib

    stream = io.StringIO()
    with matplotlib.rc_context(
        {
            "svg.fonttype": "none",
            "svg.hashsalt": name,
            "font.family": "sans-serif",
            "path.simplify_threshold": SIMPLIFIED,
        }
    ):
        figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    drawn = stream.getvalue()
    drawn = drawn[drawn.index("<svg") :]
    drawn = _compact(re.sub(r"<metadata>.*?</metadata>", "", drawn, flags=re.DOTALL))
    for size in ("width", "height"):
        drawn = re.sub(rf'^<svg ([^>]*?){size}="[^"]*"', r"<svg \1", drawn, count=1)
    for colour, variable in CSS_VARIABLES.items():
        drawn = drawn.replace(colour, variable)
    return drawn.replace("<svg ", f'<svg role="img" aria-label="{escape(description)}" ', 1)


def _compact(drawn: str) -> str:
    """The same picture in a third of the bytes.

    Numbers are short, ids that nothing refers to are gone, and the styles of elements are classes, named
    alike on the whole page.
    """
    drawn = re.sub(r"font-family: 'DejaVu Sans'[^;\"]*", "font-family: sans-serif", drawn)
    drawn = re.sub(r"\s*transform=\"rotate\(-0 [^)]*\)\"", "", drawn)
    drawn = re.sub(r"(?<=[\s(,\"])(-?\d+\.\d{3,})(?=[\s),\"])", _rounded, drawn)
    drawn = re.sub(r"(?<=\d) ?\n(?=[LCMQ] )", "", drawn).replace(" \n", " ")
    drawn = re.sub(r' d="M ([-\d. \nLM]+)"', _with_relative_steps, drawn)
    drawn = re.sub(
        rf' clip-path="[^"]*"(?= style="fill: none; stroke: {GRID};)', "", drawn
    )  # ends at the axes
    drawn = drawn.replace("xlink:href", "href").replace(' xmlns:xlink="http://www.w3.org/1999/xlink"', "")
    used = set(re.findall(r"#([^)\"]+)[)\"]", drawn))
    drawn = re.sub(r' id="([^"]+)"', lambda found: found.group() if found.group(1) in used else "", drawn)
    return _with_classes(re.sub(r">\s+<", ">\n<", drawn))


def _with_classes(drawn: str) -> str:
    """Styles of elements as classes named by the style, so that pictures on a page may share them."""
    styles = dict.fromkeys(re.findall(r' style="([^"]+)"', drawn))
    classes = {style: f"s{hashlib.sha256(style.encode()).hexdigest()[:5]}" for style in styles}
    rules = "".join(f".{name}{{{style}}}" for style, name in classes.items())
    drawn = re.sub(r' style="([^"]+)"', lambda found: f' class="{classes[found.group(1)]}"', drawn)
    return drawn.replace("</style>", f"{rules}</style>", 1)


def _rounded(found: re.Match[str]) -> str:
    """A number of the picture, in points."""
    return f"{float(found.group()):.{DECIMALS}f}".rstrip("0").rstrip(".")


def _with_relative_steps(found: re.Match[str]) -> str:
    """A path of straight lines by the steps between its rounded points; steps of no length are left out."""
    lines = []
    for line in found.group(1).split("M "):
        points = [tuple(map(float, point.split())) for point in line.split("L ")]
        steps = [_pair((b[0] - a[0], b[1] - a[1])) for a, b in pairwise(points)]
        lines.append(f"M{_pair(points[0])}l{' '.join(step for step in steps if step != '0 0') or '0 0'}")
    return f' d="{"".join(lines)}"'


def _pair(point: tuple[float, ...]) -> str:
    return " ".join(f"{round(value, DECIMALS) + 0.0:g}" for value in point).replace(" -", "-")


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
