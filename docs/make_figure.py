"""Draws the figure of the README: the cycles of Fig. 2 by every solver, laid over each other.

Run ``python docs/make_figure.py``; writes ``docs/cycles.png``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.cases import load
from validation.drawing.curves import RunCurves, elastic_limits, labels, of_trace
from validation.drawing.export import png
from validation.drawing.styles import CLOSED_FORM
from validation.execution.runs import run

SPEEDS = {
    "0.002": ("#0072b2", "-"),
    "0.02": ("#d55e00", (0, (6, 1.5))),
    "0.1": ("#a0527d", (0, (3, 1, 1, 1))),
}
REFERENCE: dict[str, Any] = {"color": "#bbbbbb", "linewidth": 4.0, "solid_capstyle": "butt"}
MARKS = 22  # of the finite elements, along each cycle


def plot(panels: tuple[Axes, Axes], curve: RunCurves, rows: Any = slice(None), **style: Any) -> None:
    """Force over penetration, and contact radius over force."""
    columns = {name: column[rows] for name, column in curve.columns.items()}
    panels[0].plot(columns["penetration"], columns["force"], **style)
    panels[1].plot(columns["force"], columns["contact_radius"], **style)


def evenly(curve: RunCurves) -> np.ndarray:
    """Rows at even distances along the cycle in the plane of force and penetration."""
    x, y = (curve.columns[name] / np.ptp(curve.columns[name]) for name in ("penetration", "force"))
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    return np.searchsorted(along, np.linspace(0.0, along[-1], MARKS)[1:-1])


def draw() -> Figure:
    """The two panels."""
    figure = Figure(figsize=(9.0, 3.7), layout="constrained")
    panels = tuple(figure.subplots(1, 2))
    for speed, (colour, dashes) in SPEEDS.items():
        case, first = load(f"cycle-v{speed}"), speed == "0.002"
        curves = {}
        for solver in ("reference", "bem", "fem"):
            trace = run(case, solver).trace
            if trace is None:
                raise SystemExit(f"no answer from {solver} for {case.name}")
            curves[solver] = of_trace(trace, case.scene)
        plot(panels, curves["reference"], label="reference" if first else None, zorder=1, **REFERENCE)
        plot(panels, curves["bem"], color=colour, linestyle=dashes, label=f"bem, V = {speed} R/τ", zorder=2)
        open_circles = {"marker": "o", "markersize": 4.5, "markerfacecolor": "none", "linestyle": "none"}
        label = "fem" if first else None
        plot(
            panels, curves["fem"], evenly(curves["fem"]), color="black", label=label, zorder=3, **open_circles
        )
        if first:
            for curve in elastic_limits(case.scene, 0.21):
                label = "elastic (JKR), E₀ and E∞" if curve.label.endswith("₀") else None
                plot(panels, curve, label=label, zorder=0, **CLOSED_FORM)
    names = labels(case.scene)
    panels[0].set(
        xlabel=names["penetration"], ylabel=names["force"], xlim=(-0.026, 0.036), ylim=(-0.005, 0.024)
    )
    panels[1].set(xlabel=names["force"], ylabel=names["contact_radius"], xlim=(-0.005, 0.024))
    panels[0].legend(frameon=False, fontsize="small", handlelength=3.0)
    for axes in panels:
        axes.grid(True, color="#e2e2e2", linewidth=0.5)
        axes.set_axisbelow(True)
        axes.ticklabel_format(style="sci", scilimits=(-2, 3))
    return figure


if __name__ == "__main__":
    target = Path(__file__).with_name("cycles.png")
    target.write_bytes(png(draw(), 110))
    print(target)
