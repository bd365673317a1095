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
from fem_solver.fields.point_fields import PointFields, Section
from fem_solver.fields.recovery import Recovery
from fem_solver.following.setup import FollowingSetup

Array = NDArray[np.float64]


class FollowingFields:
    """Fields by back-substitution from the components of the row's surface."""

    def __init__(self, setup: FollowingSetup, log: FollowingLog) -> None:
        self._setup, self._log, self._shear = setup, log, setup.history.solid.modulus
        self._levels: dict[Any, tuple[ElasticBody, Recovery]] = {}
        self.names = tuple(f"tau={time:.6g}" for time in self._shear.times)

    @property
    def volume_solves(self) -> int:
        """Back-substitutions in the body so far."""
        return sum(body.factor.solves for body, _ in self._levels.values())

    @property
    def linear_solves(self) -> int:
        """Projections onto the nodes so far."""
        return sum(recovery.solves for _, recovery in self._levels.values())

    @property
    def factorisations(self) -> int:
        """Of the body and of the projection, at every level."""
        return 2 * len(self._levels)

    def at(self, row: int) -> PointFields:
        """Fields at a row."""
        state = self._log[row]
        placement = self._setup.surfaces.at(state.place)
        branches = np.array([placement.forces(branch) for branch in state.branches])
        body, _ = self._level(state.place)
        fields = body.relaxing(self._shear, placement.forces(state.components), branches, placement.scale)
        return fields if self.names else replace(fields, dissipated=fields.rates)  # no branch, no loss

    def section(self, row: int) -> Section:
        """The mesh of a row."""
        placement = self._setup.surfaces.at(self._log[row].place)
        recovery = self._level(placement.place)[1]
        return Section(recovery, placement.radii, placement.height, placement.scale, placement.stretch)

    def _level(self, place: Any) -> tuple[ElasticBody, Recovery]:
        """The half-space of a place and its projection; a run has few levels, by halves of the radius."""
        if place.level not in self._levels:
            space, count = self._setup.surfaces.half_space(place.level)
            factor = space.factorise(self._setup.surfaces.ratio)
            body = ElasticBody(space, factor, factor.far_weights(count))
            self._levels[place.level] = body, Recovery(space.basis)
        return self._levels[place.level]
