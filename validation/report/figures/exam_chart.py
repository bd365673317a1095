"""Error against stated run time on a scene of the exam, a line for each code."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from validation.drawing import export
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import DASHES, INK, MARKERS, SERIES
from validation.exam.judge import CodeOnScene, SceneJudgement

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SYMBOLS = {"force, curve": "F(t)", "contact_radius, curve": "a(t)"}
LEAST = 1e-12
"""Smallest error drawn: below it an answer is the run it is graded against, or prescribes the quantity."""


def draw(scene: SceneJudgement) -> Figure | None:
    """Logarithmic axes, answers that fail crossed; ``None`` where no answer states its run time."""
    quantity = _quantity(scene)
    lines = [(index, one, _points(one, quantity)) for index, one in enumerate(scene.verdicts)]
    if not any(points for _, _, points in lines):
        return None
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullFormatter

    figure = Figure(figsize=(1.4 * SIZE[0], SIZE[1]), layout="constrained")
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    for index, one, points in lines:  # a code has the same colour on every scene
        if not points:
            continue
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
    axes.set_ylabel(f"relative error of {SYMBOLS[quantity]}")
    format_axes(axes)
    for axis in (axes.xaxis, axes.yaxis):  # labels between the decades would run into each other
        axis.set_minor_formatter(NullFormatter())
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, 10.0 ** np.floor(np.log10(low))), max(high, 10.0 ** np.ceil(np.log10(high))))
    axes.legend(
        loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False, fontsize="small", labelcolor=INK
    )
    return figure


def files(figure: Figure, name: str) -> dict[str, bytes]:
    """Copies of the figure beside the page."""
    return {f"{name}.png": export.png(figure), f"{name}.svg": export.svg_file(figure)}


def _quantity(scene: SceneJudgement) -> str:
    """The force, or the contact radius where the force is prescribed to the end."""
    controls = {step.kind for step in scene.case.scene.loading.steps}
    prescribed = controls and controls <= {"force", "force-ramp"}
    return "contact_radius, curve" if prescribed else "force, curve"


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
