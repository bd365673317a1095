"""Where a sharp edge comes to rest: it needs no resolved process zone, so any place of the mesh serves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_solver.following.problem import FollowingProblem
from fem_solver.following.setup import FollowingSetup

Array = NDArray[np.float64]


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
    x = problem.placement.positions
    excess = sharp_release_rates(problem, setup.plane_modulus) - work
    excess[x > setup.surfaces.rim] = np.inf
    stable = (excess[:-1] < 0.0) & (excess[1:] >= 0.0)
    stable &= (x[:-1] > radius) if outwards else (x[1:] < radius)
    rests = np.flatnonzero(stable)
    if not rests.size:
        return reach if outwards else 0.0
    at = rests[0] if outwards else rests[-1]
    if x[at + 1] > setup.surfaces.rim:
        return setup.surfaces.rim
    share = excess[at] / (excess[at] - excess[at + 1])
    return float(min(x[at] + share * (x[at + 1] - x[at]), reach))


def sharp_release_rates(problem: FollowingProblem, plane_modulus: float) -> Array:
    """Energy release rate of a sharp edge at every component, if all happens at once; shape (n,).

    It needs no process zone to be resolved: ``E* q^2/(2 pi x)``, with ``q`` the flat punch that leaves the
    same singularity there; zero where the edge would be under pressure. ``plane_modulus`` is ``E*`` at unit
    shear modulus.
    """
    here, state = problem.placement, problem.state
    free = problem.solid.relieved(state.components, state.branches, problem.dt)
    if problem.control == "penetration":
        penetration = np.full(len(here.unit), problem.value)
    elif problem.control == "stage":
        softness = problem.compliance
        penetration = (problem.value - softness * problem.held_force) / (1.0 + softness * problem.stiffness)
    else:
        penetration = (problem.value - problem.held_force) / problem.stiffness
    q = penetration - (here.profile + free) / here.unit
    twice = problem.modulus * plane_modulus * np.minimum(q, 0.0) ** 2 / np.pi
    x = here.positions
    return 0.5 * np.divide(twice, x, out=np.zeros_like(x), where=x > 0.0)
