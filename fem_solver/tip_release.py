"""Glassy energy release rate ``K^2/(2 Einf*)`` of the very tip, from forces and gaps of nodes beside it.

At a fixed instant the half-space is elastic with its glassy modulus ``G``. With ``C = L L^T``, ``y = L^T
f/G`` and ``e = L^-1 1`` (see ``surface``), ``y_i/e_i`` is the depth of the flat punch that would leave at
node i the singularity that an edge there would have; such a punch of radius x sets free ``Einf* depth^2/(2 pi
x)`` per area. The depths of a few nodes beside the edge are carried on to it by a straight line.

A receding edge leaves the last nodes in contact the stress that belongs to the tip. Behind an advancing one
the stress falls within a layer that may be thinner than an element; the opening ahead of it does not, and the
depths of the nodes that come next, were they closed at once, follow from their gaps.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.surface import SurfaceOperator

Array = NDArray[np.float64]

_NODES = 4
"""Nodes of the straight line: two vertices and two mid-side nodes, over which their ripple cancels."""
SLOW_EDGE = 1.0
"""Elements that the edge passes within the shortest relaxation time, up to which it counts as slow: a node is
then let go so slowly that this branch relaxes meanwhile."""

UNKNOWN_RELEASE = (math.nan, math.nan)
"""Of opening and of closing, where the tip is not known."""


def release_of_opening(
    operator: SurfaceOperator, geometry: EdgeGeometry, modulus: float, forces: Array, edge: float
) -> float:
    """Energy per area that the tip sets free as it opens.

    Parameters
    ----------
    operator : SurfaceOperator
    geometry : EdgeGeometry
    modulus : float
        Glassy shear modulus.
    forces : ndarray, shape (n,)
        Nodal forces, compressive positive.
    edge : float
        Edge position in nodes.

    Returns
    -------
    float
        NaN where there are too few nodes on that side.
    """
    last = math.floor(edge)
    first = last + 1 - _NODES
    if first < 1 or last >= geometry.last:
        return math.nan
    factor = operator.factor(first, last + 2)
    transformed = factor.T @ forces[first : last + 2] / modulus
    return _at_edge(operator, geometry, modulus, first, transformed[:_NODES], edge)


def release_of_closing(
    operator: SurfaceOperator, geometry: EdgeGeometry, modulus: float, forces: Array, gap: Array, edge: float
) -> float:
    """Energy per area that the tip takes up as it closes.

    Parameters
    ----------
    operator, geometry, modulus, forces, edge
        As of :func:`release_of_opening`.
    gap : ndarray, shape (n,)
        Opening between surface and indenter at the nodes.

    Returns
    -------
    float
        NaN where there are too few nodes on that side.
    """
    first = math.floor(edge) + 2  # the next node is in contact in part, and has relaxed as such
    if first < 1 or first + _NODES > geometry.last:
        return math.nan
    nodes = slice(first - 1, first + _NODES)
    factor = operator.factor(nodes.start, nodes.stop)
    transformed = factor.T @ forces[nodes] / modulus - np.linalg.solve(factor, gap[nodes])
    return _at_edge(operator, geometry, modulus, first, transformed[1:], edge)


def _at_edge(
    operator: SurfaceOperator,
    geometry: EdgeGeometry,
    modulus: float,
    first: int,
    transformed: Array,
    edge: float,
) -> float:
    """Release rate at the edge, from the ``y`` of the nodes from the ``first`` on."""
    depths = transformed / operator.unit[first : first + _NODES]
    ends = geometry.effective[first - 1 : first + _NODES]
    radius = geometry.radius(edge)
    _, depth = np.polyfit(0.5 * (ends[1:] + ends[:-1]) - radius, depths, 1)
    plane = modulus * operator.stiffness[0] / (2.0 * geometry.effective[0])
    return float(plane * depth**2 / (2.0 * math.pi * radius))
