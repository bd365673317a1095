"""The surface with the mesh at one of its places: a triangular compliance, in scales of closed forms.

The compliance of the surface nodes, ordered by radius, is factorised once, ``C = L L^T``. Contact of the
nodes ``0..m`` at prescribed displacement ``b`` asks for ``C_mm f = b``. With ``y = L^-1 b``, one triangular
solve for *all* m at once, the nodal forces are ``f = L_mm^-T y_m``, of which those near the edge need a small
trailing block of ``L`` only; the displacement outside is ``L_om y_m``, the total force ``sum_i e_i y_i`` with
``e = L^-1 1``. ``L^-1`` is what the Abel transform is to the continuous half-space: ``y_i/e_i`` is the
penetration of the flat punch reaching to node i that would leave there the same stress singularity.

A set of nodes has no radius of its own. It is assigned that of the flat punch of the same stiffness,
``F = 2 E* A D``, i.e. ``A_m = sum_(i<=m) e_i^2/(2 E*)``, which exceeds the radius of the last node by about a
tenth of an element. Elements are wide away from the strip, which makes contact some 5e-5 stiffer, as if every
radius were so much larger; heights and the closure integral follow these radii:

- Heights are taken at radii at which a paraboloid's contact has Hertz's force.
- The closure integral of a flat punch is ``E* D^2/(2 pi a)`` where its zone is short. On the mesh it depends
  on the place of the edge within the strip, by 2e-6 per zone: where the mesh moves on by some zones, what
  drives the edge would jump, always the same way, and an edge that is about to run away would leap.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.linalg.blas import dtrmv
from scipy.linalg.lapack import dpotrf, dtrtrs

from contact_scene import Indenter, Scene
from fem_solver.closure import ZoneShift
from fem_solver.edge_path import SURFACE_MARGIN, EdgeGeometry, surface_margin
from fem_solver.halfspace import HalfSpace
from fem_solver.layer import LayerDifference
from fem_solver.moduli import Moduli

Array = NDArray[np.float64]

_LEAST_RADIUS = 2.0
"""Least contact radius over the zone at which the closure is told: under a smaller one elements of an edge's
zone reach the axis."""
_ANGLES, _WEIGHTS = np.polynomial.legendre.leggauss(12)


def punch_closure(radius: float, zone: float) -> float:
    """Closure integral at the edge of a flat punch, for unit plane modulus and unit penetration.

    ``int p(x) u(x + zone) dx / (2 zone)`` over the zone, with the pressure ``1/(pi sqrt(a^2 - x^2))`` and the
    gap ``(2/pi) acos(a/x)``; ``1/(2 pi a)`` for a short zone.
    """
    angles, weights = 0.25 * np.pi * (_ANGLES + 1.0), 0.25 * np.pi * _WEIGHTS
    outside = zone * np.sin(angles) ** 2  # takes both roots at the ends
    gap = 2.0 * np.arcsin(np.sqrt(0.5 * outside / (radius + outside)))  # acos(a/x) without a difference
    integrand = gap * np.sqrt(outside) / np.sqrt(2.0 * radius - zone + outside)
    return float(2.0 * (weights @ integrand) / (np.pi**2 * zone))


def triangular(compliance: Array) -> Array:
    """``L`` of the lower triangle of a compliance, which it overwrites if that is in Fortran's order."""
    root, failed = dpotrf(compliance, lower=1, clean=1, overwrite_a=1)
    if failed:
        raise ArithmeticError("the compliance of the surface is not positive definite")
    return np.asfortranarray(root)


