"""A section through the axis: the deformed body with indenter, contact edge and process zone, and what of it
a figure shows.

Axes of a section: r across with the axis of symmetry at 0, mirrored to negative values; z upwards with the
undeformed surface at 0, in the length of the scene. Displacements are magnified by a stated scale; the
indenter is magnified alike in height, so that it touches where the surface does. Numbers only; nothing is
drawn here.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contact_scene import Scene
from contact_scene.trace import Array
from validation.fields.moments import zone_length
from validation.fields.quantities import ColourRange, Quantity, colours

if TYPE_CHECKING:
    from fem_solver import FieldState


HALF_WIDTH = 2.0
"""Half the width of a view, over the largest contact radius."""
LARGEST_DRAWN = 0.2
"""Largest magnified displacement, over half the width of the view."""
ZONES_NEAR_EDGE = 4.0
"""Half the width of the view of an edge, in process zones."""
BELOW = 1.2
"""Depth of a view of a layer, in its thicknesses, at most."""
LEAST_AREA = 0.25
"""What magnified displacements leave at least of the area of a triangle there: below 0 it is folded over."""


def triangle_areas(state: FieldState) -> Array:
    """Undeformed area of each triangle of the section; shape (4 m,)."""
    return np.abs(signed_areas(state.points, state.triangles))


def signed_areas(points: Array, triangles: NDArray[np.int64]) -> Array:
    """Areas (t,) of triangles (t, 3) between points (n, 2); the sign changes where one is folded over."""
    corners = points[triangles]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])


def surface_nodes(state: FieldState) -> NDArray[np.int64]:
    """Nodes of the surface from the axis outwards."""
    nodes = np.flatnonzero(state.points[:, 1] == 0.0)
    return nodes[np.argsort(state.points[nodes, 0])]


def outline(scene: Scene, penetration: float, reach: float, scale: float = 1.0) -> Array:
    """Radii and magnified heights of the indenter up to a radius; a flat punch has an upright side."""
    edge = scene.indenter.edge
    r = np.concatenate(([0.0], np.geomspace(1e-4 * reach, min(reach, edge), 400)))
    line = np.column_stack([r, scale * (scene.indenter.height(r) - penetration)])
    return np.vstack([line, [edge, line[-1, 1] + reach]]) if math.isfinite(edge) and edge < reach else line


@dataclass(frozen=True)
class View:
    """The part of a section that is shown: ``left <= x <= right``, ``bottom <= y <= top``."""

    left: float
    right: float
    bottom: float
    top: float

    @property
    def aspect(self) -> float:
        """Width over height."""
        return (self.right - self.left) / (self.top - self.bottom)


@dataclass(frozen=True)
class AxialSection:
    """One state, displacements magnified by ``scale``; lines have shape (k, 2), from the axis outwards."""

    state: FieldState
    scene: Scene
    scale: float = 1.0

    @cached_property
    def points(self) -> Array:
        """Nodes of the right-hand half after deformation, shape (n, 2)."""
        return self.state.points + self.scale * self.state.displacement

    @cached_property
    def surface(self) -> Array:
        """The deformed surface."""
        return self.points[surface_nodes(self.state)]

    @cached_property
    def indenter(self) -> Array:
        """The indenter's outline."""
        reach = float(self.state.points[surface_nodes(self.state)[-1], 0])
        return outline(self.scene, self.state.penetration, reach, self.scale)

    @cached_property
    def edge(self) -> Array:
        """Contact edge on the deformed surface, shape (2,)."""
        return self._on_surface(np.array([self.state.contact_radius]))[0]

    @cached_property
    def zone(self) -> Array:
        """The deformed surface from the edge to the end of the process zone; empty without adhesion."""
        a = self.state.contact_radius
        if not self.scene.is_adhesive or a == 0.0:
            return np.empty((0, 2))
        radii, end = self.state.points[surface_nodes(self.state), 0], a + self.zone_length
        return self._on_surface(np.concatenate(([a], radii[(radii > a) & (radii < end)], [end])))

    @property
    def thickness(self) -> float:
        """Of a layer; infinite for a half-space."""
        return math.inf if self.scene.body is None else self.scene.body.thickness

    @property
    def zone_length(self) -> float:
        """Undeformed length of the process zone, or of what takes its place."""
        return zone_length(self.scene, self.state.contact_radius)

    @cached_property
    def areas(self) -> Array:
        """Undeformed area of the section that each node stands for, shape (n,)."""
        each = np.repeat(triangle_areas(self.state) / 3.0, 3)
        return np.bincount(self.state.triangles.ravel(), each, len(self.points)).astype(float)

    def within(self, view: View) -> NDArray[np.bool_]:
        """Which nodes, or their mirror images, lie in a view."""
        x, y = self.points.T
        across = ((x >= view.left) & (x <= view.right)) | ((-x >= view.left) & (-x <= view.right))
        return across & (y >= view.bottom) & (y <= view.top)

    def _on_surface(self, r: Array) -> Array:
        radii = self.state.points[surface_nodes(self.state), 0]
        return np.column_stack([np.interp(r, radii, self.surface[:, k]) for k in (0, 1)])


