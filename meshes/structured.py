"""Structured meshes of half-space and layer: rows of vertices at growing distances from the fine strip.

Row j runs at the distance d_j from the strip: down from the surface (once it is deeper, from the axis), along
below the strip, and up again to the surface on a quarter circle about the end of the strip. Towards the axis
the row turns a square corner, so that the row at ``d = fine_from`` lies on the axis. It is a tensor grid,
distance by position along the row, whose rows get fewer vertices as they get thicker; neighbouring rows are
joined by triangles. It needs nothing but numpy. Below the strip a row has every 2^k-th of its vertices: edges
that are as many elements apart have the same mesh around them, and the same error.

In a layer the rows end with the one that reaches the base, and turn a square corner beyond the strip as well.
What is left of the rectangle, towards the axis and beyond, is a grid below the other vertices of the surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshes.layer import grid
from meshes.mesh import Array, HalfSpaceMesh, Indices, assemble
from meshes.parameters import MeshParameters
from meshes.surface import Layers, layers, surface_radii

SPACING = 0.75**0.5
"""Vertex distance along a row over the row's thickness: triangles have the area of equilateral ones."""


@dataclass(frozen=True)
class _Row:
    """Vertices (2, k) of one row from left to right, numbered from ``first``; its distance from the strip.

    The vertices before ``corner`` are on the way down from the surface.
    """

    points: Array
    first: int
    corner: int
    distance: float


def structured_half_space(parameters: MeshParameters) -> HalfSpaceMesh:
    """Mesh the half-space with rows of triangles around the fine strip.

    The far boundary is a quarter circle about the end of the strip and a flat part below the strip; it meets
    the surface at ``domain_radius``.
    """
    plan = layers(parameters)
    rows = _rows(plan, parameters)
    rows[-1].points[0, -1] = parameters.domain_radius
    points = np.concatenate([row.points for row in rows], axis=1)
    return assemble(points, _triangles(plan, rows), replace(parameters, family="structured"))


def structured_layer(parameters: MeshParameters, thickness: float) -> HalfSpaceMesh:
    """Mesh a layer with the surface vertices of the half-space; ``far`` is its base, and its rim.

    The row nearest to the base is moved onto it, with less and less of those above; a layer deeper than the
    domain has more rows, and is as much wider.
    """
    plan, offsets = layers(parameters), layers(parameters).offsets
    while offsets[-1] < thickness:
        offsets = np.append(offsets, offsets[-1] + parameters.size_at(offsets[-1]))
    depth = offsets[np.abs(offsets - thickness).argmin()]
    plan = replace(plan, offsets=offsets[offsets <= depth])
    rows, stop = _rows(plan, parameters), plan.strip[-1]
    for r, z in (row.points for row in rows):  # a square corner for the quarter circle
        beyond = np.maximum(r - stop, 0.0)
        angle = np.arctan2(beyond, -z)
        square = 1.0 / np.maximum(np.sin(angle), np.cos(angle))
        r += (square - 1.0) * beyond
        z *= square
    (r, z), left = rows[-1].points, rows[-1].corner
    right = int(np.hypot(r - stop - depth, z + depth).argmin())
    r[right:], z[left : right + 1] = stop + depth, -depth
    surface = surface_radii(parameters)
    inside, outside = surface[surface < r[0]], surface[surface > r[-1] * (1.0 + 1e-9)]
    parts = [(np.concatenate([row.points for row in rows], axis=1), _triangles(plan, rows))]
    for columns, heights in ((np.append(inside, r[0]), z[left::-1]), (np.append(r[-1], outside), z[right:])):
        points, triangles = grid(columns, heights)
        parts.append((points, triangles + sum(part[0].shape[1] for part in parts)))
    points, same = np.unique(np.hstack([part[0] for part in parts]), axis=1, return_inverse=True)
    points[1] *= 1.0 + (thickness / depth - 1.0) * (points[1] / depth) ** 2
    triangles = same[np.hstack([part[1] for part in parts])]
    return assemble(points, triangles, replace(parameters, family="structured"))


def _rows(plan: Layers, parameters: MeshParameters) -> list[_Row]:
    rows: list[_Row] = []
    for level in range(plan.offsets.size):
        first = rows[-1].first + rows[-1].points.shape[1] if rows else 0
        rows.append(_row(plan, parameters, level, first))
    return rows


