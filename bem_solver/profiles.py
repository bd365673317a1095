"""State of the surface at one time (paper, Fig. 3): pressure, displacement, gap."""

from __future__ import annotations

import numpy as np

from bem_solver.trial import Front, Problem, points_at
from contact_scene import SurfaceProfile

_REACH = 4.0  # contact radii


def surface_profile(problem: Problem, front: Front) -> SurfaceProfile:
    """Profile of the committed state, on the annuli inside the contact and graded radii beyond."""
    edge = front.edge
    if edge > 0.0:
        inside = edge * problem.annuli.radii
        near = 2.0 * edge - inside[::-1]
        radius = np.concatenate(
            ([0.0], inside, near[near < 2.0 * edge], edge * np.linspace(2.0, _REACH, 101))
        )
    else:
        # without any length to go by, the centre alone
        radius = np.unique(problem.length * np.linspace(0.0, 100.0 * _REACH, 401))
    points = points_at(problem, front, radius)
    pressure = front.surface.pressure(radius)
    gap = points.height - front.penetration + points.displacement
    if edge > 0.0:
        gap[radius <= edge] = 0.0
    return SurfaceProfile(
        front.time,
        front.penetration,
        front.surface.force,
        edge,
        radius,
        pressure,
        points.displacement,
        gap,
    )
