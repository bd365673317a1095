"""Meshes whose fine strip is narrow and placed around the contact edge, wherever that is.

A half-space has no length of its own, so one mesh, scaled, serves every radius between half of that it is
made for and that radius itself. The meshes are made in units of the process zone, at radii that double from
one level to the next; the innermost one is fine from the axis on and is not scaled. Their number grows with
the logarithm of the contact radius over the process zone, their size hardly at all.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from meshes.halfspace import cached, half_space
from meshes.layer import LayerMesh, layer
from meshes.mesh import HalfSpaceMesh
from meshes.parameters import DOMAIN_RATIO, MeshParameters
from meshes.structured import structured_layer

INNER_RADIUS = 24.0
"""Contact radius, in process zones, up to which the innermost mesh serves."""
STRIP, LOOKED_INTO = 8.0, 12.0
"""Half the length of the fine strip, in process zones, of a mesh that is not scaled: of one that tells
the surface alone, and of one that is asked for stresses, as elements beside the strip are wide for these."""
_STRIDE = 4.0
"""Distance between neighbouring places of a mesh that is not scaled, in process zones: half of ``STRIP``, so
that the edge has at least three quarters of the strip's half before it and behind it."""
_GMSH_RESOLVES = 5e-9
"""Least element, over the contact radius, that gmsh places rightly: its own tolerances are some 1e-8 of the
geometry. Below 1e-9 it leaves most of the elements out around the strip; the structured family does not."""
_SPARE = 1.2
"""Radius to which the innermost mesh is fine, but for a zone, over the largest of the contact: as far as an
edge may come."""
_COVERED = 8.0
"""Radius of the domain, at least, over the largest contact radius of the run."""


@dataclass(frozen=True)
class Place:
    """Where a mesh is placed: its level and the number of steps by which it is scaled down."""

    level: int
    step: int


@dataclass
class EdgeMeshes:
    """Meshes for the places that a contact edge may come to, in a run of a ``largest`` contact radius.

    ``divisions`` are elements per process zone, at least; ``grading`` is the growth of their size with the
    distance from the strip, ``domain_ratio`` the radius of the domain over that of the strip.
    """

    zone: float
    divisions: int
    largest: float
    grading: float = 0.2
    domain_ratio: float | None = None
    in_cache: bool = True

    def place(self, radius: float) -> Place:
        """The place nearest to a contact radius."""
        zones = radius / self.zone
        if zones <= INNER_RADIUS * (1.0 + 1e-9):  # without adhesion as far as the edge may come, rounded
            return Place(0, 0)
        level = max(1, math.ceil(math.log2(zones / INNER_RADIUS)))
        return Place(level, round(self._steps(level) * math.log2(self.centre(level) / zones)))

    def centre(self, level: int) -> float:
        """Radius, in process zones, for which the mesh of a level is made."""
        return INNER_RADIUS * 2.0**level

    def scale(self, place: Place) -> float:
        """Length that one unit of the mesh stands for."""
        return self.zone * 2.0 ** (-place.step / self._steps(place.level)) if place.level else self.zone

    def least_scale(self, level: int) -> float:
        """The least of these lengths at the places of a level."""
        return 0.5 * self.zone if level else self.zone

    def among_fewer(self, place: Place) -> Place:
        """The nearest of every third place: where one looks into the body its strip, too, holds what a place
        serves, a mesh that stays while its edge goes on included."""
        return Place(place.level, 3 * round(place.step / 3))

    def _steps(self, level: int) -> int:
        """Places per halving of the radius."""
        return math.ceil(math.log(2.0) * self.centre(level) / _STRIDE)

    def parameters(self, level: int, looked_into: bool = False) -> MeshParameters:
        """Parameters of the mesh of a level, in process zones.

        A structured one gives all edges in the strip the same error, to a thousandth of what gmsh's do, and
        takes a tenth of the time; gmsh's triangles are even where one looks into the body.
        """
        centre = self.centre(level)
        half = LOOKED_INTO if looked_into else STRIP
        fine_from, fine_to = centre - half, centre + half
        if level == 0:
            needed = 2.0 * math.ceil(0.5 * (_SPARE * self.largest / self.zone + 1.0))
            fine_from, fine_to = 0.0, min(centre + 0.5 * half, needed)
        ratio = self.domain_ratio or DOMAIN_RATIO
        # no other length of the scene enters, so that the meshes of one scene serve the next
        covered = 2.0 ** math.ceil(math.log2(max(_COVERED * self.largest / self.zone, 1.0)))
        domain = max(ratio * centre, covered)
        size = 1.0 / self.divisions
        family = "gmsh" if looked_into and size > _GMSH_RESOLVES * centre else "structured"
        return MeshParameters(size, fine_from, fine_to, domain, self.grading, family)

    def mesh(self, level: int, looked_into: bool = False) -> HalfSpaceMesh:
        """The mesh of a level, in process zones."""
        asked = self.parameters(level, looked_into)
        return cached(asked) if self.in_cache else half_space(asked)

    def layer(self, reach: float) -> LayerMesh:
        """The mesh of a layer of unit thickness that is loaded up to a radius."""
        return layer(reach)

    def layer_below(self, level: int, thickness: float) -> HalfSpaceMesh:
        """A layer of a thickness, in process zones, below the surface of a mesh to look into."""
        return structured_layer(self.parameters(level, looked_into=True), thickness)
