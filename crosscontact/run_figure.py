"""The figure of runs: force against penetration, contact radius against force; on a spring also the stage.

Spheres are drawn in the paper's dimensionless quantities, other shapes in units of the scene.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import chain, count
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene, SceneError, Trace
from contact_scene.errors import shown
from validation.drawing.curves import labels, of_trace
from validation.measure.dimensionless import unit_sizes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
Panel = tuple[str, str, tuple[float, float]]

WITHOUT_STAGE: tuple[Panel, ...] = (
    ("penetration", "force", (4.0, -12.0)),
    ("force", "contact_radius", (9.0, -3.0)),
)
"""Columns across and up of the two panels, and where the pull-off is named beside its mark (points)."""
WITH_STAGE = (WITHOUT_STAGE[0], ("stage", "force", (4.0, -12.0)), WITHOUT_STAGE[1])
"""The same where the machine is a spring: its stage is what the loading drives."""
HEIGHT, WIDTHS = 3.4, {2: 8.4, 3: 12.0}
"""Size of a figure by its number of panels (inches)."""
INSTABILITY = "instability"
"""What the legend says of the crosses."""


def has_stage(trace: Trace) -> bool:
    """Whether the machine of a run is a spring, so that its stage moves otherwise than the indenter."""
    return "stage" in trace.extra


def in_words(with_stage: bool) -> str:
    """What the figure shows."""
    panels = WITH_STAGE if with_stage else WITHOUT_STAGE
    *first, last = (f"{up} against {across}".replace("_", " ") for across, up, _ in panels)
    return f"{', '.join(first)} and {last}"


def new_axes(with_stage: bool) -> tuple[Axes, ...]:
    """The axes of a new figure of pyplot."""
    from matplotlib import pyplot

    count = len(WITH_STAGE if with_stage else WITHOUT_STAGE)
    return tuple(pyplot.subplots(1, count, figsize=(WIDTHS[count], HEIGHT), layout="constrained")[1])


def new_figure(with_stage: bool) -> Figure:
    """A figure with its axes that no window shows."""
    from matplotlib.figure import Figure

    count = len(WITH_STAGE if with_stage else WITHOUT_STAGE)
    figure = Figure(figsize=(WIDTHS[count], HEIGHT), layout="constrained")
    figure.subplots(1, count)
    return figure


def checked_axes(axes: Sequence[Axes], with_stage: bool) -> tuple[Axes, ...]:
    """The panels of a figure of runs: two, on a spring two or three.

    Raises
    ------
    SceneError
        If they are not as many Axes of Matplotlib.
    """
    several = isinstance(axes, Collection) and not isinstance(axes, str)
    panels: list[Any] = list(axes) if several else [axes]
    counts, said = ((2, 3), "two or three") if with_stage else ((2,), "two")
    if len(panels) not in counts or not all(hasattr(panel, "annotate") for panel in panels):
        allowed = f"{said} Axes, as pyplot.subplots(1, {counts[-1]}) gives them"
        raise SceneError("axes", f"got {shown(axes)}", allowed)
    return tuple(panels)


def draw(axes: Sequence[Axes], trace: Trace, scene: Scene, line: dict[str, Any]) -> None:
    """Draw a run; the pull-off is marked by a circle, on a spring every instability by a cross.

    Parameters
    ----------
    axes : two or three Axes
        With the stage in the middle of three.
    trace : Trace
    scene : Scene
    line : dict
        Line properties of Matplotlib, the label among them; a marker is that of a run of a single row.
    """
    curve, names = of_trace(trace, scene), labels(scene)
    columns, spring = curve.columns, has_stage(trace)
    if spring:
        rows = len(columns["time"])
        columns = columns | {"stage": trace.extra["stage"][:rows] / unit_sizes(scene).get("length", 1.0)}
        names = {**names, "stage": names["penetration"].replace("penetration Δ", "stage X")}
    marker = line.get("marker", "o") if len(columns["time"]) == 1 else None
    shown_panels = WITH_STAGE if len(axes) == 3 else WITHOUT_STAGE
    for panel, (across, up, offset) in zip(axes, shown_panels, strict=True):
        x, y = columns[across], columns[up]
        panel.plot(x, y, **(line | {"marker": marker}))
        if curve.pull_off is not None and curve.pull_off < len(x):
            _mark_pull_off(panel, (x[curve.pull_off], y[curve.pull_off]), offset, line["color"])
        if spring:
            _mark_instabilities(panel, _instabilities(trace, scene), across, up, line["color"])
        panel.set(xlabel=names[across], ylabel=names[up])
        panel.grid(True, color="#e2e2e2", linewidth=0.5)
        panel.set_axisbelow(True)
        panel.margins(0.06, 0.12)
        panel.locator_params(axis="x", nbins=5)  # more labels run into each other
        panel.ticklabel_format(style="sci", scilimits=(-3, 4), useOffset=False)
    axes[0].legend(frameon=False, fontsize="small")


def free_label(panel: Axes, solver: str, scene: str) -> str:
    """The solver's name; where lines of the panel have it, behind the scene's, and numbered if need be."""
    taken = {line.get_label() for line in panel.lines}
    longer = (f"{scene}, {solver}" + (f" ({number})" if number > 1 else "") for number in count(1))
    return next(label for label in chain((solver,), longer) if label not in taken)


def _mark_pull_off(panel: Axes, at: tuple[float, float], offset: tuple[float, float], color: Any) -> None:
    panel.plot(*at, "o", color=color, fillstyle="none", markersize=6)
    if not any(text.get_text() == "pull-off" for text in panel.texts):
        panel.annotate("pull-off", at, offset, textcoords="offset points", fontsize="small")


def _instabilities(trace: Trace, scene: Scene) -> list[dict[str, float]]:
    """States at which the contact of a run becomes unstable, quantities as drawn; none without adhesion."""
    if not scene.is_adhesive:  # its contact shrinks to nothing
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
    """A cross each; where contact is lost a dotted line on, at constant stage, to the force zero.

    Parameters
    ----------
    panel : Axes
    states : list of dict
        As of :func:`_instabilities`.
    across, up : str
        What is drawn.
    color
        Of Matplotlib.
    """
    from matplotlib.lines import Line2D

    for state in states:
        known = any(line.get_label() == INSTABILITY for line in panel.lines)
        label = "_nolegend_" if known else INSTABILITY
        panel.plot(state[across], state[up], "x", color=color, markersize=7, label=label)
        if state["lost"] and up == "force":  # the free indenter is where the stage is
            x, y = (state[across], state["stage"]), (state[up], 0.0)
            jump = Line2D(x, y, color=color, linestyle=":", linewidth=1.2)
            panel.add_artist(jump)  # as far as the curves leave room: a soft spring goes far
