"""Draws the figure of the README: the cycles of Fig. 2 by boundary elements, over the reference.

Run ``python docs/make_figure.py``; writes ``docs/cycles.png``.
"""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from validation.cases import load
from validation.report.curves import elastic_limits, labels, of_trace
from validation.report.figures import CLOSED, STYLES, png
from validation.runs import run

SPEEDS = {"0.002": ("#0072b2", "-"), "0.02": ("#d55e00", (0, (5, 1.5))), "0.1": ("#cc79a7", (0, (1, 1)))}


def draw() -> Figure:
    """Force over penetration and contact radius over force for three speeds."""
    figure = Figure(figsize=(9.0, 3.6), layout="constrained")
    across, up = figure.subplots(1, 2)
    for speed, (colour, dashes) in SPEEDS.items():
        case = load(f"cycle-v{speed}")
        for solver in ("reference", "bem"):
            trace = run(case, solver).trace
            if trace is None:
                raise SystemExit(f"no answer from {solver} for {case.name}")
            columns = of_trace(trace, case.scene).columns
            if solver == "bem":
                style = {"color": colour, "linestyle": dashes, "linewidth": 1.4, "label": f"V = {speed} R/τ"}
            else:
                style = STYLES["reference"] | {"label": "reference" if speed == "0.002" else None}
            across.plot(columns["penetration"], columns["force"], **style)
            up.plot(columns["force"], columns["contact_radius"], **style)
        if speed == "0.002":
            for curve in elastic_limits(case.scene, 0.21):
                style = CLOSED | {"label": "elastic (JKR), E₀ and E∞" if curve.label.endswith("₀") else None}
                across.plot(curve.columns["penetration"], curve.columns["force"], **style)
                up.plot(curve.columns["force"], curve.columns["contact_radius"], **style)
    names = labels(case.scene)
    across.set(xlabel=names["penetration"], ylabel=names["force"])
    up.set(xlabel=names["force"], ylabel=names["contact_radius"])
    across.legend(frameon=False, fontsize="small")
    for axes in (across, up):
        axes.grid(True, color="#d9d9d9", linewidth=0.5)
        axes.set_axisbelow(True)
        axes.ticklabel_format(style="sci", scilimits=(-2, 3))
    return figure


if __name__ == "__main__":
    target = Path(__file__).with_name("cycles.png")
    target.write_bytes(png(draw(), 110))
    print(target)