def _triangles(plan: Layers, rows: list[_Row]) -> Indices:
    cells = [_join(plan, *pair, below_axis=k >= plan.axis) for k, pair in enumerate(pairwise(rows))]
    return np.concatenate(cells, axis=1)


def _row(plan: Layers, parameters: MeshParameters, level: int, first: int) -> _Row:
    start, stop, d = plan.strip[0], plan.strip[-1], plan.offsets[level]
    if level == 0:
        return _Row(np.stack([plan.strip, np.zeros_like(plan.strip)]), first, 0, 0.0)
    size = parameters.size_at(d)
    if stop > 1.5 * size:  # down, along, along below the strip, round
        left, leg, pieces = max(start - d, 0.0), 0, []
        if level <= plan.axis:
            leg = _division(d, size)
            pieces.append(_straight((left, 0.0), (left, -d), leg))
        below = stop - start > size  # else it is too short for elements of its own
        end = start if below else stop
        if end > left:
            pieces.append(_straight((left, -d), (end, -d), _division(end - left, size)))
        if below:
            pieces.append(_below(plan.strip, d, size))
        pieces.append(_quarter(stop, d, _division(0.5 * np.pi * d, size)))
        return _Row(_chain(pieces), first, leg, d)
    # far away even the part below strip and axis is too short
    length = stop + 0.5 * np.pi * d
    along = np.linspace(0.0, length, _division(length, size) + 1)
    angle = np.maximum(along - stop, 0.0) / d
    points = np.stack([np.minimum(along, stop) + d * np.sin(angle), -d * np.cos(angle)])
    points[:, -1] = stop + d, 0.0
    return _Row(points, first, 0, d)


def _below(strip: Array, depth: float, size: float) -> Array:
    """A row of every vertex of the strip, every second, fourth or eighth ..., and its last."""
    every = 2 ** max(0, round(math.log2(SPACING * size / (strip[1] - strip[0]))))
    radii = strip[: -(every // 2) - 1 : every]
    return np.stack([np.append(radii, strip[-1]), np.full(radii.size + 1, -depth)])


def _division(length: float, size: float) -> int:
    return max(1, round(length / (SPACING * size)))


def _straight(start: tuple[float, float], stop: tuple[float, float], count: int) -> Array:
    return np.linspace(start, stop, count + 1, axis=1)


def _quarter(centre: float, radius: float, count: int) -> Array:
    angle = np.linspace(0.0, 0.5 * np.pi, count + 1)
    points = np.stack([centre + radius * np.sin(angle), -radius * np.cos(angle)])
    points[:, -1] = centre + radius, 0.0
    return points


def _chain(pieces: list[Array]) -> Array:
    return np.concatenate([pieces[0], *(piece[:, 1:] for piece in pieces[1:])], axis=1)


def _join(plan: Layers, upper: _Row, lower: _Row, *, below_axis: bool) -> Indices:
    """Fill the space between two rows with triangles.

    Walking along both rows at once, each edge of one row makes a triangle with that vertex of the other
    row which the walk has reached when it comes to the middle of the edge.
    """
    skip = upper.corner if below_axis else 0
    d = 0.5 * (upper.distance + lower.distance)
    key_a, key_b = (_position(plan, row, d, below_axis)[s:] for row, s in ((upper, skip), (lower, 0)))
    node_a = upper.first + skip + np.arange(key_a.size)
    node_b = lower.first + np.arange(key_b.size)
    mid_a, mid_b = 0.5 * (key_a[1:] + key_a[:-1]), 0.5 * (key_b[1:] + key_b[:-1])
    from_a = np.stack([node_a[:-1], node_a[1:], node_b[np.searchsorted(mid_b, mid_a, side="left")]])
    from_b = np.stack([node_b[:-1], node_b[1:], node_a[np.searchsorted(mid_a, mid_b, side="right")]])
    return np.concatenate([from_a, from_b], axis=1)


def _position(plan: Layers, row: _Row, d: float, below_axis: bool) -> Array:
    """Place along a row, comparable between neighbouring rows whose mean distance from the strip is ``d``."""
    start, stop = plan.strip[0], plan.strip[-1]
    r, z = row.points
    beyond = np.maximum(r - stop, 0.0)
    place = np.minimum(r, stop) + d * np.arctan2(beyond, np.maximum(-z, 0.0) + (beyond == 0.0))
    if below_axis or row.distance == 0.0:
        return place
    place = np.where(r < start, start - d * (start - r) / row.distance, place)
    place[: row.corner] -= d * (1.0 + z[: row.corner] / row.distance)
    return place
