"""Fields of a run whose mesh follows the contact edge, each row on the mesh where that row has it.

They need the row's own state alone, the loads ``w = L^-T v`` and ``b_k = L^-T b_k`` of its surface components
(see ``following.components``). What the surface holds within an element is in no density. The energy
dissipated so far is not known: it lies along the path of the edge in a layer as thin as what dissipates
there, and the mesh of a row is fine around the edge of that row alone.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem_solver.fields.elastic_body import ElasticBody
from fem_solver.fields.following_log import FollowingLog
from fem_solver.fields.point_fields import PointFields, RowMesh, branch_names
from fem_solver.fields.recovery import Recovery
from fem_solver.fields.separate_body import SeparateBody
from fem_solver.following.setup import FollowingSetup

Array = NDArray[np.float64]


class FollowingFields:
    """Fields by back-substitution from the components of the row's surface."""

    def __init__(self, setup: FollowingSetup, log: FollowingLog) -> None:
        self._setup, self._log, self._material = setup, log, setup.material
        self._levels: dict[Any, tuple[ElasticBody | SeparateBody, Recovery]] = {}
        self._apart = self._material.series is not None
        shear, bulk = self._material.shear, self._material.bulk
        self.names = branch_names(shear)
        if self._apart and bulk is not None:
            self.names = branch_names(shear, "shear") + branch_names(bulk, "bulk")

    @property
    def volume_solves(self) -> int:
        """Back-substitutions in the body so far."""
        return sum(body.solves for body, _ in self._levels.values())

    @property
    def linear_solves(self) -> int:
        """Projections onto the nodes so far."""
        return sum(recovery.solves for _, recovery in self._levels.values())

    @property
    def factorisations(self) -> int:
        """Of the body and of the projection, at every level."""
        return (3 if self._apart else 2) * len(self._levels)

    def at(self, row: int) -> PointFields:
        """Fields at a row."""
        state = self._log[row]
        placement = self._setup.surfaces.at(state.place)
        body, _ = self._level(state.place)
        if isinstance(body, SeparateBody):
            return body.relaxing(state.components, state.branches, placement.forces, placement.scale)
        branches = np.array([placement.forces(branch) for branch in state.branches])
        image, shear = placement.forces(state.components), self._material.shear
        fields = body.relaxing(shear, image, branches, placement.scale)
        return fields if self.names else replace(fields, dissipated=fields.rates)  # no branch, no loss

    def mesh(self, row: int) -> RowMesh:
        """The mesh of a row."""
        placement = self._setup.surfaces.at(self._log[row].place)
        recovery = self._level(placement.place)[1]
        return RowMesh(recovery, placement.radii, placement.height, placement.scale, placement.stretch)

    def _level(self, place: Any) -> tuple[ElasticBody | SeparateBody, Recovery]:
        """The half-space of a place and its projection; a run has few levels, by halves of the radius."""
        if place.level not in self._levels:
            space, count = self._setup.surfaces.half_space(place.level)

            def elastic(ratio: float) -> ElasticBody:
                factor = space.factorise(ratio, count)
                return ElasticBody(space, factor, factor.far_weights())

            body = elastic(self._setup.surfaces.ratio)
            whole = SeparateBody(elastic(0.0), body, self._material) if self._apart else body
            self._levels[place.level] = whole, Recovery(space.basis)
        return self._levels[place.level]
