"""The committed state of the half-space, and what it is at surface points at the start of a step.

Penetration and surface displacement positive downwards, force and pressure positive in compression; radii
from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.edge_energy import EdgeStep
from bem_solver.history import SurfaceHistory
from bem_solver.motion import SurfacePoints
from bem_solver.problem import Problem
from bem_solver.surface import ContactSurface
from bem_solver.surface_points import displacement_outside, load_inside

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HalfSpaceState:
    """Committed state: the surface, its history, time and penetration.

    ``closure`` is the integral of the edge, ``spent`` what the interface has taken up, ``last_step`` the step
    of the edge that led here, ``None`` after a kink: known where adhesion is irreversible.
    """

    time: float
    penetration: float
    surface: ContactSurface
    history: SurfaceHistory
    closure: float = 0.0
    spent: float = 0.0
    last_step: EdgeStep | None = None

    @property
    def edge(self) -> float:
        """Contact radius."""
        return self.surface.edge


def points_at(problem: Problem, state: HalfSpaceState, radius: Array) -> SurfacePoints:
    """State of surface points at the start of a step."""
    height = problem.scene.indenter.height(radius)
    inside = radius <= state.edge if state.edge > 0.0 else np.zeros(len(radius), bool)
    if inside.all():
        return SurfacePoints(radius, height, *_inside(problem, state, radius, height))
    if not inside.any():
        return SurfacePoints(radius, height, *_outside(problem, state, radius))
    variables = np.empty((len(radius), len(problem.chain)))
    load, displacement, outside = np.empty(len(radius)), np.empty(len(radius)), ~inside
    variables[inside], load[inside], displacement[inside] = _inside(
        problem, state, radius[inside], height[inside]
    )
    variables[outside], load[outside], displacement[outside] = _outside(problem, state, radius[outside])
    return SurfacePoints(radius, height, variables, load, displacement)


def _inside(
    problem: Problem, state: HalfSpaceState, radius: Array, height: Array
) -> tuple[Array, Array, Array]:
    """Variables, load and displacement of points in contact."""
    displacement = state.penetration - height
    variables = state.history.inner.at(radius)
    return variables, load_inside(problem.chain, variables, displacement), displacement


def _outside(problem: Problem, state: HalfSpaceState, radius: Array) -> tuple[Array, Array, Array]:
    """Variables, load and displacement of points outside the contact."""
    chain, load = problem.chain, state.surface.outside(radius)
    variables = chain.from_strains(state.history.outside(radius), load)
    return variables, load, displacement_outside(chain, variables, load)
