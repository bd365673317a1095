"""Surface profiles at requested times."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact_scene import SurfaceProfile
from fem_solver.recorder import SurfaceState

Array = NDArray[np.float64]


def tributary_areas(radii: Array) -> Array:
    """``int N_i 2 pi r dr`` of the quadratic trace; zero at the axis. Shape (n,), n odd."""
    left, right = radii[:-2:2], radii[2::2]
    length = right - left
    areas = np.zeros(len(radii))
    areas[:-2:2] += 2.0 * np.pi * length * left / 6.0
    areas[2::2] += 2.0 * np.pi * length * right / 6.0
    areas[1::2] += 2.0 * np.pi * length * (left + right) / 3.0
    return areas


def profile(state: SurfaceState, radii: Array, height: Array, stretch: float = 1.0) -> SurfaceProfile:
    """Pressure, displacement and gap at the surface nodes.

    The pressure is the nodal force over the node's area; the axis takes that of its neighbour, and the
    partly released node at the edge is left out.

    Parameters
    ----------
    state : SurfaceState
    radii : ndarray, shape (n,)
        Of the surface nodes, vertices and mid-side nodes in turn, from the axis.
    height : ndarray, shape (n,)
        Indenter profile at the nodes.
    stretch : float
        Contact radius over the radius of the node there: the surface is given in lengths of the former.

    Returns
    -------
    SurfaceProfile
    """
    areas = tributary_areas(radii)
    pressure = np.divide(state.forces, areas, out=np.zeros_like(areas), where=areas > 0.0)
    pressure[0] = pressure[1]
    full = int(np.floor(state.edge))
    gap = height - state.penetration + state.displacement
    gap[: full + 1] = 0.0
    shown = np.ones(len(radii), bool)
    if full + 1 < len(radii) and state.edge > full:
        shown[full + 1] = False
    return SurfaceProfile(
        state.time,
        state.penetration,
        state.force,
        state.radius,
        stretch * radii[shown],
        pressure[shown],
        state.displacement[shown],
        gap[shown],
    )
