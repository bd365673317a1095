"""How every figure looks, and how it leaves: colours and lines, axes, and the figure as SVG or PNG.

Colours are Okabe and Ito's, distinct for any kind of colour vision; line style or marker differ beside them.
In a page each colour is a CSS variable, so that a page can be light or dark.
"""

from __future__ import annotations

import hashlib
import io
import re
from html import escape
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from validation.solvers import SOLVERS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLUE, VERMILION, PURPLE, ORANGE, SKY, GREEN = (
    "#0072b2", "#d55e00", "#cc79a7", "#e69f00", "#56b4e9", "#009e73"
)  # fmt: skip
GREY = "#999999"
INK = "#0a0a0a"  # text and axes; not quite black, so that the page can replace it by its own
GRID = "#b3b3b4"
SERIES = (BLUE, VERMILION, PURPLE, ORANGE, SKY, INK)  # colours of curves that belong to no solver
DASHES: tuple[Any, ...] = ("-", (0, (6, 1.5)), (0, (3, 1, 1, 1)), (0, (1, 1)), (0, (8, 2, 2, 2)), "-.")
MARKERS = "os^Dvx"
APPROACH, RETRACTION = BLUE, VERMILION

CSS_VARIABLES = {
    GREY: "var(--reference)",
    BLUE: "var(--bem)",
    VERMILION: "var(--fem)",
    GREEN: "var(--closed)",
    INK: "currentColor",
    GRID: "var(--grid)",
}
CLOSED_FORM: dict[str, Any] = {"color": GREEN, "linestyle": ":", "linewidth": 1.3}
_OTHER: dict[str, Any] = {"color": ORANGE, "linestyle": (0, (8, 2, 2, 2)), "linewidth": 1.4, "marker": "P"}


def curve_style(name: str) -> dict[str, Any]:
    """Line properties of a solver: colour, line style and width, marker."""
    method = SOLVERS.get(name)
    if method is None:
        return _OTHER
    return {**method.curve_style, "marker": method.marker}


# Axes

SIZE = (4.2, 3.1)  # inches of a figure with one pair of axes
OF_THE_SI = re.compile(r" \((m|N|s)\)$")
"""End of a label with a unit whose numbers carry a prefix: ``20 nm``."""


def drawing(
    size: tuple[float, float] = SIZE, *grid: int, layout: Any = "constrained", **how: Any
) -> tuple[Figure, Any]:
    """A figure of so many inches, and its axes, or those of a grid of rows and columns."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout=layout)
    return figure, figure.subplots(*grid, **how)


def format_axes(axes: Axes, powers: tuple[int, int] = (-3, 4), grid_width: float = 0.5) -> None:
    """Give axes and their insets grid, ink and notation: no power of ten between ``powers``."""
    from matplotlib.ticker import ScalarFormatter

    axes.grid(True, which="major", color=GRID, linewidth=grid_width)
    axes.set_axisbelow(True)
    for one in (axes, *axes.child_axes):
        one.tick_params(which="both", colors=INK, labelcolor=INK)
        for spine in one.spines.values():
            spine.set_color(INK)
        one.title.set_color(INK)
        for axis in (one.xaxis, one.yaxis):
            axis.label.set_color(INK)
            axis.get_offset_text().set_color(INK)
            if isinstance(axis.get_major_formatter(), ScalarFormatter):  # neither words nor logarithms
                one.ticklabel_format(
                    axis="x" if axis is one.xaxis else "y", style="sci", scilimits=powers, useOffset=False
                )


def label_axes(axes: Axes, across: str, up: str) -> None:
    """Label axes; numbers in a unit of the SI carry it and a prefix."""
    from matplotlib.ticker import EngFormatter

    for axis, label in ((axes.xaxis, across), (axes.yaxis, up)):
        unit = OF_THE_SI.search(label)
        axis.set_label_text(label if unit is None else label[: unit.start()])
        if unit is not None:
            axis.set_major_formatter(EngFormatter(unit[1]))


# Files and pages

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


def as_files(figure: Figure, name: str, dots_per_inch: int = 120) -> dict[str, bytes]:
    """The figure as ``NAME.png`` and ``NAME.svg`` on white, the same bytes each time."""
    stream = io.BytesIO()
    figure.savefig(stream, format="svg", facecolor="white", metadata={"Date": None, "Creator": None})
    return {f"{name}.png": png(figure, dots_per_inch), f"{name}.svg": stream.getvalue()}


def png(figure: Figure, dots_per_inch: int = 120) -> bytes:
    """The figure as PNG on white."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=dots_per_inch, facecolor="white", metadata={"Software": None})
    return stream.getvalue()
