"""Steps, updates, time, memory and errors of every solver over the process zone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import curve_style
from validation.report.document import plain
from validation.studies.zones import OBSERVED, ZoneRun

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _error_of(name: str) -> Callable[[ZoneRun], float | None]:
    return lambda one: abs(one.errors[name]) if name in one.errors else None


PANELS: dict[str, Callable[[ZoneRun], float | None]] = {
    "accepted steps": lambda one: one.steps,
    "updates of the history in a step": lambda one: one.updates,
    "processor time (s)": lambda one: one.seconds,
    "memory of the process (MB)": lambda one: one.megabytes,
    **{f"error of {plain(name)} (relative)": _error_of(name) for name in OBSERVED},
}
COLUMNS = 3


def draw(runs: Sequence[ZoneRun]) -> Figure:
    """Logarithmic axes, one for each quantity; a solver's curve ends at the last zone it was run with."""
    from matplotlib.figure import Figure

    rows = len(PANELS) // COLUMNS
    figure = Figure(figsize=(COLUMNS * SIZE[0], rows * SIZE[1]), layout="constrained")
    for axes, (label, value_of) in zip(figure.subplots(rows, COLUMNS).flat, PANELS.items(), strict=True):
        axes.set_xscale("log")
        axes.set_yscale("log")
        for solver in dict.fromkeys(one.solver for one in runs):
            own = [(one.ratio, value_of(one)) for one in runs if one.solver == solver]
            known = [(ratio, value) for ratio, value in own if value]
            if known:
                across, up = zip(*known, strict=True)
                axes.plot(across, up, label=solver, markersize=4.5, **curve_style(solver))
        axes.invert_xaxis()
        axes.set_xlabel("process zone over contact radius")
        axes.set_ylabel(label)
        format_axes(axes)
    if figure.axes[0].lines:  # no solver may have answered
        figure.axes[0].legend(fontsize=8)
    return figure
