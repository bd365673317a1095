"""Closure integral and length of the process zone of a state of the surface components (see ``release``)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_solver.following.components import Components
from fem_solver.following.placement import Placement
from fem_solver.process_zone import ZoneShift, zone_of_stress

Array = NDArray[np.float64]


def closure_integral(
    placement: Placement, solid: Components, s: float, penetration: float, v: Array, b: Array
) -> float:
    """Closure integral at the edge.

    Parameters
    ----------
    placement : Placement
    solid : Components
    s : float
        Edge position in nodes.
    penetration : float
    v : ndarray, shape (n,)
        Components.
    b : ndarray, shape (branches, n)
        Their branch variables.

    Returns
    -------
    float
        An energy per area; minus infinity under pressure.
    """
    geometry = placement.geometry
    shift = geometry.shift
    if shift is None:
        raise AssertionError("no closure without adhesion")
    if geometry.stress is not None:
        shift = ZoneShift(geometry.radii, zone_at(placement, solid, s, v, b))
    m = int(np.floor(s))
    top = m + 1
    first, end = shift.nodes(m, top)
    y = solid.force(v[first : top + 1], b[:, first : top + 1])
    # the node in full contact next to the edge tells tension from pressure
    if y[m - first] > 0.0:
        return -np.inf
    gap = placement.displacement_of(v, top, end) + (placement.height[top:end] - penetration)
    lower, upper = placement.closure_scale[m : m + 2]
    work = float(shift.closure(first, placement.forces(y, first), gap))
    return work / float(lower + (s - m) * (upper - lower))


def zone_at(placement: Placement, solid: Components, s: float, v: Array, b: Array) -> float:
    """Length of the process zone; at fixed stress that over which the tension has its mean.

    Parameters
    ----------
    placement, solid, s, v, b
        As of :func:`closure_integral`.

    Returns
    -------
    float
        At fixed stress at most the contact radius; without contact that at rest.
    """
    geometry, end = placement.geometry, int(np.floor(s)) + 2
    if geometry.stress is None or geometry.shortest is None or s < 0.0:
        return geometry.zone or 0.0

    def forces(first: int) -> Array:
        return placement.forces(solid.force(v[first:end], b[:, first:end]), first)

    edge = geometry.radius(s) / placement.stretch  # as the nodes measure it
    length = zone_of_stress(geometry.radii[:end], forces, edge, geometry.stress, geometry.shortest)
    return length if length < edge else geometry.radius(s)
