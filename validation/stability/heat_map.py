"""Heat map of a solver over the stiff and extreme matrix: colour is the error, the letter how it ended.

One row an axis, one field a case, numbered as in the table. The colours are those of cividis, which a
colour-blind reader sees alike; a fault is framed and crossed out, so that no colour is needed to find it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from validation.drawing.styles import INK, VERMILION
from validation.stability.matrix import Cell, CellVerdict

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEAST, MOST = -8.0, 0.0  # log10 of the errors that are told apart
BLANK = "#c9c9c9"  # a field without an error: an answer that there is none
FAULT = VERMILION
LETTERS = {
    "completed": "c", "detached": "d", "refused": "R", "no equilibrium at the start": "N",
    "step underflow": "U", "step budget exhausted": "B", "not finite": "F", "out of range": "O",
    "out of the model's range": "Z", "trigger not reached": "T", "breakdown": "L", "interrupted": "I",
    "hung": "H", "raised": "X", "died": "X",
}  # fmt: skip
LEGEND = (
    "c completed, d detached, R refused, N no equilibrium, U step underflow, B step budget, F not finite, "
    "O out of range, Z contact as short as the process zone, T trigger not reached, L contact lost while "
    "pressed in, I interrupted, H hung, X crashed, "
    "? not compared; underlined: reports no answer; framed and crossed out: silently wrong, crashed, not "
    "finite or hung"
)


def draw(cells: Sequence[Cell], numbers: dict[tuple[str, str], int]) -> Figure:
    """The map of one solver; ``numbers`` are those of the cases, by axis and label."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    axes_names = list(dict.fromkeys(cell.axis for cell in cells))
    rows = {name: [cell for cell in cells if cell.axis == name] for name in axes_names}
    widest = max(len(row) for row in rows.values())
    figure = Figure(figsize=(2.2 + 0.36 * widest, 0.9 + 0.42 * len(rows)), layout="constrained")
    axes = figure.add_subplot()
    colours = ScalarMappable(Normalize(LEAST, MOST), colormaps["cividis"])
    for down, name in enumerate(axes_names):
        for across, cell in enumerate(rows[name]):
            _field(axes, across, down, cell, numbers[cell.axis, cell.label], colours)
    axes.set_xlim(0, widest)
    axes.set_ylim(len(rows), 0)
    axes.set_yticks([down + 0.5 for down in range(len(rows))], axes_names, color=INK)
    axes.set_xticks([])
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    bar = figure.colorbar(colours, ax=axes, shrink=0.8, pad=0.01, extend="both")
    bar.set_label("relative error", color=INK)
    bar.set_ticks([-8, -6, -4, -2, 0], labels=["1e-8", "1e-6", "1e-4", "1e-2", "1"], color=INK)
    return figure


def level(cell: Cell) -> float | None:
    """``log10`` of the error within the range of the colours; ``None`` without an error."""
    error = cell.error
    if error is None:
        return None
    if error <= 0.0:
        return LEAST
    return min(max(math.log10(error), LEAST), MOST) if math.isfinite(error) else MOST


def letter(cell: Cell) -> str:
    """How the run ended."""
    return "?" if cell.verdict is CellVerdict.UNKNOWN else LETTERS.get(cell.outcome, "?")


def _field(axes: Axes, across: int, down: int, cell: Cell, number: int, colours) -> None:
    from matplotlib.patches import Rectangle

    value = level(cell)
    colour = BLANK if value is None else colours.to_rgba(value)
    axes.add_patch(Rectangle((across + 0.04, down + 0.06), 0.92, 0.88, facecolor=colour, linewidth=0))
    light = value is None or value > 0.55 * LEAST + 0.45 * MOST
    ink = "#000000" if light else "#ffffff"
    axes.text(across + 0.5, down + 0.45, letter(cell), ha="center", va="center", fontsize=9, color=ink)
    axes.text(across + 0.9, down + 0.86, str(number), ha="right", va="center", fontsize=5.5, color=ink)
    if cell.verdict is CellVerdict.DECLINED:
        axes.plot([across + 0.25, across + 0.75], [down + 0.7, down + 0.7], color=ink, linewidth=1.2)
    if cell.fault:
        frame = Rectangle((across + 0.08, down + 0.1), 0.84, 0.8, fill=False, edgecolor=FAULT, linewidth=2.2)
        axes.add_patch(frame)
        axes.plot([across + 0.12, across + 0.88], [down + 0.86, down + 0.14], color=FAULT, linewidth=1.6)
