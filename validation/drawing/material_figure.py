"""Figures of a material: measured moduli and the Prony series through them, residuals, branches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contact_scene import Material
from contact_scene.prony import PronyFit, RelaxationData
from contact_scene.trace import Array
from contact_scene.value_checks import SMALLEST
from validation.drawing.figure import BLUE, GREY, INK, ORANGE, VERMILION, drawing, format_axes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SIZE = (5.2, 7.0)  # inches: three panels above each other
DASHED = (0, (6, 1.5))
POINTS_A_DECADE = 40  # of the curves
SPARE = 10.0  # factor by which the curves of a series reach beyond its times
UNKNOWN = "unit of the file"
NONE = np.empty((2, 0))


def draw_fit(fit: PronyFit) -> Figure:
    """Measured moduli with the series through them, relative residuals, and the branches.

    Moduli are of the kind of the data (shear or Young's).
    """
    figure, (top, middle, bottom) = _panels(3.0, 1.5, 2.0)
    letter, (time, stress) = "G" if fit.data.shear else "E", fit.data.units
    series = Material(fit.modulus or SMALLEST, 0.5, fit.branches)  # a melt has no relaxed modulus
    curves: list[tuple[str, Array, Any, Any]]
    if isinstance(fit.data, RelaxationData):
        points, up, across = fit.data.times, f"${letter}(t)$", f"time ({time or UNKNOWN})"
        curves = [("", fit.data.moduli, series.relaxation_modulus, (BLUE, "o", "-"))]
    else:
        points, up = fit.data.angular_frequencies, f"${letter}'$, ${letter}''$"
        across = f"angular frequency (rad/{time})" if time else "angular frequency (rad per unit of time)"
        curves = [
            ("storage: ", fit.data.storage, series.storage_modulus, (BLUE, "o", "-")),
            ("loss: ", fit.data.loss, series.loss_modulus, (VERMILION, "s", DASHED)),
        ]
    x = _between(points)
    residuals = np.split(100.0 * fit.residuals, len(curves))
    for (label, measured, modulus, look), residual in zip(curves, residuals, strict=True):
        style: dict[str, Any] = dict(zip(("color", "marker"), look, strict=False))
        style |= {"linestyle": "none", "markersize": 3.5, "fillstyle": "none"}
        top.plot(points, measured, label=f"{label}measured", **style)
        top.plot(x, modulus(x), color=INK, linestyle=look[2], linewidth=1.0, label=f"{label}series")
        middle.plot(points, residual, **style)
    top.set(xscale="log", yscale="log", ylabel=f"{up} ({stress or UNKNOWN})", xlabel=across)
    top.set_ylim(*_around(np.concatenate([measured for _, measured, *_ in curves])))
    middle.axhline(0.0, color=INK, linewidth=0.8)
    middle.set(xscale="log", ylabel="fit/measured - 1 (%)", xlabel=across, xlim=top.get_xlim())
    middle.set_title(f"misfit {fit.misfit:.2e} (root mean square, relative)", fontsize="small")
    bottom.axvspan(fit.grid[0], fit.grid[-1], color=GREY, alpha=0.15, linewidth=0.0, label="times tried")
    kept = np.array([[one.time, one.modulus] for one in fit.branches]).reshape(-1, 2).T
    gone = np.array([[one.branch.time, one.branch.modulus] for one in fit.dropped]).reshape(-1, 2).T
    _branches(bottom, kept, fit.modulus, f"{kept.shape[1]} branches kept", gone)
    bottom.set(xlabel=f"relaxation time ({time or UNKNOWN})", ylabel=f"${letter}_k$ ({stress or UNKNOWN})")
    return _finished(figure)


def draw_series(material: Material) -> Figure:
    """Storage, loss and relaxation modulus of a series that was not fitted here, and its branches."""
    figure, (top, middle, bottom) = _panels(2.0, 2.0, 2.0)
    moduli, times = material.spectrum
    ends = [times.min() / SPARE, times.max() * SPARE] if times.size else [0.1, 10.0]
    t = _between(np.array(ends))
    w = 1.0 / t[::-1]
    top.plot(w, material.storage_modulus(w), color=BLUE, label="storage $E'$")
    if times.size:
        top.plot(w, material.loss_modulus(w), color=VERMILION, linestyle=DASHED, label="loss $E''$")
    middle.plot(t, material.relaxation_modulus(t), color=BLUE, label="relaxation $E(t)$")
    label = "angular frequency (rad per unit of time)"
    top.set(xscale="log", yscale="log", xlabel=label, ylabel=f"$E'$, $E''$ ({UNKNOWN})")
    middle.set(xscale="log", yscale="log", xlabel=f"time ({UNKNOWN})", ylabel=f"$E(t)$ ({UNKNOWN})")
    _branches(bottom, np.array([times, moduli]), material.modulus, "branches")
    bottom.set(xlabel=f"relaxation time ({UNKNOWN})", ylabel=f"$E_k$ ({UNKNOWN})")
    return _finished(figure)


def _branches(axes: Axes, kept: Array, relaxed: float | None, label: str, gone: Array = NONE) -> None:
    """Modulus over time of the branches kept and dropped, (2, n) each, and the relaxed modulus."""
    axes.set(xscale="log", yscale="log")
    moduli = np.concatenate([kept[1], gone[1], [relaxed] if relaxed else []])
    if moduli.size:
        low, high = _around(moduli)
        axes.set_ylim(low, high)
        axes.vlines(kept[0], low, kept[1], color=GREY, linewidth=0.8)
    if kept.size:
        axes.plot(*kept, "o", color=BLUE, markersize=4, label=label)
    if gone.size:
        axes.plot(*gone, "x", color=ORANGE, markersize=6, label=f"{gone.shape[1]} dropped")
    if relaxed:
        axes.axhline(relaxed, color=INK, linewidth=0.8, linestyle=":", label="relaxed modulus")


def _between(points: Array) -> Array:
    """Points of a curve over the range of some, evenly in the logarithm."""
    low, high = float(points.min()), float(points.max())
    return np.geomspace(low, high, max(2, int(POINTS_A_DECADE * np.log10(high / low)) + 2))


def _around(values: Array) -> tuple[float, float]:
    """Limits of a log axis around values, half a decade wider on both sides."""
    return float(values.min()) / 3.0, float(values.max()) * 3.0


def _panels(*heights: float) -> tuple[Figure, tuple[Axes, ...]]:
    figure, panels = drawing(SIZE, len(heights), 1, height_ratios=heights)
    return figure, tuple(panels)


def _finished(figure: Figure) -> Figure:
    for axes in figure.axes:
        format_axes(axes)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(edgecolor="none", framealpha=0.8, labelcolor=INK, fontsize="x-small")
    return figure
