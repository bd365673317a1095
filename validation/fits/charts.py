"""Measured curves with the fit through them, what is left over, and correlations of the parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.drawing.axes import format_axes, label_axes
from validation.drawing.styles import GREY, INK, MARKERS, SERIES, VERMILION
from validation.fits.result import FitResult, FittedCurve, LikelihoodProfile
from validation.measure.scaling import unit_name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_COLUMNS = 4  # curves side by side
MANY_LABELS = 8  # parameters whose correlations are written into the map
ROWS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 2.2, "rasterized": True}
LEGEND: dict[str, Any] = {"frameon": False, "fontsize": "small", "labelcolor": INK}


def draw_curves(result: FitResult) -> Figure:
    """A column for each curve: force over position, residuals over time; what is not explained is marked."""
    from matplotlib.figure import Figure

    count = len(result.curves)
    columns, rows = min(count, MOST_COLUMNS), -(-count // MOST_COLUMNS)
    figure = Figure(figsize=(3.6 * max(columns, 1.4), 4.6 * rows), layout="constrained")
    panels = figure.subplots(2 * rows, columns, squeeze=False, height_ratios=[2.2, 1.0] * rows)
    length, force, time = (f" ({unit_name(result.scene, name)})" for name in ("penetration", "force", "time"))
    upper, lower = panels[::2].ravel(), panels[1::2].ravel()
    for place, one in enumerate(result.curves):
        _draw_curve(upper[place], lower[place], one, result.goodness.explained)
        first = place % columns == 0
        driven = "penetration" if one.curve.stage is None else "position of the stage"
        label_axes(upper[place], driven + length, f"force{force}" if first else "")
        label_axes(lower[place], f"time{time}", "(measured - fit)/noise" if first else "")
    for axes in (*upper[count:], *lower[count:]):
        axes.set_axis_off()
    upper[0].legend(**LEGEND)
    return figure


def _draw_curve(upper: Axes, lower: Axes, one: FittedCurve, explained: bool) -> None:
    kept, force, time = one.compared, one.curve.force, one.curve.time
    upper.plot(one.position[kept], force[kept], color=SERIES[0], label="measured", **ROWS)
    if not kept.all():
        upper.plot(one.position[~kept], force[~kept], color=GREY, label="not compared", **ROWS)
    if not explained and one.missed:
        missed = one.position[one.stretch], force[one.stretch]
        upper.plot(*missed, color=SERIES[1], label="not explained", **ROWS)
        lower.axvspan(*one.missed, color=SERIES[1], alpha=0.2, linewidth=0)
    upper.plot(one.position, one.force, color=VERMILION, linewidth=1.1, label="fit")
    upper.set_title(one.curve.name, fontsize="medium")
    lower.plot(time[kept], one.residuals[kept], color=SERIES[0], **ROWS)
    lower.axhline(0.0, color=INK, linewidth=0.8)
    for axes in (upper, lower):
        format_axes(axes)
        axes.locator_params(axis="x", nbins=5)


def draw_correlations(result: FitResult) -> Figure:
    """Correlations of all parameters as a map."""
    from matplotlib.figure import Figure

    names = [one.name for one in result.estimates]
    side = 2.6 + 0.32 * len(names)
    figure = Figure(figsize=(side, side - 0.6), layout="constrained")
    axes = figure.add_subplot()
    picture = axes.imshow(result.correlations, cmap="PuOr", vmin=-1.0, vmax=1.0)
    axes.set_xticks(range(len(names)), names, rotation=90, fontsize="small")
    axes.set_yticks(range(len(names)), names, fontsize="small")
    if len(names) <= MANY_LABELS:
        for (row, column), value in np.ndenumerate(result.correlations):
            colour = "white" if abs(value) > 0.6 else "black"
            axes.text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=7, color=colour)
    bar = figure.colorbar(picture, ax=axes, shrink=0.8)
    bar.set_label("correlation", color=INK)
    for one in (axes, bar.ax):
        one.tick_params(colors=INK, labelcolor=INK)
    return figure


def draw_profiles(profiles: Sequence[LikelihoodProfile]) -> Figure:
    """Increase of the sum of squares over each parameter, the 95 % limit drawn in."""
    from matplotlib.figure import Figure

    columns, rows = min(len(profiles), MOST_COLUMNS), -(-len(profiles) // MOST_COLUMNS)
    figure = Figure(figsize=(2.6 * max(columns, 1.5), 2.4 * rows), layout="constrained")
    panels = figure.subplots(rows, columns, squeeze=False)
    look: dict[str, Any] = {"color": SERIES[0], "marker": MARKERS[0], "markersize": 3, "linewidth": 1.0}
    for axes, one in zip(panels.flat, profiles, strict=False):
        axes.plot(one.values, one.increases, **look)
        axes.axhline(3.84, color=VERMILION, linestyle="--", linewidth=1.0, label="95 %")
        axes.set(xlabel=one.name, ylim=(0.0, 12.0))
        format_axes(axes)
        axes.locator_params(axis="x", nbins=4)
    for axes in panels[:, 0]:
        axes.set_ylabel("increase of the sum of squares", color=INK)
    for axes in panels.ravel()[len(profiles) :]:
        axes.set_axis_off()
    panels[0, 0].legend(**LEGEND)
    return figure
