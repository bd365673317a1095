"""A layer of unit thickness: a rectangle below the surface, uniform where rings load it and wider beyond."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshes.mesh import Array, Indices
from meshes.surface import graded

ROWS = 6
"""Elements across the layer. Energies of cubic ones err by the sixth power of their size, with 6 by 1e-6."""
BEYOND = 8.0
"""Distance from the last ring to the rim: what the rim does wrong falls as exp(-1.8 r), to 5e-7 over it."""
_GRADING = 0.1
"""Growth of the columns beyond the rings with the distance from them."""
_SPARE = 4
"""Columns of the uniform part beyond the radius that is asked for, and twice that at least."""


@dataclass(frozen=True, eq=False)
class LayerMesh:
    """Vertices (2, n) in the (r, z) half-plane, counter-clockwise triangles (3, m), columns near the axis."""

    points: Array
    triangles: Indices
    uniform: Array


def layer(reach: float) -> LayerMesh:
    """Mesh a layer of unit thickness that is loaded up to a radius; ``uniform`` are the columns to there."""
    count = max(math.ceil(reach * ROWS), _SPARE) + _SPARE
    uniform = np.arange(count + 1) / ROWS
    columns = np.append(uniform, graded(uniform[-1], uniform[-1] + BEYOND, 1.0 / ROWS, _GRADING)[1:])
    return LayerMesh(*grid(columns, np.arange(-ROWS, 1) / ROWS), uniform)


def grid(columns: Array, rows: Array) -> tuple[Array, Indices]:
    """Points (2, n) and counter-clockwise triangles (3, m) of rising radii times rising heights."""
    r, z = (part.ravel() for part in np.meshgrid(columns, rows, indexing="ij"))
    corner = np.arange(r.size).reshape(columns.size, rows.size)
    near, above, far, across = (
        part.ravel() for part in (corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:])
    )
    return np.stack([r, z]), np.hstack([np.stack([near, far, above]), np.stack([across, above, far])])
