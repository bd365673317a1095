"""Figures of a study: error over size for every scheme, error over run time and over work.

A scheme keeps its colour, line style and marker in all of them. A level that failed is a cross at the upper
edge, at its size; it has no run time, so in the other figures it stands in a list at the upper edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import INK
from validation.studies.convergence import Convergence
from validation.studies.schemes import scheme
from validation.studies.work_precision import cost

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WORK_LABELS = {
    "wall_seconds": "run time (s)",
    "cpu_seconds": "processor time (s)",
    "steps": "accepted steps",
    "linear_solves": "triangular solves",
    "closure_evaluations": "closure evaluations",
}


@dataclass(frozen=True)
class Chart:
    """One figure: an error over level size (``work`` empty) or over a kind of work."""

    name: str
    caption: str
    measure: str
    work: str = ""


CONVERGENCE = (
    Chart("order-pull-off", "Pull-off force: error over level size", "pull_off_force"),
    Chart("order-loop", "Loop integral: error over level size", "loop_energy"),
    Chart("order-force", "F(t), RMS: error over level size", "force, RMS"),
    Chart("order-radius", "a(t), RMS: error over level size", "radius, RMS"),
)
PRICES = (
    Chart("price-force", "F(t), RMS, against run time", "force, RMS", "wall_seconds"),
    Chart("price-processor", "F(t), RMS, against processor time", "force, RMS", "cpu_seconds"),
    Chart("price-pull-off", "Pull-off force against run time", "pull_off_force", "wall_seconds"),
    Chart("price-loop", "Loop integral against run time", "loop_energy", "wall_seconds"),
    Chart("price-steps", "F(t), RMS, against steps", "force, RMS", "steps"),
    Chart("price-solves", "F(t), RMS, against triangular solves", "force, RMS", "linear_solves"),
)


def draw(chart: Chart, studies: Sequence[Convergence]) -> Figure | None:
    """One chart on logarithmic axes; ``None`` if nothing in it is known and nothing failed."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.add_subplot()
    axes.set_xscale("log")
    axes.set_yscale("log")
    drawn, failed = False, False
    for row, study in enumerate(studies):
        style = scheme(study.ladder.scheme).curve_style | {"linewidth": 1.4}
        points = [(x, y) for x, y in _points(study, chart) if x > 0.0 and y > 0.0]
        if points:
            x, y = zip(*points, strict=True)
            axes.plot(x, y, label=study.ladder.scheme, markersize=4.5, **style)
            drawn = True
        failed |= _failures(axes, study, chart, style["color"], 0.97 - 0.05 * row)
    if not drawn and not failed:
        return None
    if not chart.work:
        _slopes(axes, [p for study in studies for p in _points(study, chart) if min(p) > 0.0])
        axes.invert_xaxis()
    _label(axes, chart)
    return figure


def _points(study: Convergence, chart: Chart) -> list[tuple[float, float]]:
    """Across and up, coarse to fine; sizes are relative to the coarsest level of the scheme."""
    coarsest = study.runs[0].level.size
    found = []
    for run in study.runs:
        across = cost(run, chart.work) if chart.work else run.level.size / coarsest
        if across is not None and chart.measure in run.errors:
            found.append((across, abs(run.errors[chart.measure])))
    return found


def _failures(axes: Axes, study: Convergence, chart: Chart, colour: str, height: float) -> bool:
    """Failed levels as crosses near the upper edge: at their size, or one after the other.

    Parameters
    ----------
    axes : Axes
    study : Convergence
    chart : Chart
    colour : str
    height : float
        Of the crosses, as a part of the axes.

    Returns
    -------
    bool
        Whether there are any.
    """
    coarsest = study.runs[0].level.size
    failed = [run for run in study.runs if run.failed and not run.refused]
    if not failed:
        return False
    mark: dict[str, Any] = {"linestyle": "none", "marker": "x", "markersize": 7, "color": colour}
    label = f"{study.ladder.scheme}: {len(failed)} failed"
    if chart.work:
        across = [0.04 + 0.04 * i for i in range(len(failed))]
        axes.plot(across, [height] * len(failed), transform=axes.transAxes, label=label, **mark)
    else:
        across = [run.level.size / coarsest for run in failed]
        axes.plot(across, [height] * len(failed), transform=axes.get_xaxis_transform(), label=label, **mark)
    return True


def _slopes(axes: Axes, points: Sequence[tuple[float, float]]) -> None:
    """Lines of order 1 and 2 to compare with."""
    if not points:
        return
    low, high = min(x for x, _ in points), 1.0
    if low >= high:
        return
    top = max(y for _, y in points)
    for order, dash in ((1, (0, (6, 3))), (2, (0, (6, 2, 1, 2)))):
        ends = [top * x**order for x in (high, low)]
        axes.plot((high, low), ends, color=INK, linewidth=0.7, linestyle=dash, label=f"order {order}")


def _label(axes: Axes, chart: Chart) -> None:
    from matplotlib.ticker import NullFormatter

    axes.set_xlabel(WORK_LABELS[chart.work] if chart.work else "level size h/h₀ (finer to the right)")
    axes.set_ylabel(f"relative error, {chart.measure.replace('_', ' ')}")
    format_axes(axes)
    for axis in (axes.xaxis, axes.yaxis):  # few decades: labels between them would run into each other
        axis.set_minor_formatter(NullFormatter())
    columns = min(4, len(axes.get_legend_handles_labels()[0]))
    axes.figure.legend(  # above the axes, where it hides no point
        loc="outside upper center",
        ncols=columns,
        frameon=False,
        labelcolor=INK,
        fontsize="x-small",
        handlelength=2.4,
        columnspacing=1.0,
    )
