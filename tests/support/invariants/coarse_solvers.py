"""The three solvers behind one call, coarse and cheap, each with the errors it admits itself.

``declared`` is what a run promises of one step: it bounds what may go wrong within one run (a dissipation
that falls, a balance that does not close). What is compared between two runs is allowed the difference that a
second, coarser run shows, extrapolated by the order of the method with the safety factor customary for two
grids. Nothing here is a number chosen to fit.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

import bem_solver
import fem_solver
import meshes
from contact_scene import Scene, Trace
from validation.reference import path as reference
from validation.solvers.contact_range import largest_contact_radius

SAFETY = 3.0
BUDGET = 20_000
FEM_TOLERANCE = 4e-3


@dataclass(frozen=True)
class CoarseSolver:
    """A solver at its coarsest that still means something; ``order`` that of its convergence."""

    name: str
    resolution: int
    order: int

    def solve(
        self, scene: Scene, times: tuple[float, ...] = (), budget: int = BUDGET, finer: int = 1
    ) -> Trace:
        """Run a scene, ``finer`` times as fine as usual; no question is answered twice."""
        return _answer(self.name, self.resolution * finer, finer, scene, times, budget)

    def declared(self, scene: Scene) -> float:
        """Relative accuracy that a step is held to."""
        if self.name == "bem":
            return bem_solver.Options(self.resolution).step_tolerance
        if self.name == "fem":
            return FEM_TOLERANCE
        return reference.Options(self.resolution).step_tolerance

    def end(self, scene: Scene) -> dict[str, tuple[float, float]]:
        """Force and radius of the last row, each with its error: from two runs, and what one step may do."""
        fine, coarse = self.solve(scene, finer=2), self.solve(scene)
        found = {}
        for name in ("force", "contact_radius"):
            one, two = fine.columns()[name], coarse.columns()[name]
            apart = SAFETY * abs(one[-1] - two[-1]) / (2.0**self.order - 1.0)
            found[name] = float(one[-1]), float(apart + self.declared(scene) * np.abs(one).max())
        return found


@lru_cache(maxsize=256)
def _answer(
    name: str, divisions: int, finer: int, scene: Scene, times: tuple[float, ...], budget: int
) -> Trace:
    asked = {"profile_times": times, "max_steps": budget}
    if name == "bem":
        return bem_solver.solve(scene, bem_solver.Options(divisions, **asked))
    if name == "reference":
        return reference.solve(scene, reference.Options(divisions, **asked))
    options = fem_solver.Options(FEM_TOLERANCE / finer**2, **asked)
    return fem_solver.solve(scene, _mesh(scene, divisions, finer), options)


def _mesh(scene: Scene, divisions: int, finer: int) -> meshes.EdgeMeshes:
    """Places that grade fast; without adhesion a fortieth of the largest contact takes the zone's place.

    The largest contact is rounded up to ten binary digits, so that it scales exactly with powers of two.
    """
    mantissa, exponent = math.frexp(largest_contact_radius(scene))
    largest = math.ldexp(math.ceil(mantissa * 1024.0) / 1024.0, exponent)
    if scene.adhesion is None or not scene.is_adhesive:
        return meshes.EdgeMeshes(0.05 * largest, 2 * divisions, largest, 0.4 / finer)
    return meshes.EdgeMeshes(scene.adhesion.zone, divisions, largest, 0.4 / finer)


SOLVERS: Mapping[str, CoarseSolver] = {
    solver.name: solver
    for solver in (CoarseSolver("bem", 5, 1), CoarseSolver("reference", 5, 2), CoarseSolver("fem", 2, 2))
}