def closure_scales(
    root: Array, unit: Array, radii: Array, effective: Array, strip: tuple[float, float], zone: float
) -> Array:
    """Closure integral of a flat punch on the mesh over that of the punch as stiff, by its last node.

    One where the strip has no room for a zone on both sides of an edge: the mesh is fine throughout then.
    """
    shift = ZoneShift(radii, zone)
    first = max(strip[0], _LEAST_RADIUS * zone) + zone
    nodes = np.flatnonzero((radii >= first) & (radii <= strip[1] - zone))
    if nodes.size == 0:
        return np.ones(len(radii))

    def closure(last: int) -> float:
        """At unit shear modulus and unit penetration, pulled, of contact up to a node."""
        first, end = shift.nodes(last, last)
        inside = slice(first, last + 1)
        forces = dtrtrs(root[inside, inside], unit[inside], lower=1, trans=1)[0]
        return float(shift.closure(first, -forces, 1.0 - root[last:end, : last + 1] @ unit[: last + 1]))

    modulus = 0.5 * unit[0] ** 2 / effective[0]
    found = [closure(int(m)) / punch_closure(effective[m], zone) for m in nodes]
    return np.asarray(np.interp(np.arange(len(radii)), nodes, np.array(found) / modulus))


def height_stretch(radii: Array, effective: Array, positions: Array, strip: tuple[float, float]) -> float:
    """Radius at which heights are taken over that of the node.

    A paraboloid bears ``2 E* sum_i (A_i - A_(i-1)) (D - x_i^2/R)``, with the effective radii ``A`` and the
    position ``x`` of each component, and ``2 E* int (D - x^2/R) dx`` by Hertz. Both are made equal over the
    strip. Vertices and mid-side nodes bear differently: a mean of the components that does not weight them
    is off by a hundredth of an element.
    """
    if strip[0] <= 0.0:
        return 1.0
    first, last = np.searchsorted(radii, strip)
    inner, outer = effective[first - 1 : last - 1], effective[first:last]
    borne, by_hertz = positions[first:last] ** 2, (outer**2 + outer * inner + inner**2) / 3.0
    return float(np.sqrt(((outer - inner) @ by_hertz) / ((outer - inner) @ borne)))


_PLACES = 8
"""Places whose surface is kept; the least recently used one is dropped."""


