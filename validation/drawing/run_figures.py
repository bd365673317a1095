"""Figures of a scene: force against penetration, contact radius against force, and both over time.

Drawn from saved columns only (those of ``trace.csv``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from validation.drawing.axes import SIZE, format_axes
from validation.drawing.curves import Labels, RunCurves
from validation.drawing.styles import CLOSED_FORM, INK, curve_style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.transforms import Bbox

WIDE = 3.0  # points; a wider line gets a larger mark at its largest tension
BELOW, ABOVE, BESIDE = 36.0, 15.0, 14.0  # points: numbers and name; a power of ten; half a number
PADDING = 4.0  # points
SHORT = 6  # characters of a number, half of which ends within the margin
MANY = 6000  # points beyond which a line is drawn as pixels inside the SVG


@dataclass(frozen=True)
class CurvePanel:
    """One figure: which column against which."""

    name: str
    caption: str
    across: str
    up: str


PANELS = (
    CurvePanel("force-penetration", "Force against penetration", "penetration", "force"),
    CurvePanel("radius-force", "Contact radius against force", "force", "contact_radius"),
    CurvePanel("force-time", "Force over time", "time", "force"),
    CurvePanel("radius-time", "Contact radius over time", "time", "contact_radius"),
    CurvePanel("penetration-time", "Penetration over time", "time", "penetration"),
    CurvePanel("difference-time", "Force: difference from the reference", "shared_time", "difference"),
)


def draw(panel: CurvePanel, curves: Sequence[RunCurves], labels: Labels) -> Figure:
    """One panel with all curves laid over each other; the largest tension of each is marked."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE)
    axes = figure.add_subplot()
    for curve in sorted(curves, key=_width, reverse=True):
        x, y = curve.columns.get(panel.across), curve.columns.get(panel.up)
        if x is None or y is None or x.size == 0:
            continue
        if not curve.style:
            axes.plot(x, y, label=curve.label, **CLOSED_FORM)
            continue
        size = 5 if _width(curve) < WIDE else 8
        style = curve_style(curve.style) | {"marker": "o" if x.size == 1 else None, "markersize": size}
        axes.plot(x, y, label=curve.label, rasterized=x.size > MANY, **style)
        if curve.pull_off is not None and x.size > curve.pull_off:
            at = ([x[curve.pull_off]], [y[curve.pull_off]])
            axes.plot(*at, "o", markersize=size, color=style["color"], fillstyle="none")
    solved = [curve for curve in curves if curve.style]
    for column, limit in ((panel.across, axes.set_xlim), (panel.up, axes.set_ylim)):
        span = _span([curve.columns[column] for curve in solved if column in curve.columns])
        if span is not None:
            limit(*span)
    axes.set(xlabel=labels[panel.across], ylabel=labels[panel.up])
    format_axes(axes)
    axes.locator_params(axis="x", nbins=6)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, labelcolor=INK, fontsize="small", handlelength=2.6)
    _lay_out(figure, axes)
    return figure


def _lay_out(figure: Figure, axes: Axes) -> None:
    """Margins alike in every figure, but for what longer numbers ask on the left and on the right.

    An engine of matplotlib measures all text of a figure, which takes as long as drawing it.
    """
    width, height = 72.0 * figure.get_size_inches()
    figure.subplots_adjust(bottom=BELOW / height, top=1.0 - ABOVE / height, right=1.0 - BESIDE / width)
    pixels = figure.bbox.width
    if _longest_number(axes.xaxis) > SHORT:
        axes.locator_params(axis="x", nbins=3)
        over = _extent(axes.xaxis).x1 - axes.bbox.x1
        figure.subplots_adjust(right=1.0 - max(over / pixels + PADDING / width, BESIDE / width))
    taken = axes.bbox.x0 - _extent(axes.yaxis).x0
    figure.subplots_adjust(left=taken / pixels + PADDING / width)


def _longest_number(axis: Axis) -> int:
    """Characters of the longest number at an axis."""
    return max(
        map(len, axis.get_major_formatter().format_ticks(axis.get_majorticklocs().tolist())), default=0
    )


def _extent(axis: Axis) -> Bbox:
    """Around name and numbers of an axis, in pixels."""
    extent = axis.get_tightbbox()
    assert extent is not None  # an axis that is shown
    return extent


def _width(curve: RunCurves) -> float:
    """Line width in points; the widest is drawn first and stays visible on both sides of the others."""
    return (curve_style(curve.style) if curve.style else CLOSED_FORM)["linewidth"]


def _span(columns: Sequence[NDArray[np.float64]]) -> tuple[float, float] | None:
    """Limits around what was solved; closed forms may run out of the picture."""
    filled = [column for column in columns if column.size]
    if not filled:
        return None
    low, high = min(c.min() for c in filled), max(c.max() for c in filled)
    spare = 0.06 * (high - low)
    return (low - spare, high + spare) if spare > 0.0 else None
