"""Figures of a scene: force against penetration, contact radius against force, and both over time.

Drawn from saved columns only (those of ``trace.csv``). Colours are Okabe and Ito's, told apart by line style
too. For a page they come as SVG whose colours are CSS variables, so that a page can be light or dark; for
paper and README as PNG.
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from validation.drawing.curves import Curves, Labels
from validation.solvers import REFERENCE, SOLVERS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (4.2, 3.1)  # inches
MANY = 6000  # points beyond which a line is drawn as pixels inside the SVG

CLOSED: dict[str, Any] = {"color": "#009e73", "linestyle": ":", "linewidth": 1.3}
INK = "#0a0a0a"
VARIABLES = {
    "#999999": "var(--reference)",
    "#0072b2": "var(--bem)",
    "#d55e00": "var(--fem)",
    "#009e73": "var(--closed)",
    INK: "currentColor",
    "#b3b3b4": "var(--grid)",
}


@dataclass(frozen=True)
class Panel:
    """One figure: which column against which."""

    name: str
    caption: str
    across: str
    up: str


PANELS = (
    Panel("force-penetration", "Force against penetration", "penetration", "force"),
    Panel("radius-force", "Contact radius against force", "force", "contact_radius"),
    Panel("force-time", "Force over time", "time", "force"),
    Panel("radius-time", "Contact radius over time", "time", "contact_radius"),
    Panel("penetration-time", "Penetration over time", "time", "penetration"),
    Panel("difference-time", "Force: difference from the reference", "shared_time", "difference"),
)


def draw(panel: Panel, curves: Sequence[Curves], labels: Labels) -> Figure:
    """One panel with all curves laid over each other; the largest tension of each is marked."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.add_subplot()
    for curve in sorted(curves, key=_width, reverse=True):
        x, y = curve.columns.get(panel.across), curve.columns.get(panel.up)
        if x is None or y is None or x.size == 0:
            continue
        if not curve.style:
            axes.plot(x, y, label=curve.label, **CLOSED)
            continue
        style = SOLVERS[curve.style].curve_style
        size = 8 if curve.style == REFERENCE else 5
        marker = "o" if x.size == 1 else None
        axes.plot(x, y, label=curve.label, rasterized=x.size > MANY, marker=marker, markersize=size, **style)
        if curve.pull_off is not None and x.size > curve.pull_off:
            at = ([x[curve.pull_off]], [y[curve.pull_off]])
            axes.plot(*at, "o", markersize=size, color=style["color"], fillstyle="none")
    solved = [curve for curve in curves if curve.style]
    for column, limit in ((panel.across, axes.set_xlim), (panel.up, axes.set_ylim)):
        span = _span([curve.columns[column] for curve in solved if column in curve.columns])
        if span is not None:
            limit(*span)
    _dress(axes, labels[panel.across], labels[panel.up])
    return figure


def _width(curve: Curves) -> float:
    """Line width, 0 for closed forms: widest first, a line drawn later leaves the earlier one visible."""
    return float(SOLVERS[curve.style].curve_style["linewidth"]) if curve.style else 0.0


def _span(columns: Sequence[NDArray[np.float64]]) -> tuple[float, float] | None:
    """Limits around what was solved; closed forms may run out of the picture."""
    filled = [column for column in columns if column.size]
    if not filled:
        return None
    low, high = min(c.min() for c in filled), max(c.max() for c in filled)
    spare = 0.06 * (high - low)
    return (low - spare, high + spare) if spare > 0.0 else None


def _dress(axes: Axes, across: str, up: str) -> None:
    axes.set_xlabel(across)
    axes.set_ylabel(up)
    axes.grid(True, color="#b3b3b4", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK, labelcolor=INK)
    axes.ticklabel_format(axis="both", style="sci", scilimits=(-3, 4), useOffset=False)
    for spine in axes.spines.values():
        spine.set_color(INK)
    for text in (axes.xaxis.label, axes.yaxis.label, axes.xaxis.offsetText, axes.yaxis.offsetText):
        text.set_color(INK)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, labelcolor=INK, fontsize="small", handlelength=2.6)


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
    for colour, variable in VARIABLES.items():
        drawn = drawn.replace(colour, variable)
    return drawn.replace("<svg ", f'<svg role="img" aria-label="{description}" ', 1)


def png(figure: Figure, dots_per_inch: int = 120) -> bytes:
    """The figure as PNG on white."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=dots_per_inch, facecolor="white", metadata={"Software": None})
    return stream.getvalue()
