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
    chain, history = problem.chain, state.history
    height = problem.scene.indenter.height(radius)
    inside = (radius <= state.edge) & (state.edge > 0.0)
    displacement = state.penetration - height
    if inside.all():
        variables = history.inner.at(radius)
        return SurfacePoints(
            radius, height, variables, load_inside(chain, variables, displacement), displacement
        )
    load = np.empty(len(radius))
    variables = np.empty((len(radius), len(chain)))
    variables[inside] = history.inner.at(radius[inside])
    load[inside] = load_inside(chain, variables[inside], displacement[inside])
    outside = ~inside
    load[outside] = state.surface.outside(radius[outside])
    variables[outside] = chain.from_strains(history.outer.at(radius[outside]), load[outside])
    displacement[outside] = displacement_outside(chain, variables[outside], load[outside])
    return SurfacePoints(radius, height, variables, load, displacement)
