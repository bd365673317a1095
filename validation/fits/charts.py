"""Measured curves with the fit through them, what is left over, and correlations of the parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from validation.drawing.axes import format_axes, label_axes
from validation.drawing.styles import GREY, INK, MARKERS, SERIES, VERMILION
from validation.fits.result import FitResult, LikelihoodProfile
from validation.measure.scaling import unit_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 3.6, 4.6  # inches of a curve's column
MOST_COLUMNS = 4  # curves side by side
MANY_LABELS = 8  # parameters whose correlations are written into the map
SIZE = 2.2  # points of a marker
ROWS: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": SIZE, "rasterized": True}


def draw_curves(result: FitResult) -> Figure:
    """A column for each curve: force over position, residuals over time; a stretch that is not explained is
    marked in both."""
    from matplotlib.figure import Figure

    curves, explained = result.curves, result.goodness.explained
    length, force, time = (f" ({unit_name(result.scene, name)})" for name in ("penetration", "force", "time"))
    columns, rows = min(len(curves), MOST_COLUMNS), -(-len(curves) // MOST_COLUMNS)
    figure = Figure(figsize=(WIDTH * max(columns, 1.4), HEIGHT * rows), layout="constrained")
    panels = figure.subplots(2 * rows, columns, squeeze=False, height_ratios=[2.2, 1.0] * rows)
    for place in range(columns * rows):
        upper, lower = panels[2 * (place // columns) : 2 * (place // columns) + 2, place % columns]
        if place >= len(curves):
            upper.set_axis_off()
            lower.set_axis_off()
            continue
        one = curves[place]
        kept = one.compared
        upper.plot(one.position[kept], one.curve.force[kept], color=SERIES[0], label="measured", **ROWS)
        if not kept.all():
            left = one.position[~kept], one.curve.force[~kept]
            upper.plot(*left, color=GREY, label="not compared", **ROWS)
        if not explained and one.stretch.stop > one.stretch.start:
            missed = one.position[one.stretch], one.curve.force[one.stretch]
            upper.plot(*missed, color=SERIES[1], label="not explained", **ROWS)
            ends = one.curve.time[[one.stretch.start, one.stretch.stop - 1]]
            lower.axvspan(*ends, color=SERIES[1], alpha=0.2, linewidth=0)
        upper.plot(one.position, one.force, color=VERMILION, linewidth=1.1, label="fit")
        driven = "penetration" if one.curve.stage is None else "position of the stage"
        upper.set_title(one.curve.name)
        lower.plot(one.curve.time[kept], one.residuals[kept], color=SERIES[0], **ROWS)
        lower.axhline(0.0, color=INK, linewidth=0.8)
        for axes in (upper, lower):
            format_axes(axes)
            axes.locator_params(axis="x", nbins=5)
        first = place % columns == 0
        label_axes(upper, driven + length, f"force{force}" if first else "")
        label_axes(lower, f"time{time}", "(measured - fit)/noise" if first else "")
        upper.title.set_fontsize("medium")
    panels[0, 0].legend(frameon=False, fontsize="small", labelcolor=INK)
    return figure


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
    for place, axes in enumerate(panels.flat):
        if place >= len(profiles):
            axes.set_axis_off()
            continue
        one = profiles[place]
        axes.plot(one.values, one.increases, color=SERIES[0], marker=MARKERS[0], markersize=3, linewidth=1.0)
        axes.axhline(3.84, color=VERMILION, linestyle="--", linewidth=1.0, label="95 %")
        axes.set(xlabel=one.name, ylim=(0.0, 12.0))
        if place % columns == 0:
            axes.set_ylabel("increase of the sum of squares")
        format_axes(axes)
        axes.locator_params(axis="x", nbins=4)
    panels[0, 0].legend(frameon=False, fontsize="small", labelcolor=INK)
    return figure
