"""Steps and processor time of every solver over the process zone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import curve_style
from validation.studies.zones import ZoneRun

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PANELS = {"steps": "accepted steps", "seconds": "processor time (s)"}


def draw(runs: Sequence[ZoneRun]) -> Figure:
    """Two pairs of logarithmic axes; a solver's curve ends at the last zone it was run with."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(2.0 * SIZE[0], SIZE[1]), layout="constrained")
    for axes, (quantity, label) in zip(figure.subplots(1, 2), PANELS.items(), strict=True):
        axes.set_xscale("log")
        axes.set_yscale("log")
        for solver in dict.fromkeys(one.solver for one in runs):
            known = [
                (one.ratio, value)
                for one in runs
                if one.solver == solver and (value := getattr(one, quantity))
            ]
            if known:
                across, up = zip(*known, strict=True)
                axes.plot(across, up, label=solver, markersize=4.5, **curve_style(solver))
        axes.invert_xaxis()
        axes.set_xlabel("process zone over contact radius")
        axes.set_ylabel(label)
        format_axes(axes)
    figure.axes[0].legend(fontsize=8)
    return figure
