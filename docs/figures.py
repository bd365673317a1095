"""The figures of the documentation that no command draws: ``python docs/figures.py`` writes them anew.

``cycles.png``: the cycles of Fig. 2 by every solver. ``springs.png``: the one at V = 0.02 R/tau on springs of
1e-3 to 1e3 times the stiffness of the contact. ``path.png``: paths of the edge that the reference follows.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import crosscontact as cc
from validation.drawing.curves import elastic_limits, labels, of_trace
from validation.drawing.figure import BLUE, CLOSED_FORM, INK, VERMILION, png

CIRCLES: dict[str, Any] = {"marker": "o", "linestyle": "none", "markerfacecolor": "none"}


def evenly(x: np.ndarray, y: np.ndarray, count: int) -> np.ndarray:
    """Rows at even distances along a curve in the plane of its figure, without the ends."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x) / np.ptp(x), np.diff(y) / np.ptp(y)))))
    return np.searchsorted(along, np.linspace(0.0, along[-1], count)[1:-1])


def with_grid(axes: Axes) -> None:
    """A grid below the curves."""
    axes.grid(True, color="#e2e2e2", linewidth=0.5)
    axes.set_axisbelow(True)


def cycles() -> Figure:
    """Force over penetration, and contact radius over force: reference, boundary and finite elements."""
    figure = Figure(figsize=(9.0, 3.7), layout="constrained")
    panels = tuple(figure.subplots(1, 2))
    scene = cc.builtin("cycle-v0.002")

    def plot(columns: Any, rows: Any = slice(None), **style: Any) -> None:
        d, F, a = (columns[name][rows] for name in ("penetration", "force", "contact_radius"))
        panels[0].plot(d, F, **style)
        panels[1].plot(F, a, **style)

    for curve in elastic_limits(scene, 0.21):
        label = "elastic (JKR), E₀ and E∞" if curve.label.endswith("₀") else None
        plot(curve.columns, label=label, zorder=0, **CLOSED_FORM)
    looks = (("#0072b2", "-"), ("#d55e00", (0, (6, 1.5))), ("#a0527d", (0, (3, 1, 1, 1))))
    for speed, (color, dashes) in zip(("0.002", "0.02", "0.1"), looks, strict=True):
        scene = cc.builtin(f"cycle-v{speed}")
        reference, bem, fem = (
            of_trace(cc.solve(scene, solver).trace, scene).columns for solver in ("reference", "bem", "fem")
        )
        named = speed == "0.002"
        label = "reference" if named else None
        plot(reference, label=label, color="#bbbbbb", linewidth=4.0, solid_capstyle="butt", zorder=1)
        plot(bem, color=color, linestyle=dashes, label=f"bem, V = {speed} R/τ", zorder=2)
        rows = evenly(fem["penetration"], fem["force"], 22)
        plot(fem, rows, color="black", markersize=4.5, label="fem" if named else None, zorder=3, **CIRCLES)
    names = labels(scene)
    limits = {"xlim": (-0.026, 0.036), "ylim": (-0.005, 0.024)}
    panels[0].set(xlabel=names["penetration"], ylabel=names["force"], **limits)
    panels[1].set(xlabel=names["force"], ylabel=names["contact_radius"], xlim=(-0.005, 0.024))
    panels[0].legend(frameon=False, fontsize="small", handlelength=3.0)
    for axes in panels:
        with_grid(axes)
        axes.ticklabel_format(style="sci", scilimits=(-2, 3))
    return figure


def on_spring(scene: cc.Scene, share: float, length: float = 1.0, time: float = 1.0) -> cc.Scene:
    """The cycle on a spring of this share of the contact's stiffness, in given units of length and time.

    The stage moves the indenter as fast as without a spring; the approach ends at the force that it reaches
    there.
    """
    stiffness, force = share * 2.0 * 0.245 / length, 0.0464  # of the relaxed contact there: 2 E0* a
    speed = 0.02 * (1.0 + 1.0 / share) * length / time
    farthest = 0.1 * length + 2.0 * force / stiffness
    steps = (cc.Ramp(farthest, speed, until_force=force), cc.Ramp(-10.0 * farthest, speed))
    return replace(scene, loading=cc.Loading("jump-in", 0.0, steps, cc.Machine(stiffness)))


