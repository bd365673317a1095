"""How axes look in every figure: grid, ink, notation of numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.drawing.styles import GRID, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = (4.2, 3.1)  # inches of a figure with one pair of axes


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
