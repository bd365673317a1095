"""The triangles of a section through the axis: areas, and the nodes of the surface."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from fem_solver import FieldState


def triangle_areas(state: FieldState) -> NDArray[np.float64]:
    """Undeformed area of each triangle of the section; shape (4 m,)."""
    return np.abs(signed_areas(state.points, state.triangles))


def signed_areas(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Areas (t,) of triangles (t, 3) between points (n, 2); the sign changes where one is folded over."""
    corners = points[triangles]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])


def surface_nodes(state: FieldState) -> NDArray[np.int64]:
    """Nodes of the surface from the axis outwards."""
    nodes = np.flatnonzero(state.points[:, 1] == 0.0)
    return nodes[np.argsort(state.points[nodes, 0])]
