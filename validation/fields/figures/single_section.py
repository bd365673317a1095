"""The section of a single state, and what the sections of several states have in common."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from contact_scene import Scene
from validation.fields.figures import moment_panels, moments, sections
from validation.fields.figures.geometry import magnification, magnification_near_edge, near_edge, section
from validation.fields.figures.quantities import Quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fem_solver.fields.states import FieldState


def single_section(
    state: FieldState, scene: Scene, quantity: Quantity, common: sections.Alike | None = None
) -> Figure:
    """The section of one state, with caption.

    Parameters
    ----------
    state : FieldState
    scene : Scene
    quantity : Quantity
    common : Alike or None
        Magnification, view and colours of all sections; ``None``: of its own.

    Returns
    -------
    Figure
    """
    length = moments.zone(scene, state.contact_radius)
    if common is None:
        scale = magnification(float(np.abs(state.displacement).max()), state.contact_radius)
        edge_scale = magnification_near_edge(state, length, scale)
    else:
        scale, edge_scale = common.scale, common.edge_scale
    cut, at_edge = section(state, scene, scale), section(state, scene, edge_scale)
    return sections.figure(cut, at_edge, quantity, length, moment_panels.caption(state), common)


def alike(states: Sequence[FieldState], scene: Scene, quantity: Quantity) -> sections.Alike:
    """Magnifications, view and range of colours that sections of several states have in common."""
    cut, view, colour_range = moment_panels.sections_alike(states, scene, quantity)
    zones = [moments.zone(scene, state.contact_radius) for state in states]
    scale = cut[0].scale
    edge_scale = min(magnification_near_edge(*one, scale) for one in zip(states, zones, strict=True))
    at_edge = [section(state, scene, edge_scale) for state in states]
    views = [near_edge(*one) for one in zip(at_edge, zones, strict=True)]
    edge_colours = sections.shared_colours(quantity, at_edge, views)
    return sections.Alike(scale, edge_scale, view, colour_range, edge_colours)
