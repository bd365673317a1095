"""History of the surface on a mesh that follows the edge; the counterpart of ``condensed``."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_solver.following.components import Components
from fem_solver.following.placement import Placement, Surfaces
from fem_solver.following.problem import FollowingProblem
from fem_solver.following.state import FollowingState, interface_energy, transferred, undeformed

Array = NDArray[np.float64]


class FollowingHistory:
    """The accepted state, and what a run asks of it.

    Parameters
    ----------
    surfaces : Surfaces
    solid : Components
    """

    def __init__(self, surfaces: Surfaces, solid: Components) -> None:
        self.surfaces, self.solid = surfaces, solid
        start = surfaces.around(surfaces.largest)
        self.state = undeformed(start, len(solid.modulus.times))
        self.volume_solves = 0
        self._moved: tuple[FollowingState, FollowingState] | None = None

    @property
    def factorisations(self) -> int:
        """Meshes factorised so far."""
        return self.surfaces.factorisations

    @property
    def placement(self) -> Placement:
        """The surface at the place of the accepted state."""
        return self.surfaces.at(self.state.place)

    def at(self, placement: Placement) -> FollowingState:
        """The accepted state with the mesh at another place."""
        if self._moved is None or self._moved[0] is not self.state or self._moved[1].place != placement.place:
            moved = transferred(self.state, self.placement, placement, self.solid)
            self._moved = self.state, moved
        return self._moved[1]

    def accept(self, problem: FollowingProblem, s: float) -> None:
        """Accept a step that ends with the edge at ``s``."""
        self.state = problem.accepted(s)

    @property
    def displacement(self) -> Array:
        """Surface displacement, downwards; shape (n,)."""
        return self.placement.displacement(self.state.components)

    @property
    def stored_energy(self) -> float:
        """Energy of the springs."""
        state = self.state
        held = float(np.sum(self.solid.stored(state.components, state.branches)))
        finer = float(np.sum(state.unresolved) + np.sum(state.uneven))
        return held + finer + state.borders.stored(self.solid)

    def interface_energy(self, forces: Array, gap: Array) -> float:
        """Energy of the partly released node beyond that of its mean; forces and gaps do not tell it."""
        return interface_energy(self.state, self.placement, self.solid)

    def take_back(self, state: FollowingState) -> None:
        """Return to the state before the last step."""
        self.state = state
