"""A field at the key moments of a run, side by side: same view, same colours, same magnification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contact_scene import Scene
from validation.fields.figures import sections
from validation.fields.figures.colours import ColourRange
from validation.fields.figures.geometry import BodySection, View, magnification, section, whole
from validation.fields.figures.quantities import Quantity
from validation.fields.figures.sections import LENGTH_UNIT, SMALL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_solver.fields.states import FieldState


def sections_alike(
    states: Sequence[FieldState], scene: Scene, quantity: Quantity
) -> tuple[list[BodySection], View, ColourRange]:
    """Sections, and the one view and table of colours that serve all of them."""
    largest = max(state.contact_radius for state in states)
    displaced = max(float(np.abs(state.displacement).max()) for state in states)
    scale, view = magnification(displaced, largest), whole(largest)
    cut = [section(state, scene, scale) for state in states]
    return cut, view, sections.shared_colours(quantity, cut, [view] * len(cut))


def figure(states: Sequence[FieldState], scene: Scene, quantity: Quantity) -> Figure:
    """One panel a state, two in a row.

    Raises
    ------
    NoRendering
        If VTK cannot draw here.
    """
    from matplotlib.figure import Figure as New

    cut, view, colour_range = sections_alike(states, scene, quantity)
    rows = (len(cut) + 1) // 2
    panel_figure = New(figsize=(10.0, 0.6 + 2.85 * rows), layout="compressed")
    panels = panel_figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
    for axes, body in zip(panels.flat, cut, strict=False):
        sections.draw(axes, body, view, quantity, colour_range)
        axes.set_title(caption(body.state), fontsize=SMALL + 1)
    for axes in panels.flat[len(cut) :]:
        axes.set_axis_off()
    for axes in panels[-1]:
        axes.set_xlabel(f"r, mirrored {LENGTH_UNIT}", fontsize=SMALL + 1)
    for axes in panels[:, 0]:
        axes.set_ylabel(f"z {LENGTH_UNIT}", fontsize=SMALL + 1)
    sections.key(panels[0, 0], cut[-1])
    panel_figure.suptitle(f"displacements {sections.times(cut[0].scale)}", fontsize=SMALL + 1)
    sections.bar(panel_figure, list(panels.flat), quantity, colour_range)
    return panel_figure


def caption(state: FieldState) -> str:
    """A state in words: time, penetration, force, in the units of the scene."""
    name = f"{state.label}: " if state.label else ""
    text = f"{name}t = {state.time:.4g}, Δ = {state.penetration:.3g}, F = {state.force:.3g}"
    return text.replace("-0", "−0").replace("= -", "= −")
