"""Grading towards one surface vertex, such as the edge of a flat punch where the stress is singular."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from meshes.mesh import Array, Indices
from meshes.parameters import MeshParameters


def refine_edge(points: Array, triangles: Indices, parameters: MeshParameters) -> tuple[Array, Indices]:
    """Replace the triangles around the extra-fine radius by layers that halve towards it.

    Every triangle with a corner at the vertex ``v`` is cut along copies of its opposite side, shrunk towards
    ``v`` by 1/2, 1/4, ...; the shapes stay those of the triangles around ``v``, and no other vertex moves.
    Without such a radius nothing changes.
    """
    if parameters.extra_fine_radius is None or parameters.extra_fine_size is None:
        return points, triangles
    halvings = math.ceil(math.log2(parameters.fine_size / parameters.extra_fine_size) - 1e-9)
    if halvings == 0:
        return points, triangles
    tip = int(np.argmin(np.hypot(points[0] - parameters.extra_fine_radius, points[1])))
    corner, column = np.nonzero(triangles == tip)
    outer = np.stack([triangles[(corner + 1) % 3, column], triangles[(corner + 2) % 3, column]])
    spokes, outer = np.unique(outer, return_inverse=True)
    outer = outer.reshape(2, -1)
    shrink = 0.5 ** np.arange(1, halvings + 1)
    copies = points[:, tip, None, None] + shrink[:, None] * (points[:, spokes] - points[:, [tip]])[:, None, :]
    added = points.shape[1] + np.arange(halvings * spokes.size).reshape(halvings, spokes.size)
    ring = np.concatenate([spokes[None], added])  # vertex of layer k on each spoke
    layers = [np.stack([np.full(outer.shape[1], tip), *ring[-1][outer]])]
    for far, near in pairwise(ring):
        layers.append(np.stack([far[outer[0]], far[outer[1]], near[outer[1]]]))
        layers.append(np.stack([far[outer[0]], near[outer[1]], near[outer[0]]]))
    others = np.delete(triangles, column, axis=1)
    return np.concatenate([points, copies.reshape(2, -1)], axis=1), np.concatenate([others, *layers], axis=1)