@dataclass(frozen=True)
class Look:
    """What pictures of several states have in common: magnification, view, range of colours.

    ``half_width`` is that of the view of a whole contact; ``None``: each picture shows its right-hand edge.
    """

    quantity: Quantity
    scale: float
    half_width: float | None
    colours: ColourRange

    def view(self, cut: AxialSection) -> View:
        """The part of a section that is shown."""
        return _view(cut, self.half_width)


def look_at(states: Sequence[FieldState], scene: Scene, quantity: Quantity) -> Look:
    """One look at the contacts of some states, and at what is under them."""
    radius = max(state.contact_radius for state in states)
    largest = max(float(np.abs(state.displacement).max()) for state in states)
    return _look(states, scene, quantity, magnification(largest, radius), HALF_WIDTH * radius)


def looks(states: Sequence[FieldState], scene: Scene, quantity: Quantity) -> tuple[Look, Look]:
    """Common looks at the contacts of some states as a whole, and at their edges."""
    whole = look_at(states, scene, quantity)
    zones = [zone_length(scene, state.contact_radius) for state in states]
    scale = min(magnification_near_edge(*one, whole.scale) for one in zip(states, zones, strict=True))
    return whole, _look(states, scene, quantity, scale, None)


def _look(
    states: Sequence[FieldState], scene: Scene, quantity: Quantity, scale: float, half: float | None
) -> Look:
    cut = [AxialSection(state, scene, scale) for state in states]
    shown = [one.within(_view(one, half)) for one in cut]
    values = [quantity.values(one.state)[inside] for one, inside in zip(cut, shown, strict=True)]
    areas = [one.areas[inside] for one, inside in zip(cut, shown, strict=True)]
    return Look(quantity, scale, half, colours(quantity.kind, values, areas))


def _view(cut: AxialSection, half: float | None) -> View:
    if half is not None:
        return View(-half, half, -min(0.8 * half, BELOW * cut.thickness), 0.4 * half)
    (x, y), half = cut.edge, ZONES_NEAR_EDGE * cut.zone_length
    return View(x - half, x + half, y - 1.2 * half, y + 0.8 * half)


def magnification(largest: float, contact_radius: float) -> float:
    """The largest of 1, 2, 5, 10, ... (or 1/2, 1/5, ...) that keeps displacements below ``LARGEST_DRAWN``."""
    if largest <= 0.0:
        return 1.0
    return _round_below(LARGEST_DRAWN * HALF_WIDTH * contact_radius / largest * (1.0 + 1e-9))


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


def _round_below(limit: float) -> float:
    """The largest of ..., 1/2, 1, 2, 5, 10, ... up to a limit."""
    power = 10.0 ** math.floor(math.log10(limit))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= limit)
