"""Figures of runs: force against penetration, contact radius against force, on a spring the stage; over time.

A report draws a figure a pair of quantities, with all solvers laid over each other; a notebook the panels of
:func:`side_by_side`. Drawn from saved columns only (those of ``trace.csv``): spheres in the paper's
dimensionless quantities, unless the scene names its units, other shapes in units of the scene.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import chain, count
from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Scene, SceneError, Trace
from contact_scene.errors import shown as shown_value
from validation.drawing import figure as fig
from validation.drawing.curves import Labels, RunCurves, labels, of_trace
from validation.measure.scaling import drawn_sizes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDE = 3.0  # points; a line as wide gets a larger mark at its largest tension, and lies behind measured rows
SHORT = 6  # characters of a number; longer ones are fewer
MANY = 6000  # points beyond which a line is drawn as pixels inside the SVG
HEIGHT, WIDTHS = 3.4, {1: 4.6, 2: 8.4, 3: 12.0, 4: 15.6}  # inches of a figure with as many panels
QUANTITIES = {"F": "force", "D": "penetration", "a": "contact_radius", "X": "stage", "t": "time"}
"""Columns by the letters that name them in ``F(t)``."""
Pairs = tuple[tuple[str, str], ...]
MEASURED: dict[str, Any] = {
    "linestyle": "none",
    "marker": ".",
    "markersize": 3,
    "color": fig.INK,
    "zorder": 1.5,
}
ARROW, SHORT_WAY = np.array([-0.01, 0.01]), 0.2
"""Ends of an arrow of time along a curve, and a way that has none, both over the size of its panel."""
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
    """One panel with all curves laid over each other; the largest tension of each is marked.

    The widest line is drawn first and stays visible on both sides of the others. Limits are around what was
    solved; closed forms may run out of the picture.
    """
    figure, axes = fig.drawing()
    styles = [fig.curve_style(curve.style) if curve.style else fig.CLOSED_FORM for curve in curves]
    for curve, line in sorted(zip(curves, styles, strict=True), key=lambda pair: -pair[1]["linewidth"]):
        columns = curve.columns
        if panel.across not in columns or panel.up not in columns or columns[panel.across].size == 0:
            continue
        size = 5 if line["linewidth"] < WIDE else 8
        style = {**line, "label": curve.label} | ({"marker": "o", "markersize": size} if curve.style else {})
        _draw_run(axes, curve, panel.across, panel.up, style)
    for column, limit in ((panel.across, axes.set_xlim), (panel.up, axes.set_ylim)):
        solved = [curve.columns[column] for curve in curves if curve.style and column in curve.columns]
        low = min((column.min() for column in solved if column.size), default=0.0)
        high = max((column.max() for column in solved if column.size), default=0.0)
        if high > low:
            limit(low - 0.06 * (high - low), high + 0.06 * (high - low))
    fig.format_axes(axes)
    fig.label_axes(axes, labels[panel.across], labels[panel.up])
    axes.locator_params(axis="x", nbins=6)
    numbers = axes.xaxis.get_major_formatter().format_ticks(axes.get_xticks().tolist())
    if max(map(len, numbers), default=0) > SHORT:
        axes.locator_params(axis="x", nbins=3)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, labelcolor=fig.INK, fontsize="small", handlelength=2.6)
    return figure


def _draw_run(axes: Axes, curve: RunCurves, across: str, up: str, line: dict[str, Any]) -> None:
    """The line of a run, a marker if it has a single row, and a circle at its largest tension."""
    x, y = curve.columns[across], curve.columns[up]
    marker = line.get("marker", "o") if x.size == 1 else None
    order = {"zorder": 1.0 if line.get("linewidth", 0.0) >= WIDE else 2.0}  # of lines drawn later too
    axes.plot(x, y, rasterized=x.size > MANY, **order | line | {"marker": marker})
    if curve.pull_off is not None and x.size > curve.pull_off:
        at, size = ([x[curve.pull_off]], [y[curve.pull_off]]), line.get("markersize", 6)
        axes.plot(*at, "o", markersize=size, color=line["color"], fillstyle="none")


def drawn_pairs(quantity: Any, with_stage: bool) -> Pairs:
    """Columns across and up of the panels that show a run: those of a quantity, as ``F(t)``, or the usual."""
    if quantity is None:
        return side_by_side(with_stage)
    known = {letter: name for letter, name in QUANTITIES.items() if with_stage or name != "stage"}
    for up, across in itertools.permutations(known, 2):
        if quantity == f"{up}({across})":
            return ((known[across], known[up]),)
    allowed = f"two of {', '.join(known)}, as F(t), F(D), a(F)"
    raise SceneError("quantity", f"got {shown_value(quantity)}", allowed)


def side_by_side(with_stage: bool) -> Pairs:
    """Columns across and up of the usual panels; on a spring the loading drives the stage."""
    stage = (("stage", "force"),) if with_stage else ()
    return ("penetration", "force"), *stage, ("force", "contact_radius")


def has_stage(trace: Trace) -> bool:
    """Whether the machine of a run is a spring, so that its stage moves otherwise than the indenter."""
    return "stage" in trace.extra


def in_words(with_stage: bool) -> str:
    """What these panels and that over time show."""
    *first, last = (f"{up} against {across}".replace("_", " ") for across, up in side_by_side(with_stage))
    return f"force over time, {', '.join(first)} and {last}"


def new_figure(panels: int, *, shown: bool = True) -> Figure:
    """A figure with as many axes side by side: one of pyplot, or one that no window shows."""
    if shown:
        from matplotlib.pyplot import figure as make
    else:
        from matplotlib.figure import Figure as make  # type: ignore[assignment]
    figure = make(figsize=(WIDTHS[panels], HEIGHT), layout="constrained")
    figure.subplots(1, panels)
    return figure


def checked_axes(axes: Any, panels: int) -> tuple[Axes, ...]:
    """As many Axes of Matplotlib as there are panels; without the one of the stage, two will do for three."""
    several = isinstance(axes, Collection) and not isinstance(axes, str)
    given: list[Any] = list(axes) if several else [axes]
    said = {1: "one", 2: "two", 3: "two or three"}[panels]
    enough = len(given) == panels or (len(given), panels) == (2, 3)
    if not enough or not all(hasattr(one, "annotate") for one in given):
        allowed = f"{said} Axes, as pyplot.subplots(1, {panels}) gives them"
        raise SceneError("axes", f"got {shown_value(axes)}", allowed)
    return tuple(given)


def run_line(panel: Axes, solver: str, scene: str) -> dict[str, Any]:
    """Label and look: its solver's; beside another of that solver the scene's name, another colour."""
    taken = {line.get_label() for line in panel.lines}
    longer = (f"{scene}, {solver}" + (f" ({number})" if number > 1 else "") for number in count(1))
    label = next(label for label in chain((solver,), longer) if label not in taken)
    look = fig.curve_style(solver)
    drawn = [line.get_color() for line in panel.lines if line.get_linestyle() != "None"]
    if look["color"] not in drawn:
        return {"label": label} | look
    number = len(set(drawn)) - 1
    dashes = fig.DASHES[(number + 1) % len(fig.DASHES)]
    return {
        "label": label,
        "color": fig.SERIES[number % len(fig.SERIES)],
        "linestyle": dashes,
        "linewidth": 1.4,
    }


def draw_side_by_side(
    axes: Sequence[Axes], trace: Trace, scene: Scene, line: dict[str, Any], pairs: Pairs
) -> None:
    """Draw a run; the pull-off is marked by a circle, on a spring every instability by a cross.

    ``line`` has the line properties of Matplotlib, the label among them.
    """
    curve, names = of_trace(trace, scene), labels(scene)
    for panel, (across, up) in zip(axes, pairs, strict=True):
        _draw_run(panel, curve, across, up, line)
        pulled, known = curve.pull_off, any(text.get_text() == "pull-off" for text in panel.texts)
        if pulled is not None and pulled < len(curve.columns[up]) and not known:
            at = curve.columns[across][pulled], curve.columns[up][pulled]
            # Beyond the largest tension there is no curve.
            beside = {"xytext": (-9.0, 0.0), "ha": "right", "va": "center"}
            below = {"xytext": (0.0, -9.0), "ha": "center", "va": "top"}
            free: Any = beside if across == "force" else below
            panel.annotate("pull-off", at, textcoords="offset points", fontsize="small", **free)
        if across != "time":
            _draw_direction(panel, curve.columns[across], curve.columns[up], line["color"])
        if has_stage(trace) and scene.is_adhesive:  # without adhesion the contact shrinks to nothing
            _mark_instabilities(panel, trace, scene, (across, up), line["color"])
        fig.format_axes(panel)
        fig.label_axes(panel, names[across], names[up])
        panel.margins(0.3 if across == "force" else 0.1, 0.06 if across == "force" else 0.16)
        panel.locator_params(axis="x", nbins=5)  # more labels run into each other
    axes[0].legend(frameon=False, fontsize="small")


def _draw_direction(panel: Axes, x: Any, y: Any, color: Any) -> None:
    """Arrows of time on the way in and on the way out, at a third of the way along each."""
    from matplotlib.patches import FancyArrowPatch

    if x.size < SHORT:
        return
    turn, wide, high = int(np.argmax(x)), np.ptp(x) or 1.0, np.ptp(y) or 1.0
    for first, last in ((0, turn), (turn, x.size - 1)):
        part = slice(first, last + 1)
        steps = np.hypot(np.diff(x[part]) / wide, np.diff(y[part]) / high)
        way = np.concatenate([[0.0], np.cumsum(steps)])
        if way[-1] < SHORT_WAY:
            continue
        ends = [(np.interp(at, way, x[part]), np.interp(at, way, y[part])) for at in way[-1] / 3.0 + ARROW]
        look: dict[str, Any] = {"arrowstyle": "-|>", "color": color, "mutation_scale": 11}
        panel.add_artist(FancyArrowPatch(*ends, shrinkA=0.0, shrinkB=0.0, **look))  # moves no limit


def draw_measured(axes: Sequence[Axes], data: Any, scene: Scene, pairs: Pairs) -> None:
    """Draw the rows of a record behind a run, but before a line that would hide them."""
    if not hasattr(data, "motion"):
        allowed = "a MeasuredCurve, as read_curve gives one"
        raise SceneError("data", f"got {shown_value(data)}", allowed)
    size = drawn_sizes(scene)
    sizes = {"time": 1.0, "force": size.get("force", 1.0)}
    columns = {"penetration": data.motion, **data.columns()}
    held = [(panel, pair) for panel, pair in zip(axes, pairs, strict=True) if columns.keys() >= set(pair)]
    if not held:
        wanted = " and ".join(pairs[0]).replace("_", " ")
        raise SceneError("data", f"{data.name} does not record {wanted}", "a record of what is drawn")
    for panel, pair in held:
        x, y = (columns[name] / sizes.get(name, size.get("length", 1.0)) for name in pair)
        panel.plot(x, y, label=data.name, rasterized=x.size > MANY, **MEASURED)


def _mark_instabilities(panel: Axes, trace: Trace, scene: Scene, drawn: tuple[str, str], color: Any) -> None:
    """A cross each; where contact is lost a dotted line on, at constant stage, to the force zero."""
    from matplotlib.lines import Line2D

    size, (across, up) = drawn_sizes(scene), drawn
    length, force = size.get("length", 1.0), size.get("force", 1.0)
    for event in trace.events:
        stage = (event.penetration + scene.loading.compliance * event.force) / length
        at = {"penetration": event.penetration / length, "force": event.force / force, "stage": stage}
        at |= {"contact_radius": event.contact_radius / length, "time": event.time}
        known = any(line.get_label() == INSTABILITY for line in panel.lines)
        label = "_nolegend_" if known else INSTABILITY
        panel.plot(at[across], at[up], "x", color=color, markersize=7, label=label)
        last = event is trace.events[-1] and event.time == trace.time[-1] and trace.contact_radius[-1] == 0.0
        if last and up == "force":  # the free indenter is where the stage is
            ends = at[across], at[across] if across == "time" else stage
            jump = Line2D(ends, (at[up], 0.0), color=color, linestyle=":", linewidth=1.2)
            panel.add_artist(jump)  # as far as the curves leave room: a soft spring goes far
