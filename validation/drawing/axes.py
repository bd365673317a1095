"""How axes look in every figure: grid, ink, notation of numbers."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from validation.drawing.styles import GRID, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (4.2, 3.1)  # inches of a figure with one pair of axes
OF_THE_SI = re.compile(r" \((m|N|s)\)$")
"""End of a label with a unit whose numbers carry a prefix: ``20 nm``."""


def drawing(
    size: tuple[float, float] = SIZE, *grid: int, layout: Any = "constrained", **how: Any
) -> tuple[Figure, Any]:
    """A figure of so many inches, and its axes, or those of a grid of rows and columns."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout=layout)
    return figure, figure.subplots(*grid, **how)


def format_axes(axes: Axes, powers: tuple[int, int] = (-3, 4), grid_width: float = 0.5) -> None:
    """Give axes and their insets grid, ink and notation: no power of ten between ``powers``."""
    from matplotlib.ticker import ScalarFormatter

    axes.grid(True, which="major", color=GRID, linewidth=grid_width)
    axes.set_axisbelow(True)
    for one in (axes, *axes.child_axes):
        one.tick_params(which="both", colors=INK, labelcolor=INK)
        for spine in one.spines.values():
            spine.set_color(INK)
        one.title.set_color(INK)
        for axis in (one.xaxis, one.yaxis):
            axis.label.set_color(INK)
            axis.get_offset_text().set_color(INK)
            if isinstance(axis.get_major_formatter(), ScalarFormatter):  # neither words nor logarithms
                one.ticklabel_format(
                    axis="x" if axis is one.xaxis else "y", style="sci", scilimits=powers, useOffset=False
                )


def label_axes(axes: Axes, across: str, up: str) -> None:
    """Label axes; numbers in a unit of the SI carry it and a prefix."""
    from matplotlib.ticker import EngFormatter

    for axis, label in ((axes.xaxis, across), (axes.yaxis, up)):
        unit = OF_THE_SI.search(label)
        axis.set_label_text(label if unit is None else label[: unit.start()])
        if unit is not None:
            axis.set_major_formatter(EngFormatter(unit[1]))