@dataclass(frozen=True)
class UnscaledSurface:
    """A mesh that is not scaled: its surface nodes and their compliance ``L L^T`` at unit shear modulus.

    ``root`` is ``L`` (n, n), ``unit`` is ``L^-1 1``; ``effective`` is the radius of the flat punch as stiff
    as contact of the nodes ``0..m``, ``positions`` where each component sits, ``strip`` the radii between
    which the surface is fine.
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

    def on_layer(self, layer: LayerDifference, scale: float) -> UnscaledSurface:
        """The same mesh on a layer, of whose thickness its unit is ``scale``, up to the layer's reach.

        The layer is taken where heights are. Radii and closure remain those of the half-space: a layer
        changes neither what a node stands for nor the field at the edge.
        """
        stretch = scale * self.height_stretch
        count = int(np.searchsorted(self.radii, layer.reach / stretch)) - 1
        part = slice(count - 1 + count % 2)
        root = self.root[part, part]
        compliance = root @ root.T + scale * layer.compliance(stretch * self.radii[part])
        root = triangular(np.asfortranarray(compliance))
        return replace(
            self,
            radii=self.radii[part],
            root=root,
            unit=dtrtrs(root, np.ones(len(root)), lower=1)[0],
            effective=self.effective[part],
            positions=self.positions[part],
            closure_scale=self.closure_scale[part],
        )


@dataclass(frozen=True)
class Placement:
    """An unscaled surface, scaled: ``root`` is that of the mesh, everything else is in the scene's units.

    ``height`` is that of the indenter at the nodes, ``profile`` its transform ``L^-1 h``; ``closure_scale``
    is the closure integral on the mesh over the energy that contact up to each node releases. Around edge
    positions from ``lowest`` on the mesh resolves the process zone; ``rim`` is the largest radius the
    indenter touches. ``stays``: this place serves every radius of the run.
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
    stays: bool
    plane_tip: float
    indenter: Indenter

    def depth(self, radius: float) -> float:
        """Penetration at which elastic contact without adhesion ends at a radius."""
        return float(self._depth_over(self._shape(radius)))

    def site(self, s: float) -> float:
        """Where components at an edge position sit.

        Aside of the middle of their radii by an error of the stiffness, the same all around.
        """
        node = int(np.floor(s)) + 1
        ends, sites = self.geometry.effective[node - 1 : node + 2], self.positions[node : node + 2]
        return float(2.0 * sites.sum() / (ends[0] + 2.0 * ends[1] + ends[2]) * self.geometry.radius(s))

    def profile_within(self, nodes: slice, share: Any) -> Array:
        """``profile`` of the inner share of radii; with adhesion of the node, as closures see gaps there."""
        if self.geometry.zone is not None:
            return self.profile[nodes]
        return np.asarray(self.profile[nodes] * (1.0 - (1.0 - share) * self._rise[nodes]))

    @cached_property
    def _rise(self) -> Array:
        """Half the rise of ``depth`` over each node's radii, in a line, over its mean there; shape (n,)."""
        radii, rise = self.geometry.ends, np.zeros(len(self.unit))
        depth = self._depth_over(self._shape(radii[radii <= self._largest[0]]))
        inner, outer = depth[:-1], depth[1:]
        np.divide(outer - inner, outer + inner, out=rise[: len(outer)], where=outer + inner > 0.0)
        return rise

    @cached_property
    def depths(self) -> Array:
        """That of each component; shape (n,)."""
        return self.profile / self.unit

    def _shape(self, radius: Any) -> Any:
        """What grows with the radius as depths do, of a paraboloid in proportion, of others at the tip."""
        largest, highest = self._largest
        return (radius / largest) ** 2 + self.indenter.height(radius) / highest

    @cached_property
    def _largest(self) -> tuple[float, float]:
        """Radius of the last component an edge comes to, and the height there, one if all are zero."""
        radius = float(self.positions[self.geometry.last + 1])
        return radius, float(self.indenter.height(radius)) or 1.0

    @cached_property
    def _depth_over(self) -> PchipInterpolator:
        """Through the components, over that."""
        radii = self.positions[: self.geometry.last + 2]
        depths = self.depths[: radii.size]
        tip = int(np.searchsorted(radii, self.plane_tip, side="right"))
        if 0 < tip < radii.size and radii[tip - 1] < self.plane_tip:  # which lies between two components
            radii, depths = np.insert(radii, tip, self.plane_tip), np.insert(depths, tip, 0.0)
        return PchipInterpolator(self._shape(radii), depths)

    @cached_property
    def wide(self) -> NDArray[np.bool_]:
        """Whether each node is away from the fine strip."""
        nodes = np.arange(len(self.radii))
        return np.asarray((nodes < int(self.lowest)) | (nodes > self.geometry.last))

    def forces(self, y: Array, first: int = 0) -> Array:
        """``L^-T y`` for the entries from ``first`` on, of a vector that ends there."""
        block = self.root[first : first + len(y), first : first + len(y)]
        return np.sqrt(self.scale) * dtrtrs(block, y, lower=1, trans=1)[0]

    def displacement(self, v: Array) -> Array:
        """``L v``; shape (n,)."""
        return dtrmv(self.root, v, lower=1) / np.sqrt(self.scale)

    def displacement_of(self, v: Array, first: int, end: int) -> Array:
        """``L v`` of the nodes ``first..end-1``."""
        return self.root[first:end, :end] @ v[:end] / np.sqrt(self.scale)