def springs() -> Figure:
    """Force over stage: the reference, and boundary elements on the scene in SI units, scaled back."""
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    *panels, last = figure.subplots(2, 4, sharey=True).ravel()
    for axes, share in zip(panels, 10.0 ** np.arange(-3, 4), strict=True):
        plain = cc.solve(on_spring(cc.builtin("cycle-v0.02"), share)).trace
        stage, force = plain.extra["stage"], plain.force / np.pi
        drop, lost = stage[-2:], (plain.events[-1].force / np.pi, 0.0)
        axes.plot(stage[:-1], force[:-1], color=BLUE, linewidth=1.4, label="reference")
        label = "contact lost at constant stage"
        axes.plot(drop, lost, color=VERMILION, linestyle="--", linewidth=1.2, label=label)
        axes.plot(drop[:1], lost[:1], "D", color=VERMILION, markersize=4.5)
        copy = cc.solve(on_spring(cc.builtin("cycle-si"), share, 1e-3, 0.1), "bem").trace
        x, y = copy.extra["stage"][:-1] / 1e-3, copy.force[:-1] / np.pi
        rows = evenly(x, y, 16)
        axes.plot(x[rows], y[rows], color=INK, markersize=4, label="bem, in SI units", **CIRCLES)
        ratio = plain.extra["instability_loss"][-1] / plain.dissipated_energy[-1]
        axes.set_title(f"k = {share:g} k$_c$; {100 * ratio:.0f} % lost in the snap", fontsize="small")
        axes.set_xlabel("stage X/R")
        with_grid(axes)
    for axes in panels[::4]:
        axes.set_ylabel("force F (1-ν²)/(π E₀ R²)")
    last.axis("off")
    last.legend(*panels[0].get_legend_handles_labels(), frameon=False, loc="center left")
    return figure


def path() -> Figure:
    """Contact radius over time of an edge without and with hysteresis, and what a path can do marked."""
    figure = Figure(figsize=(9.0, 3.9), layout="constrained")
    cycle = cc.builtin("cycle-v0.02")
    loads = cc.Ramp(0.02, 0.02), cc.Force(0.012, 1.2), cc.Ramp(-0.5, 0.02)
    free = replace(cycle, loading=replace(cycle.loading, steps=loads))
    loads = cc.Ramp(0.024, 0.02), cc.Hold(0.4), cc.Ramp(-0.5, 0.02)
    held = replace(
        cycle,
        loading=replace(cycle.loading, steps=loads),
        adhesion=replace(cycle.adhesion, work_closing=0.3 * cycle.adhesion.work),
    )
    titles = "one work of adhesion", "closing gives back 0.3 of what opening takes"
    for axes, scene, title in zip(figure.subplots(1, 2, sharey=True), (free, held), titles, strict=True):
        trace = cc.solve(scene, resolution=50).trace
        last = int(np.flatnonzero(trace.contact_radius > 0.0)[-1]) + 1
        t, a = trace.time[:last], trace.contact_radius[:last]
        axes.plot(t, a, color=BLUE, linewidth=1.6)
        axes.plot([t[-1], t[-1]], [a[-1], 0.0], color=VERMILION, linestyle="--", linewidth=1.2)
        top = np.flatnonzero(a > (1.0 - 1e-9) * a.max())
        places = {"start": (0, 8, -12), "fold: contact is lost": (last - 1, -105, -3)}
        places["run"] = int(np.searchsorted(t, 0.4)), 8, -12
        if scene is held:
            axes.plot(t[top], a[top], color=INK, linewidth=3.2)
            places |= {"rest": (int(top[len(top) // 2]), -10, -16), "departure": (int(top[-1]), 8, 2)}
        else:
            places["turn"] = int(a.argmax()), -10, -16
            rows = np.flatnonzero(t == t[np.flatnonzero(np.diff(t) == 0.0)[0]])
            axes.plot(t[rows], a[rows], color=VERMILION, linewidth=2.4)
            places["jump of the load"] = int(rows[len(rows) // 2]), 8, -26
        for name, (row, *shift) in places.items():
            axes.plot(t[row], a[row], "o", color=INK, markersize=4.5)
            at = {"xytext": shift, "textcoords": "offset points"}
            axes.annotate(name, (t[row], a[row]), fontsize="small", **at)
        axes.set_title(title, fontsize="small")
        axes.set_xlabel("time t/τ")
        axes.set_ylim(0.0)
        with_grid(axes)
    figure.axes[0].set_ylabel("contact radius a/R")
    return figure


if __name__ == "__main__":
    for draw in (cycles, springs, path):
        Path(__file__).with_name(f"{draw.__name__}.png").write_bytes(png(draw(), 110))
