"""State of the surface at one time (paper, Fig. 3): pressure, displacement, gap."""

from __future__ import annotations

import numpy as np

from bem_solver.half_space_state import HalfSpaceState, points_at
from bem_solver.problem import Problem
from contact_scene import SurfaceProfile

_OUTER_RADIUS = 4.0
"""Largest radius of a profile, in contact radii."""


def surface_profile(problem: Problem, state: HalfSpaceState) -> SurfaceProfile:
    """Profile of the committed state, on the annuli inside the contact and graded radii beyond."""
    edge = state.edge
    if edge > 0.0:
        inside = edge * problem.annuli.radii
        near = 2.0 * edge - inside[::-1]
        radius = np.concatenate(
            ([0.0], inside, near[near < 2.0 * edge], edge * np.linspace(2.0, _OUTER_RADIUS, 101))
        )
    else:
        # there is no contact radius to scale with
        radius = np.unique(problem.length * np.linspace(0.0, 100.0 * _OUTER_RADIUS, 401))
    points = points_at(problem, state, radius)
    pressure = state.surface.pressure(radius)
    gap = points.height - state.penetration + points.displacement
    if edge > 0.0:
        gap[radius <= edge] = 0.0
    return SurfaceProfile(
        state.time,
        state.penetration,
        state.surface.force,
        edge,
        radius,
        pressure,
        points.displacement,
        gap,
    )
