"""The surface of the half-space with the mesh at one of its places."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import dtrmv
from scipy.linalg.lapack import dtrtrs

from contact_scene import Scene
from fem_solver.edge_geometry import SURFACE_MARGIN, EdgeGeometry, surface_margin
from fem_solver.following.elastic_scales import closure_scales, height_stretch
from fem_solver.halfspace import HalfSpace
from fem_solver.surface import SurfaceOperator

Array = NDArray[np.float64]

_PLACES = 32
"""Places whose surface is kept; the least recently used one is dropped."""


@dataclass(frozen=True)
class UnscaledSurface:
    """A mesh that is not scaled: its surface nodes and their compliance ``L L^T`` at unit shear modulus.

    Parameters
    ----------
    radii : ndarray, shape (n,)
    root : ndarray, shape (n, n)
        ``L``.
    unit : ndarray, shape (n,)
        ``L^-1 1``.
    effective, positions : ndarray, shape (n,)
        Radius of the flat punch as stiff as contact of the nodes ``0..m``, and radius at which each component
        sits (see ``surface``).
    closure_scale : ndarray, shape (n,)
    height_stretch : float
        See ``elastic_scales``.
    strip : tuple of float
        Radii between which the surface is fine.
    """

    radii: Array
    root: Array
    unit: Array
    effective: Array
    positions: Array
    closure_scale: Array
    height_stretch: float
    strip: tuple[float, float]

    @property
    def stretch(self) -> float:
        """Contact radius of an edge in the strip over the radius of its node.

        Contact radii follow from stiffnesses, whose error is some 1e-5 of the radius: more than the strip's
        length where zones are short.
        """
        if self.strip[0] <= 0.0:
            return 1.0
        middle = int(np.searchsorted(self.radii, 0.5 * (self.strip[0] + self.strip[1])))
        return float(self.effective[middle] / self.radii[middle])


@dataclass(frozen=True)
class Placement:
    """An unscaled surface, scaled: ``root`` remains, everything else is in the scene's units.

    Parameters
    ----------
    place : object
        Names the place.
    root : ndarray, shape (n, n)
    scale : float
    unit, radii, positions, height, profile : ndarray, shape (n,)
        ``L^-1 1``, radii of the nodes and of the components, the indenter's height at the nodes and its
        transform ``L^-1 h``.
    closure_scale : ndarray, shape (n,)
        Closure integral on the mesh over the energy that contact up to each node releases.
    geometry : EdgeGeometry
    lowest : float
        Least edge position, in nodes, around which the mesh resolves the process zone.
    stretch : float
        Contact radius of an edge in the fine strip over the radius of its node.
    rim : float
        Largest radius the indenter touches.
    """

    place: Any
    root: Array
    scale: float
    unit: Array
    radii: Array
    positions: Array
    height: Array
    profile: Array
    closure_scale: Array
    geometry: EdgeGeometry
    lowest: float
    stretch: float
    rim: float

    @property
    def fine_intervals(self) -> int:
        """Node spacings of the fine strip."""
        return self.geometry.last - int(self.lowest)

    @property
    def fine_range(self) -> float:
        """Length of the fine strip."""
        radii = self.geometry.radii
        return float(radii[self.geometry.last] - radii[int(self.lowest)])

    def forces(self, y: Array, first: int = 0) -> Array:
        """``L^-T y`` for the entries from ``first`` on, of a vector that ends there."""
        block = self.root[first : first + len(y), first : first + len(y)]
        return np.sqrt(self.scale) * dtrtrs(block, y, lower=1, trans=1)[0]

    def displacement(self, v: Array) -> Array:
        """``L v``; shape (n,)."""
        return dtrmv(self.root, v, lower=1) / np.sqrt(self.scale)

    def displacement_of(self, v: Array, first: int, end: int) -> Array:
        """``L v`` of the nodes ``first..end-1``.

        Parameters
        ----------
        v : ndarray, shape (n,)
        first, end : int
            Range of nodes.

        Returns
        -------
        ndarray, shape (end - first,)
            Lengths, positive downwards.
        """
        return self.root[first:end, :end] @ v[:end] / np.sqrt(self.scale)


class Surfaces:
    """Surfaces at all places, made when they are first asked for.

    Parameters
    ----------
    scene : Scene
    meshes : object
        With ``place(radius)``, ``scale(place)``, ``mesh(level)``, ``largest``, and places that have a
        ``level``. The one at the axis is not scaled but by the length that an edge keeps from the ends of the
        fine strip: the process zone, or less.
    ratio : float
        ``G/K``.
    plane_modulus : float
        ``E*`` at unit shear modulus.
    form, far_field
        As of :class:`~fem_solver.options.Options`.
    """

    def __init__(
        self, scene: Scene, meshes: Any, ratio: float, plane_modulus: float, form: str, far_field: bool
    ) -> None:
        self._scene, self._meshes, self.ratio = scene, meshes, ratio
        self._plane_modulus, self._form, self._far_field = plane_modulus, form, far_field
        self._levels: dict[int, UnscaledSurface] = {}
        self._placements: OrderedDict[Any, Placement] = OrderedDict()
        self.zone: float = scene.adhesion.zone if scene.adhesion is not None else 0.0
        self._shortest = scene.adhesion.closing_zone if scene.adhesion is not None else 0.0
        self._unit = float(meshes.scale(meshes.place(0.0)))
        self._stress = scene.adhesion.stress if scene.adhesion is not None else None
        self.largest = float(meshes.largest)
        self.rim = scene.indenter.edge
        self.reach = min(SURFACE_MARGIN * self.largest, self.rim)

    @property
    def factorisations(self) -> int:
        """Levels factorised so far."""
        return len(self._levels)

    def around(self, radius: float) -> Placement:
        """The surface with the mesh placed around a contact radius."""
        place = self._meshes.place(max(radius, 0.0))
        return self.at(self._meshes.place(max(radius, 0.0) / self._level(place.level).stretch))

    def at(self, place: Any) -> Placement:
        """The surface with the mesh at a place."""
        if place not in self._placements:
            self._placements[place] = self._place(place)
            while len(self._placements) > _PLACES:
                self._placements.popitem(last=False)
        self._placements.move_to_end(place)
        return self._placements[place]

    def _place(self, place: Any) -> Placement:
        level, scale = self._level(place.level), float(self._meshes.scale(place))
        radii, root = scale * level.radii, np.sqrt(scale)
        height = self._scene.indenter.height(level.height_stretch * radii)
        low, high = (scale * end for end in level.strip)
        geometry = EdgeGeometry(
            radii,
            scale * level.effective,
            self.zone,
            reach=high,
            edge=math.inf,  # the rim of a punch lies between two nodes; the search ends there
            stress=self._stress,
            shortest=self._shortest,
            margin=self._unit,
        )
        return Placement(
            place=place,
            root=level.root,
            scale=scale,
            unit=root * level.unit,
            radii=radii,
            positions=scale * level.positions,
            height=height,
            profile=root * dtrtrs(level.root, height, lower=1)[0],
            closure_scale=level.closure_scale,
            geometry=geometry,
            lowest=float(np.searchsorted(radii, low + self._unit)) if low > 0.0 else 2.0,
            stretch=level.stretch,
            rim=self.rim,
        )

    def _level(self, level: int) -> UnscaledSurface:
        if level not in self._levels:
            self._levels[level] = self._factorised(level)
        return self._levels[level]

    def half_space(self, level: int) -> tuple[HalfSpace, int]:
        """The half-space on the mesh of a level, not scaled, and the number of surface nodes that count."""
        mesh = self._meshes.mesh(level)
        space = HalfSpace(mesh, self._form == "mixed", self._far_field)
        # a mesh is scaled down to half at most
        reach = 2.0 * surface_margin(self._stress) * self.largest / self._unit
        count = int(np.searchsorted(space.radii, max(reach, SURFACE_MARGIN * mesh.parameters.fine_to)))
        return space, min(count + 1 - count % 2, len(space.radii))

    def _factorised(self, level: int) -> UnscaledSurface:
        space, count = self.half_space(level)
        operator = SurfaceOperator(space.factorise(self.ratio, count).compliance()[0])
        fine, radii = self._meshes.mesh(level).parameters, space.radii[:count]
        strip = float(fine.fine_from), float(fine.fine_to)
        effective = operator.effective_radii(self._plane_modulus)
        positions = operator.transform_radii(radii)
        return UnscaledSurface(
            radii=radii,
            root=np.asfortranarray(operator.root()),
            unit=operator.unit,
            effective=effective,
            positions=positions,
            closure_scale=closure_scales(operator, radii, effective, strip, self._plane_modulus),
            height_stretch=height_stretch(radii, effective, positions, strip),
            strip=strip,
        )
