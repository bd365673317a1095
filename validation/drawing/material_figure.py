"""Figures of a material: measured moduli and the Prony series through them, residuals, branches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from contact_scene import Material
from contact_scene.prony import PronyFit, RelaxationData
from contact_scene.value_checks import SMALLEST
from validation.drawing.axes import format_axes
from validation.drawing.styles import BLUE, GREY, INK, ORANGE, VERMILION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (5.2, 7.0)  # inches: three panels above each other
DASHED = (0, (6, 1.5))
POINTS_A_DECADE = 40  # of the curves
SPARE = 10.0  # factor by which the curves of a series reach beyond its times


def draw_fit(fit: PronyFit) -> Figure:
    """Measured moduli with the series through them, relative residuals, and the branches.

    Moduli are of the kind of the data (shear or Young's).
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    top, middle, bottom = figure.subplots(3, 1, height_ratios=(3.0, 1.5, 2.0))
    letter, (time, stress) = "G" if fit.data.shear else "E", fit.data.units
    series = Material(fit.modulus or SMALLEST, 0.5, fit.branches)  # a melt has no relaxed modulus
    residuals = 100.0 * fit.residuals
    if isinstance(fit.data, RelaxationData):
        points = fit.data.times
        x = _between(points)
        across = f"time ({time or 'unit of the file'})"
        curves: list[tuple[str, NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], Any]] = [
            ("", fit.data.moduli, series.relaxation_modulus(x), residuals, (BLUE, "o", "-"))
        ]
        up = f"${letter}(t)$"
    else:
        points = fit.data.angular_frequencies
        x = _between(points)
        across = f"angular frequency (rad/{time})" if time else "angular frequency (rad per unit of time)"
        half = points.size
        storage, loss = series.storage_modulus(x), series.loss_modulus(x)
        curves = [
            ("storage: ", fit.data.storage, storage, residuals[:half], (BLUE, "o", "-")),
            ("loss: ", fit.data.loss, loss, residuals[half:], (VERMILION, "s", DASHED)),
        ]
        up = f"${letter}'$, ${letter}''$"
    unit = stress or "unit of the file"
    for label, measured, curve, residual, (colour, marker, line) in curves:
        style = {
            "linestyle": "none",
            "marker": marker,
            "markersize": 3.5,
            "fillstyle": "none",
            "color": colour,
        }
        top.plot(points, measured, label=f"{label}measured", **style)
        top.plot(x, curve, color=INK, linestyle=line, linewidth=1.0, label=f"{label}series")
        middle.plot(points, residual, **style)
    top.set(xscale="log", yscale="log", ylabel=f"{up} ({unit})", xlabel=across)
    top.set_ylim(*_around(np.concatenate([measured for _, measured, *_ in curves])))
    middle.axhline(0.0, color=INK, linewidth=0.8)
    middle.set(xscale="log", ylabel="fit/measured - 1 (%)", xlabel=across)
    middle.set_title(f"misfit {fit.misfit:.2e} (root mean square, relative)", fontsize="small")
    middle.set_xlim(*top.get_xlim())
    _draw_branches(bottom, fit, f"${letter}_k$ ({unit})", f"relaxation time ({time or 'unit of the file'})")
    _finish(top, middle, bottom)
    return figure


def draw_series(material: Material) -> Figure:
    """Storage, loss and relaxation modulus of a series that was not fitted here, and its branches."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    top, middle, bottom = figure.subplots(3, 1, height_ratios=(2.0, 2.0, 2.0))
    moduli, times = material.spectrum
    t = _between(
        np.array([times.min() / SPARE, times.max() * SPARE]) if times.size else np.array([0.1, 10.0])
    )
    w = 1.0 / t[::-1]
    top.plot(w, material.storage_modulus(w), color=BLUE, label="storage $E'$")
    if times.size:
        loss = material.loss_modulus(w)
        top.plot(w, loss, color=VERMILION, linestyle=DASHED, label="loss $E''$")
        bottom.vlines(times, moduli.min() / SPARE, moduli, color=GREY, linewidth=0.8)
        bottom.plot(times, moduli, "o", color=BLUE, markersize=4, label="branches")
    middle.plot(t, material.relaxation_modulus(t), color=BLUE, label="relaxation $E(t)$")
    unit = "unit of the file"
    label = "angular frequency (rad per unit of time)"
    top.set(xscale="log", yscale="log", xlabel=label, ylabel=f"$E'$, $E''$ ({unit})")
    middle.set(xscale="log", yscale="log", xlabel=f"time ({unit})", ylabel=f"$E(t)$ ({unit})")
    bottom.set(xscale="log", yscale="log", xlabel=f"relaxation time ({unit})", ylabel=f"$E_k$ ({unit})")
    bottom.axhline(material.modulus, color=INK, linewidth=0.8, linestyle=":", label="relaxed modulus")
    _finish(top, middle, bottom)
    return figure


def _draw_branches(axes: Axes, fit: PronyFit, up: str, across: str) -> None:
    """Modulus over time of the branches kept and dropped, the relaxed modulus, the window of times tried."""
    kept = np.array([[branch.time, branch.modulus] for branch in fit.branches]).reshape(-1, 2).T
    gone = np.array([[one.branch.time, one.branch.modulus] for one in fit.dropped]).reshape(-1, 2).T
    moduli = np.concatenate([kept[1], gone[1], [fit.modulus] if fit.modulus else []])
    axes.set(xscale="log", yscale="log", xlabel=across, ylabel=up)
    axes.axvspan(fit.grid[0], fit.grid[-1], color=GREY, alpha=0.15, linewidth=0.0, label="times tried")
    if moduli.size:
        low, high = _around(moduli)
        axes.set_ylim(low, high)
        axes.vlines(kept[0], low, kept[1], color=GREY, linewidth=0.8)
    axes.plot(*kept, "o", color=BLUE, markersize=4, label=f"{kept.shape[1]} branches kept")
    if gone.size:
        axes.plot(*gone, "x", color=ORANGE, markersize=6, label=f"{gone.shape[1]} dropped")
    if fit.modulus:
        axes.axhline(fit.modulus, color=INK, linewidth=0.8, linestyle=":", label="relaxed modulus")


def _between(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points of a curve over the range of some, evenly in the logarithm."""
    low, high = float(points.min()), float(points.max())
    return np.geomspace(low, high, max(2, int(POINTS_A_DECADE * np.log10(high / low)) + 2))


def _around(values: NDArray[np.float64]) -> tuple[float, float]:
    """Limits of a log axis around values, half a decade wider on both sides."""
    return float(values.min()) / 3.0, float(values.max()) * 3.0


def _finish(*panels: Axes) -> None:
    for axes in panels:
        format_axes(axes)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(edgecolor="none", framealpha=0.8, labelcolor=INK, fontsize="x-small")
