"""The pictures a report opens with: a small curve for each scene, and error against time of all runs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from validation.compare.suite import SceneComparison
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.curves import of_trace
from validation.drawing.styles import INK, curve_style
from validation.report.document import Figure, LinkCell, passed_or_not, with_drawing
from validation.solvers import REFERENCE

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

SMALL = (2.3, 1.7)
"""Inches of a small figure: six beside each other on a wide screen, two on a telephone."""
FLAT = 0.05
"""Half of the least height of a small figure, relative to the force: what differs by less is not seen."""
LEAST = 1e-9
"""Error at which smaller ones, those of rounding, are drawn."""
CURVE_ERROR = "F(t), RMS"
"""The check whose difference stands for the error of a run in the chart."""


def small(scene: SceneComparison, anchor: str) -> Figure:
    """Force against penetration of all solvers, which leads to the section of the scene."""
    title = LinkCell(scene.case.name, anchor)
    figure = Figure(f"small-{anchor}", scene.case.name, link=title, verdict=passed_or_not(scene.passed))
    described = f"Force against penetration, {scene.case.name}"
    return with_drawing(figure, _curves(scene), described)


def _curves(scene: SceneComparison) -> Drawing | None:
    from matplotlib.figure import Figure as Drawing

    traces = [run.curves for run in scene.runs.values() if run.curves is not None]
    curves = [of_trace(trace, scene.case.scene) for trace in traces]
    curves = [curve for curve in curves if curve.columns["time"].size > 0]
    if not curves:
        return None
    drawing = Drawing(figsize=SMALL)
    axes = drawing.add_axes((0.14, 0.15, 0.84, 0.83))
    for curve in sorted(curves, key=lambda one: -curve_style(one.style)["linewidth"]):
        x, y = curve.columns["penetration"], curve.columns["force"]
        single = {"marker": "o" if x.size == 1 else None, "markersize": 4}
        axes.plot(x, y, **curve_style(curve.style) | single)
    axes.set_xlabel("penetration", fontsize=8, color=INK, labelpad=3)
    axes.set_ylabel("force", fontsize=8, color=INK, labelpad=3)
    format_axes(axes)
    axes.grid(False)
    low, high = axes.get_ylim()
    spare = FLAT * max(abs(low), abs(high)) - 0.5 * (high - low)
    if spare > 0.0:
        axes.set_ylim(low - spare, high + spare)
    if low < 0.0 < high:
        axes.axhline(0.0, color=INK, linewidth=0.5)
    axes.set(xticks=[], yticks=[])
    return drawing


def cost(scenes: Sequence[SceneComparison]) -> Figure:
    """Error of the force over the run against processor time, a mark for each run of each solver."""
    from matplotlib.figure import Figure as Drawing

    points: dict[str, list[tuple[float, float]]] = {}
    for scene in scenes:
        found = {check.solver: check.difference for check in scene.checks if check.quantity == CURVE_ERROR}
        for solver, run in scene.runs.items():
            error = run.errors.get("force") if solver == REFERENCE else found.get(solver)
            if error and run.cpu_seconds > 0.0:
                points.setdefault(solver, []).append((run.cpu_seconds, max(abs(error), LEAST)))
    figure = Figure(
        "error-over-time",
        "Error of the force over the whole run, relative to its largest, against processor time: all scenes. "
        f"Difference from the reference; of the reference, its own error estimate; {LEAST:g} at least.",
        missing="No figure: no run has an error.",
    )
    if not points:
        return with_drawing(figure, None)
    drawing = Drawing(figsize=(1.6 * SIZE[0], SIZE[1]), layout="constrained")
    axes = drawing.add_subplot()
    axes.set(xscale="log", yscale="log", xlabel="processor time (s)", ylabel="error of F(t), RMS")
    for solver, found_points in points.items():
        style = curve_style(solver)
        seconds, errors = zip(*found_points, strict=True)
        marker = {"marker": style["marker"] or "D", "color": style["color"], "fillstyle": "none"}
        axes.plot(seconds, errors, linestyle="none", markersize=5, label=solver, **marker)
    format_axes(axes)
    axes.legend(frameon=False, labelcolor=INK, fontsize="small")
    return with_drawing(figure, drawing)
