"""Error against stated run time on a scene of the exam, a line for each code."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.drawing import export
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import DASHES, INK, MARKERS, SERIES
from validation.exam.judge import CodeOnScene, SceneJudgement

if TYPE_CHECKING:
    from matplotlib.figure import Figure

QUANTITY = "force, curve"
LEAST = 1e-12
"""Smallest error drawn: below it an answer is the run it is graded against, or prescribes the quantity."""


def draw(scene: SceneJudgement) -> Figure | None:
    """Logarithmic axes, answers that fail crossed; ``None`` where no answer states its run time."""
    from matplotlib.figure import Figure

    quantity = _quantity(scene)
    lines = [(one, points) for one in scene.verdicts if (points := _points(one, quantity))]
    if not lines:
        return None
    figure = Figure(figsize=(1.4 * SIZE[0], SIZE[1]), layout="constrained")
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    for index, (one, points) in enumerate(lines):
        colour = SERIES[index % len(SERIES)]
        across, up, _ = zip(*points, strict=True)
        style = {"color": colour, "linestyle": DASHES[index % len(DASHES)], "linewidth": 1.2}
        marker = MARKERS[index % (len(MARKERS) - 1)]
        axes.plot(across, up, label=one.code, marker=marker, markersize=5, **style)
        failed = [(x, y) for x, y, good in points if not good]
        if failed:
            x, y = zip(*failed, strict=True)
            axes.plot(x, y, linestyle="none", marker="x", markersize=9, color=colour)
    axes.axhline(1e-2, color=INK, linewidth=0.7, linestyle=(0, (2, 3)))
    axes.set_xlabel("stated run time (s)")
    axes.set_ylabel(f"relative error, {quantity.partition(',')[0].replace('_', ' ')} over time")
    format_axes(axes)
    axes.legend(
        loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize="small", labelcolor=INK
    )
    return figure


def files(figure: Figure, name: str) -> dict[str, bytes]:
    """Copies of the figure beside the page."""
    return {f"{name}.png": export.png(figure), f"{name}.svg": export.svg_file(figure)}


def _quantity(scene: SceneJudgement) -> str:
    """The force, or the penetration where the force is prescribed to the end."""
    controls = {step.kind for step in scene.case.scene.loading.steps}
    return "penetration, curve" if controls and controls <= {"force", "force-ramp"} else QUANTITY


def _points(one: CodeOnScene, quantity: str) -> list[tuple[float, float, bool]]:
    """Seconds, error and whether it passed, of every answer that states its run time, fastest first."""
    found = []
    for graded in one.answers:
        error = None if graded.grade is None else graded.grade.error(quantity)
        seconds = graded.answer.header.seconds
        if graded.grade is None or error is None or seconds is None:
            continue
        if LEAST < error < float("inf"):
            found.append((seconds, error, graded.grade.passed))
    return sorted(found)
