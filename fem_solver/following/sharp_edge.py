"""Where a sharp edge comes to rest: it needs no resolved process zone, so any place of the mesh serves."""

from __future__ import annotations

import numpy as np

from fem_solver.following.problem import FollowingProblem
from fem_solver.following.setup import FollowingSetup


def sharp_rest(
    problem: FollowingProblem, setup: FollowingSetup, radius: float, work: float, outwards: bool = False
) -> float:
    """Where a sharp edge that leaves a radius all at once comes to rest.

    Parameters
    ----------
    problem : FollowingProblem
    setup : FollowingSetup
    radius : float
        Contact radius that it leaves, a length.
    work : float
        Energy per area that it takes up.
    outwards : bool
        Whether it advances.

    Returns
    -------
    float
        Contact radius, a length; 0 if contact is lost. An edge that would outgrow the mesh rests at the
        largest radius the mesh is made for.
    """
    reach = setup.surfaces.reach
    excess = problem.sharp(setup.plane_modulus) - work
    x = problem.placement.positions
    stable = (excess[:-1] < 0.0) & (excess[1:] >= 0.0)
    stable &= (x[:-1] > radius) if outwards else (x[1:] < radius)
    rests = np.flatnonzero(stable)
    if not rests.size:
        return reach if outwards else 0.0
    at = rests[0] if outwards else rests[-1]
    share = excess[at] / (excess[at] - excess[at + 1])
    return float(min(x[at] + share * (x[at + 1] - x[at]), reach))
