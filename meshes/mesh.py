"""The mesh object: an axisymmetric half-space cut off far away, in the (r, z) half-plane.

Axes: r >= 0 from the axis of symmetry, z <= 0 downwards into the body; the surface is z = 0.
Triangles are straight and counter-clockwise. Named boundaries: ``surface`` (z = 0), ``axis`` (r = 0) and
``far`` (the rest, whatever its shape).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from meshes.parameters import MeshParameters

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

BOUNDARIES = ("surface", "axis", "far")


@dataclass(frozen=True, eq=False)
class HalfSpaceMesh:
    """Points, triangles, named boundary edges, and the parameters they follow from.

    Parameters
    ----------
    points : (2, n) array
        Coordinates (r, z) of the vertices.
    triangles : (3, m) array of int
        Vertex indices, counter-clockwise.
    boundaries : dict of (2, k) arrays of int
        Vertex index pairs of the edges of ``surface``, ``axis`` and ``far``.
    parameters : MeshParameters

    Raises
    ------
    ValueError
        When shapes, ranges, orientation or boundary names are wrong. Arrays become read-only.
    """

    points: Array
    triangles: Indices
    boundaries: dict[str, Indices]
    parameters: MeshParameters

    def __post_init__(self) -> None:
        points = _read_only(self.points, np.float64, 2, "points")
        triangles = _read_only(self.triangles, np.int64, 3, "triangles")
        if set(self.boundaries) != set(BOUNDARIES):
            raise ValueError(f"boundaries {sorted(self.boundaries)}: must be named {', '.join(BOUNDARIES)}")
        boundaries = {name: _read_only(self.boundaries[name], np.int64, 2, name) for name in BOUNDARIES}
        for name, indices in (("triangles", triangles), *boundaries.items()):
            if indices.size == 0 or indices.min() < 0 or indices.max() >= points.shape[1]:
                raise ValueError(f"{name}: empty, or vertex index out of range")
        if not np.isfinite(points).all() or points[0].min() < 0 or points[1].max() > 0:
            raise ValueError("points: must be finite with r >= 0 and z <= 0")
        if not (areas(points, triangles) > 0).all():
            raise ValueError("triangles: must be counter-clockwise and of positive area")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "triangles", triangles)
        object.__setattr__(self, "boundaries", boundaries)

    @cached_property
    def surface_nodes(self) -> Indices:
        """Indices of the vertices on z = 0, by increasing radius."""
        nodes = np.flatnonzero(self.points[1] == 0.0)
        return nodes[np.argsort(self.points[0, nodes])]


def areas(points: Array, triangles: Indices) -> Array:
    """Signed areas of triangles in the (r, z) plane; positive when counter-clockwise."""
    a, b, c = (points[:, corner] for corner in triangles)
    return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))


def assemble(points: Array, triangles: Indices, parameters: MeshParameters) -> HalfSpaceMesh:
    """The mesh of triangles that stand either way round: they are oriented, vertices without a triangle are
    dropped, and the boundary edges are named."""
    used, flat = np.unique(triangles, return_inverse=True)
    points, triangles = points[:, used], flat.reshape(triangles.shape)
    backwards = areas(points, triangles) < 0
    triangles[1:, backwards] = triangles[:0:-1, backwards]
    edges = boundary_edges(triangles)
    on_surface = (points[1, edges] == 0.0).all(axis=0)
    on_axis = (points[0, edges] == 0.0).all(axis=0)
    named = {
        "surface": edges[:, on_surface],
        "axis": edges[:, on_axis],
        "far": edges[:, ~(on_surface | on_axis)],
    }
    return HalfSpaceMesh(points, triangles, named, parameters)


def boundary_edges(triangles: Indices) -> Indices:
    """Return the edges that belong to one triangle only, with the body on their left."""
    edges = np.concatenate([triangles[[0, 1]], triangles[[1, 2]], triangles[[2, 0]]], axis=1)
    _, first, count = np.unique(np.sort(edges, axis=0), axis=1, return_index=True, return_counts=True)
    return edges[:, first[count == 1]]


def _read_only(values: np.ndarray, kind: type, rows: int, name: str) -> np.ndarray:
    array: np.ndarray = np.array(values, dtype=kind, order="C")
    if array.ndim != 2 or array.shape[0] != rows:
        raise ValueError(f"{name}: has shape {array.shape}, must be ({rows}, n)")
    array.flags.writeable = False
    return array
