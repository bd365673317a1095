"""The paper's figures, redrawn from the runs its claims are judged on.

Axes as in the paper, dimensionless. Where the text of the paper does not say which speeds, penetrations or
forces a figure shows, those of the claims' sweeps are shown.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from validation.claims import paper_panels as panels
from validation.claims.evidence import Evidence, MissingRun
from validation.drawing.axes import SIZE, format_axes
from validation.drawing.styles import INK

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PaperFigure:
    """One figure or panel: ``name`` is a file name, ``draw`` fills axes; ``wide``: as wide as the page."""

    name: str
    caption: str
    draw: Callable[[Figure, Evidence], None]
    wide: bool = False


def draw_figure(figure: PaperFigure, evidence: Evidence) -> Figure | None:
    """The figure; ``None`` if a run it shows is missing."""
    from matplotlib.figure import Figure as New

    drawing = New(figsize=SIZE, layout="constrained")
    try:
        figure.draw(drawing, evidence)
    except MissingRun:
        return None
    for axes in drawing.axes:
        format_axes(axes, (-2, 4))
        if axes.get_legend_handles_labels()[0]:
            legend = axes.legend(
                frameon=False, labelcolor=INK, fontsize=7, handlelength=2.8, labelspacing=0.3
            )
            if axes.child_axes:
                legend.set_loc("lower right")
    return drawing


_BY_DEPTH, _BY_FORCE = ("penetration", "force"), ("force", "contact_radius")

FIGURES = (
    PaperFigure("fig2a", "Fig. 2 (a): cycles, force against penetration",
                panels.diagram(panels.cycles(), *_BY_DEPTH)),
    PaperFigure("fig2b", "Fig. 2 (b): cycles, contact radius against force",
                panels.diagram(panels.cycles(), *_BY_FORCE)),
    PaperFigure("fig2c", "Fig. 2 (c): pull-off force of cycles against speed", panels.pull_off_of_cycles),
    PaperFigure("fig3", "Fig. 3: surface, and pressure (insets), along the cycle at speed 0.002",
                panels.surfaces, wide=True),
    PaperFigure("fig4a", "Fig. 4 (a): relaxed, then withdrawn: force against penetration",
                panels.diagram(panels.retractions(), *_BY_DEPTH)),
    PaperFigure("fig4b", "Fig. 4 (b): the same, contact radius against force",
                panels.diagram(panels.retractions(), *_BY_FORCE)),
    PaperFigure("fig4c", "Fig. 4 (c): pull-off force against initial penetration", panels.preload),
    PaperFigure("dwell-a", "Dwell-time figure (a): force against penetration after a rest, speed 0.1",
                panels.diagram(panels.dwells(), *_BY_DEPTH)),
    PaperFigure("dwell-b", "Dwell-time figure (b): contact radius against force",
                panels.diagram(panels.dwells(), *_BY_FORCE)),
    PaperFigure("dwell-c", "Beside it: pull-off force against the rest, at three speeds", panels.rests),
    PaperFigure("fig5a", "Fig. 5 (a): constant tension, force against penetration", panels.forces),
    PaperFigure("fig5b", "Fig. 5 (b): constant tension, penetration over time", panels.forces_over_time),
    PaperFigure("fig6a", "Fig. 6 (a): sweep, frequencies up to 0.6", panels.sweep(0.0, 0.6)),
    PaperFigure("fig6b", "Fig. 6 (b): sweep, frequencies from 1.8", panels.sweep(1.8, 2.6)),
    PaperFigure("fig6c", "Fig. 6 (c): energy lost per cycle of the sweep", panels.cycle_losses),
    PaperFigure("fig6d", "Fig. 6 (d): oscillation on a slow retraction; dashed: largest tensions",
                panels.oscillation),
    PaperFigure("fig7a", "Fig. 7 (a): energy release rate at pull-off, and pull-off force",
                panels.release_rates),
    PaperFigure("fig7b", "Fig. 7 (b): energy release rate while approaching", panels.approaching),
)  # fmt: skip
