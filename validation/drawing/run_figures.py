"""Figures of runs: force against penetration, contact radius against force, on a spring the stage; over time.

A report draws a figure a pair of quantities, with all solvers laid over each other; a notebook the panels of
:func:`side_by_side`. Drawn from saved columns only (those of ``trace.csv``): spheres in the paper's
dimensionless quantities, other shapes in units of the scene.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import chain, count
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, SceneError, Trace
from contact_scene.errors import shown as shown_value
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.curves import Labels, RunCurves, labels, of_trace
from validation.drawing.styles import CLOSED_FORM, INK, curve_style
from validation.measure.scaling import unit_sizes

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
HEIGHT, WIDTHS = 3.4, {2: 8.4, 3: 12.0}  # inches of a figure with as many panels
INSTABILITY = "instability"  # what the legend says of the crosses


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
        style = curve_style(curve.style) | {"marker": "o", "markersize": size, "label": curve.label}
        _draw_run(axes, curve, panel.across, panel.up, style)
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


def _draw_run(axes: Axes, curve: RunCurves, across: str, up: str, line: dict[str, Any]) -> None:
    """The line of a run, a marker if it has a single row, and a circle at its largest tension."""
    x, y = curve.columns[across], curve.columns[up]
    marker = line.get("marker", "o") if x.size == 1 else None
    axes.plot(x, y, rasterized=x.size > MANY, **line | {"marker": marker})
    if curve.pull_off is not None and x.size > curve.pull_off:
        at, size = ([x[curve.pull_off]], [y[curve.pull_off]]), line.get("markersize", 6)
        axes.plot(*at, "o", markersize=size, color=line["color"], fillstyle="none")


def side_by_side(with_stage: bool) -> tuple[tuple[str, str], ...]:
    """Columns across and up of the panels that show a run; on a spring the loading drives the stage."""
    stage = (("stage", "force"),) if with_stage else ()
    return ("penetration", "force"), *stage, ("force", "contact_radius")


def has_stage(trace: Trace) -> bool:
    """Whether the machine of a run is a spring, so that its stage moves otherwise than the indenter."""
    return "stage" in trace.extra


def in_words(with_stage: bool) -> str:
    """What these panels show."""
    *first, last = (f"{up} against {across}".replace("_", " ") for across, up in side_by_side(with_stage))
    return f"{', '.join(first)} and {last}"


def new_figure(with_stage: bool, *, shown: bool = True) -> Figure:
    """A figure with the axes of these panels: one of pyplot, or one that no window shows."""
    panels = len(side_by_side(with_stage))
    size = (WIDTHS[panels], HEIGHT)
    if shown:
        from matplotlib import pyplot

        figure = pyplot.figure(figsize=size, layout="constrained")
    else:
        from matplotlib.figure import Figure

        figure = Figure(figsize=size, layout="constrained")
    figure.subplots(1, panels)
    return figure


def checked_axes(axes: Sequence[Axes], with_stage: bool) -> tuple[Axes, ...]:
    """The panels of a figure of runs: two Axes of Matplotlib, on a spring two or three."""
    several = isinstance(axes, Collection) and not isinstance(axes, str)
    panels: list[Any] = list(axes) if several else [axes]
    counts, said = ((2, 3), "two or three") if with_stage else ((2,), "two")
    if len(panels) not in counts or not all(hasattr(panel, "annotate") for panel in panels):
        allowed = f"{said} Axes, as pyplot.subplots(1, {counts[-1]}) gives them"
        raise SceneError("axes", f"got {shown_value(axes)}", allowed)
    return tuple(panels)


def draw_side_by_side(axes: Sequence[Axes], trace: Trace, scene: Scene, line: dict[str, Any]) -> None:
    """Draw a run; the pull-off is marked by a circle, on a spring every instability by a cross.

    ``line`` has the line properties of Matplotlib, the label among them.
    """
    curve, names = of_trace(trace, scene), labels(scene)
    states = _instabilities(trace, scene)
    for panel, (across, up) in zip(axes, side_by_side(len(axes) == 3), strict=True):
        _draw_run(panel, curve, across, up, line)
        pulled, known = curve.pull_off, any(text.get_text() == "pull-off" for text in panel.texts)
        if pulled is not None and pulled < len(curve.columns[up]) and not known:
            at = curve.columns[across][pulled], curve.columns[up][pulled]
            offset = (9.0, -3.0) if across == "force" else (4.0, -12.0)  # points
            panel.annotate("pull-off", at, offset, textcoords="offset points", fontsize="small")
        _mark_instabilities(panel, states, across, up, line["color"])
        panel.set(xlabel=names[across], ylabel=names[up])
        format_axes(panel)
        panel.margins(0.06, 0.12)
        panel.locator_params(axis="x", nbins=5)  # more labels run into each other
    axes[0].legend(frameon=False, fontsize="small")


def free_label(panel: Axes, solver: str, scene: str) -> str:
    """The solver's name; where lines of the panel have it, behind the scene's, and numbered if need be."""
    taken = {line.get_label() for line in panel.lines}
    longer = (f"{scene}, {solver}" + (f" ({number})" if number > 1 else "") for number in count(1))
    return next(label for label in chain((solver,), longer) if label not in taken)


def _instabilities(trace: Trace, scene: Scene) -> list[dict[str, float]]:
    """States at which the contact of a run on a spring becomes unstable, quantities as drawn."""
    if not has_stage(trace) or not scene.is_adhesive:  # without adhesion the contact shrinks to nothing
        return []
    size = unit_sizes(scene)
    length, force = size.get("length", 1.0), size.get("force", 1.0)
    is_free = bool(trace.contact_radius[-1] == 0.0)
    return [
        {
            "penetration": event.penetration / length,
            "force": event.force / force,
            "contact_radius": event.contact_radius / length,
            "stage": (event.penetration + scene.loading.compliance * event.force) / length,
            "lost": event is trace.events[-1] and event.time == trace.time[-1] and is_free,
        }
        for event in trace.events
    ]


def _mark_instabilities(
    panel: Axes, states: list[dict[str, float]], across: str, up: str, color: Any
) -> None:
    """A cross each; where contact is lost a dotted line on, at constant stage, to the force zero."""
    from matplotlib.lines import Line2D

    for state in states:
        known = any(line.get_label() == INSTABILITY for line in panel.lines)
        label = "_nolegend_" if known else INSTABILITY
        panel.plot(state[across], state[up], "x", color=color, markersize=7, label=label)
        if state["lost"] and up == "force":  # the free indenter is where the stage is
            x, y = (state[across], state["stage"]), (state[up], 0.0)
            jump = Line2D(x, y, color=color, linestyle=":", linewidth=1.2)
            panel.add_artist(jump)  # as far as the curves leave room: a soft spring goes far


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
