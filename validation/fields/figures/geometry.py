"""What a section shows and where: the body mirrored about the axis, deformed, with indenter and contact edge.

Axes of a section: r across with the axis of symmetry at 0, mirrored to negative values; z upwards with the
undeformed surface at 0, in the length of the scene. Displacements are magnified by a stated scale; the
indenter is magnified alike in height, so that it touches where the surface does. Numbers only; nothing is
drawn here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from validation.fields.section_mesh import signed_areas, surface_nodes, triangle_areas

if TYPE_CHECKING:
    from fem_solver.fields.states import FieldState

Array = NDArray[np.float64]

HALF_WIDTH = 2.0
"""Half the width of a view, over the largest contact radius."""
LARGEST_DRAWN = 0.2
"""Largest magnified displacement, over half the width of the view."""
ZONES_NEAR_EDGE = 4.0
"""Half the width of the view of an edge, in process zones."""
LEAST_AREA = 0.25
"""What magnified displacements leave at least of the area of a triangle there: below 0 it is folded over."""


@dataclass(frozen=True)
class View:
    """The part of a section that is shown: ``left <= x <= right``, ``bottom <= y <= top``."""

    left: float
    right: float
    bottom: float
    top: float

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """As ``imshow`` takes it."""
        return self.left, self.right, self.bottom, self.top

    @property
    def aspect(self) -> float:
        """Width over height."""
        return (self.right - self.left) / (self.top - self.bottom)


def whole(contact_radius: float) -> View:
    """The view that holds a contact of this radius and what is under it."""
    half = HALF_WIDTH * contact_radius
    return View(-half, half, -0.8 * half, 0.4 * half)


def near_edge(section: BodySection, zone: float) -> View:
    """The view of the right-hand edge, a few process zones wide."""
    x, y = section.edge
    half = ZONES_NEAR_EDGE * zone
    return View(x - half, x + half, y - 1.2 * half, y + 0.8 * half)


def magnification(largest: float, contact_radius: float) -> float:
    """The largest of 1, 2, 5, 10, ... (or 1/2, 1/5, ...) that keeps displacements below ``LARGEST_DRAWN``."""
    if largest <= 0.0:
        return 1.0
    return _round_below(LARGEST_DRAWN * HALF_WIDTH * contact_radius / largest * (1.0 + 1e-9))


def _round_below(limit: float) -> float:
    """The largest of ..., 1/2, 1, 2, 5, 10, ... up to a limit."""
    power = 10.0 ** math.floor(math.log10(limit))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= limit)


def magnification_near_edge(state: FieldState, zone: float, scale: float) -> float:
    """``scale``, or the largest round number below it that folds no triangle over around the edge.

    Strain there goes with the root of one over the zone: what shows the whole contact may be far too much.
    """
    away = np.abs(state.points[state.triangles] - (state.contact_radius, 0.0)).max(axis=2).min(axis=1)
    near = state.triangles[away < 2.0 * ZONES_NEAR_EDGE * zone]
    before = signed_areas(state.points, near)

    def least_area(factor: float) -> float:
        after = signed_areas(state.points + factor * state.displacement, near)
        return float((after / before).min(initial=1.0))

    while least_area(scale) < LEAST_AREA:
        scale = _round_below(scale * 0.99)
    return scale


@dataclass(frozen=True)
class BodySection:
    """One state, ready to be drawn.

    Parameters
    ----------
    state : FieldState
    scale : float
        Magnification of displacements.
    moved : (n, 2) array
        Nodes of the right-hand half (x >= 0) after deformation.
    surface : (k, 2) array
        Deformed surface from the axis outwards.
    indenter : (j, 2) array
        Its outline from the axis outwards.
    edge : (2,) array
        Contact edge on the deformed surface.
    zone : (i, 2) array
        The deformed surface from the edge to the end of the process zone; empty without adhesion.
    """

    state: FieldState
    scale: float
    moved: Array
    surface: Array
    indenter: Array
    edge: Array
    zone: Array

    @cached_property
    def top(self) -> NDArray[np.int64]:
        """Nodes of ``surface``, shape (k,)."""
        return surface_nodes(self.state)

    @cached_property
    def areas(self) -> Array:
        """Undeformed area of the section that each node stands for, shape (n,)."""
        area = triangle_areas(self.state)
        return np.bincount(self.state.triangles.ravel(), np.repeat(area / 3.0, 3), len(self.moved)).astype(
            float
        )

    def within(self, view: View) -> NDArray[np.bool_]:
        """Which nodes, or their mirror images, lie in a view."""
        x, y = self.moved.T
        across = ((x >= view.left) & (x <= view.right)) | ((-x >= view.left) & (-x <= view.right))
        return across & (y >= view.bottom) & (y <= view.top)


def section(state: FieldState, scene: Scene, scale: float = 1.0) -> BodySection:
    """Take from a state of the body what a figure needs; displacements magnified by ``scale``."""
    moved = state.points + scale * state.displacement
    top = surface_nodes(state)
    surface, radii, a = moved[top], state.points[top, 0], state.contact_radius

    def on_surface(r: Array) -> Array:
        return np.column_stack([np.interp(r, radii, surface[:, k]) for k in (0, 1)])

    zone = np.empty((0, 2))
    if scene.adhesion is not None and scene.is_adhesive and a > 0.0:
        end = a + scene.adhesion.zone
        zone = on_surface(np.concatenate(([a], radii[(radii > a) & (radii < end)], [end])))
    body = outline(scene, state.penetration, scale, float(radii[-1]))
    return BodySection(state, scale, moved, surface, body, on_surface(np.array([a]))[0], zone)


def outline(scene: Scene, penetration: float, scale: float, reach: float) -> Array:
    """The indenter from the axis outwards; a flat punch has an upright side.

    Parameters
    ----------
    scene : Scene
    penetration : float
    scale : float
        Magnification of heights.
    reach : float
        Largest radius.

    Returns
    -------
    (j, 2) array
        Radii and heights.
    """
    edge = scene.indenter.edge
    r = np.concatenate(([0.0], np.geomspace(1e-4 * reach, min(reach, edge), 400)))
    y = scale * (scene.indenter.height(r) - penetration)
    line = np.column_stack([r, y])
    return np.vstack([line, [edge, reach]]) if math.isfinite(edge) else line
