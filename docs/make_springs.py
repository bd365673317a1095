"""Draws the cycle of Fig. 2 at V = 0.02 R/tau on springs of 1e-3 to 1e3 times the stiffness of the contact.

Run ``python docs/make_springs.py``; writes ``docs/springs.png``. Lines: the reference. Circles: the boundary
elements on a copy of the scene in SI units, scaled back.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_scene import Loading, Machine, Ramp, Scene, Trace
from validation.cases import load
from validation.drawing.export import png
from validation.drawing.styles import BLUE, INK, VERMILION
from validation.solvers import SOLVERS

CASE, SI = load("cycle-v0.02").scene, load("cycle-si").scene
SPEED, TOP = 0.02, 0.0464
"""Speed of the indenter, and the force at the end of the approach under a rigid machine."""
STIFFNESS = 2.0 * 0.245
"""Stiffness of the relaxed contact at the end of that approach, ``2 E0* a``."""
SHARES = (1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3)
LENGTH, FORCE, TIME = 1e-3, 1.0, 0.1
"""Units of the copy: millimetres, ``E0* R^2``, a tenth of a second."""
MARKS = 16  # circles along each cycle


def on_spring(scene: Scene, share: float, length: float, force: float, time: float) -> Scene:
    """The cycle driven by a stage that moves the indenter as fast as without a spring, in given units.

    Parameters
    ----------
    scene : Scene
        The cycle under a rigid machine, in these units.
    share : float
        Stiffness of the spring over that of the contact.
    length, force, time : float
        The units.

    Returns
    -------
    Scene
    """
    stiffness = share * STIFFNESS * force / length
    speed = SPEED * (1.0 + 1.0 / share) * length / time
    farthest = 0.1 * length + 2.0 * TOP * force / stiffness
    steps = (Ramp(farthest, speed, until_force=TOP * force), Ramp(-10.0 * farthest, speed))
    return replace(scene, loading=Loading("jump-in", 0.0, steps, Machine(stiffness)))


def evenly(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Rows at even distances along a curve in the plane of the figure."""
    along = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x) / np.ptp(x), np.diff(y) / np.ptp(y)))))
    return np.searchsorted(along, np.linspace(0.0, along[-1], MARKS)[1:-1])


def plot(axes: Axes, plain: Trace, copy: Trace) -> None:
    """Force over stage, the instability as a drop at constant stage."""
    stage, force, lost = plain.extra["stage"], plain.force / np.pi, plain.events[-1]
    held = stage[:-1], force[:-1]
    axes.plot(*held, color=BLUE, linewidth=1.4, label="reference")
    drop = stage[-2:], [lost.force / np.pi, 0.0]
    axes.plot(*drop, color=VERMILION, linestyle="--", linewidth=1.2, label="contact lost at constant stage")
    axes.plot(drop[0][:1], drop[1][:1], "D", color=VERMILION, markersize=4.5)
    x, y = copy.extra["stage"][:-1] / LENGTH, copy.force[:-1] / (np.pi * FORCE)
    rows = evenly(x, y)
    axes.plot(
        x[rows], y[rows], "o", color=INK, markersize=4, markerfacecolor="none", label="bem, in SI units"
    )


def draw() -> Figure:
    """A panel for every stiffness."""
    figure = Figure(figsize=(11.0, 5.2), layout="constrained")
    panels = figure.subplots(2, 4, sharey=True).ravel()
    for axes, share in zip(panels, SHARES, strict=False):
        plain = SOLVERS["reference"].solve(on_spring(CASE, share, 1.0, 1.0, 1.0))
        copy = SOLVERS["bem"].solve(on_spring(SI, share, LENGTH, FORCE, TIME))
        plot(axes, plain, copy)
        ratio = plain.extra["instability_loss"][-1] / plain.dissipated_energy[-1]
        axes.set_title(f"k = {share:g} k$_c$; {100 * ratio:.0f} % lost in the snap", fontsize="small")
        axes.set_xlabel("stage X/R")
        axes.grid(True, color="#e2e2e2", linewidth=0.5)
        axes.set_axisbelow(True)
    for axes in panels[::4]:
        axes.set_ylabel("force F (1-ν²)/(π E₀ R²)")
    panels[-1].axis("off")
    panels[-1].legend(*panels[0].get_legend_handles_labels(), frameon=False, loc="center left")
    return figure


if __name__ == "__main__":
    target = Path(__file__).with_name("springs.png")
    target.write_bytes(png(draw(), 110))
    print(target)