class Surfaces:
    """Surfaces at all places, made when they are first asked for.

    The meshes have ``place(radius)``, ``scale(place)``, ``mesh(level, looked_into)``, ``parameters(level)``,
    ``least_scale(level)``, ``largest``, for a layer ``layer(reach)``, ``layer_below(level, thickness)`` and
    ``among_fewer(place)``, and places with a ``level``. The one at the axis is scaled by what an edge keeps
    from the ends of the fine strip: the process zone, or less. ``looked_into``: for fields in the body, too.
    """

    def __init__(
        self, scene: Scene, meshes: Any, material: Moduli, far_field: bool, looked_into: bool = False
    ) -> None:
        self._scene, self._meshes, self._far_field = scene, meshes, far_field
        self._looked_into = looked_into
        self._ratio, self._plane_modulus = material.instantaneous_ratio, material.unit_plane_modulus
        self._levels: dict[int, UnscaledSurface] = {}
        self._placements: OrderedDict[Any, Placement] = OrderedDict()
        adhesion = scene.adhesion if scene.is_adhesive else None
        self.zone = adhesion.zone if adhesion is not None else None
        self._shortest = adhesion.closing_zone if adhesion is not None else None
        self._unit = float(meshes.scale(meshes.place(0.0)))
        self._stress = adhesion.stress if adhesion is not None else None
        self.largest = float(meshes.largest)
        self.rim = scene.indenter.edge
        self.reach = min(SURFACE_MARGIN * self.largest, self.rim)
        self._layer: LayerDifference | None = None
        if scene.body is not None:
            reach = surface_margin(self._stress) * self.largest + (self.zone or 0.0)
            self._layer = LayerDifference(
                meshes.layer(reach / scene.body.thickness), scene.body.base, self._ratio
            )

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
        if self._layer is not None and self._scene.body is not None:
            level = level.on_layer(self._layer, scale / self._scene.body.thickness)
        radii, root = scale * level.radii, np.sqrt(scale)
        height = self._scene.indenter.height(level.height_stretch * radii)
        low, high = (scale * end for end in level.strip)
        geometry = EdgeGeometry(
            radii,
            scale * level.effective,
            self.zone,
            reach=high,
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
            stays=self._meshes.place(SURFACE_MARGIN * self.largest).level == 0,
            plane_tip=self._scene.bare_plane_tip,
            indenter=self._scene.indenter,
        )

    def _level(self, level: int) -> UnscaledSurface:
        if level not in self._levels:
            self._levels[level] = self._factorised(level)
        return self._levels[level]

    def volume(self, place: Any) -> tuple[HalfSpace, int]:
        """The body below the surface at a place, not scaled, and the number of surface nodes that count."""
        layer = self._scene.body
        if layer is None:
            return self._half_space(place.level)
        here = self.at(place)
        mesh = self._meshes.layer_below(place.level, layer.thickness / (here.scale * here.stretch))
        sliding = layer.base == "frictionless"
        return HalfSpace(mesh, False, sliding), len(here.radii)

    def for_history(self, place: Any) -> Any:
        """The place where losses are summed up: on a layer, where each has its own volume, one of fewer."""
        return place if self._layer is None else self._meshes.among_fewer(place)

    def volume_of(self, place: Any) -> Any:
        """Names the volume below a place: a layer is another one wherever the mesh is scaled."""
        return place.level if self._layer is None else place

    def _half_space(self, level: int) -> tuple[HalfSpace, int]:
        """The half-space on the mesh of a level, not scaled, and the number of surface nodes that count."""
        mesh = self._meshes.mesh(level, self._looked_into)
        space = HalfSpace(mesh, self._far_field)
        reach = surface_margin(self._stress) * self.largest / self._meshes.least_scale(level)
        count = int(np.searchsorted(space.radii, max(reach, SURFACE_MARGIN * mesh.parameters.fine_to)))
        return space, min(count + 1 - count % 2, len(space.radii))

    def _factorised(self, level: int) -> UnscaledSurface:
        space, count = self._half_space(level)
        root, radii = triangular(space.factorise(self._ratio, count).compliance()[0]), space.radii[:count]
        fine = self._meshes.parameters(level)
        strip = float(fine.fine_from), float(fine.fine_to)
        unit = dtrtrs(root, np.ones(count), lower=1)[0]
        effective = np.cumsum(unit**2) / (2.0 * self._plane_modulus)
        # between the longest and the shortest one of the places that the mesh serves
        zone = float(np.sqrt(self._unit / self._meshes.least_scale(level)))
        # a punch of height r^2 has the transform 2 x^2; elements of 1e-9 of the radius leave within rounding
        depths = dtrtrs(root, radii**2, lower=1)[0] / unit
        positions = np.sort(np.sqrt(np.maximum(0.5 * depths, 0.0)))
        return UnscaledSurface(
            radii=radii,
            root=root,
            unit=unit,
            effective=effective,
            positions=positions,
            closure_scale=closure_scales(root, unit, radii, effective, strip, zone),
            height_stretch=height_stretch(radii, effective, positions, strip),
            strip=strip,
        )
