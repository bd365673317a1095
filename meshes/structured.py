"""A structured mesh of the half-space: rows of vertices at growing distances from the fine strip.

Row j runs at the distance d_j from the strip: down from the surface (once it is deeper, from the axis), along
below the strip, and up again to the surface on a quarter circle about the end of the strip. Towards the axis
the row turns a square corner, so that the row at ``d = fine_from`` lies on the axis. It is a tensor grid,
distance by position along the row, whose rows get fewer vertices as they get thicker; neighbouring rows are
joined by triangles. It needs nothing but numpy.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshes.edge import refine_edge
from meshes.mesh import Array, HalfSpaceMesh, Indices, assemble
from meshes.parameters import MeshParameters
from meshes.surface import Layers, layers

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
    rows: list[_Row] = []
    for level in range(plan.offsets.size):
        first = rows[-1].first + rows[-1].points.shape[1] if rows else 0
        rows.append(_row(plan, parameters, level, first))
    rows[-1].points[0, -1] = parameters.domain_radius
    cells = [_join(plan, *pair, below_axis=k >= plan.axis) for k, pair in enumerate(pairwise(rows))]
    points = np.concatenate([row.points for row in rows], axis=1)
    points, triangles = refine_edge(points, np.concatenate(cells, axis=1), parameters)
    return assemble(points, triangles, replace(parameters, family="structured"))


def _row(plan: Layers, parameters: MeshParameters, level: int, first: int) -> _Row:
    start, stop, d = plan.strip[0], plan.strip[-1], plan.offsets[level]
    if level == 0:
        return _Row(np.stack([plan.strip, np.zeros_like(plan.strip)]), first, 0, 0.0)
    size = parameters.size_at(d)
    arc = _division(0.5 * np.pi * d, size)
    if level <= plan.axis:  # down, along, along below the strip, round
        left = 0.0 if level == plan.axis else start - d
        leg = _division(d, size)
        down = _straight((left, 0.0), (left, -d), leg)
        if stop - start > size:
            along = _straight((left, -d), (start, -d), leg)
            below = _straight((start, -d), (stop, -d), _division(stop - start, size))
            pieces = [down, along, below, _quarter(stop, d, arc)]
        else:  # the part below the strip is too short for elements of its own
            along = _straight((left, -d), (stop, -d), _division(stop - left, size))
            pieces = [down, along, _quarter(stop, d, arc)]
        return _Row(_chain(pieces), first, leg, d)
    if stop > 1.5 * size:
        return _Row(
            _chain([_straight((0.0, -d), (stop, -d), _division(stop, size)), _quarter(stop, d, arc)]),
            first,
            0,
            d,
        )
    # far away even the part below strip and axis is too short
    length = stop + 0.5 * np.pi * d
    along = np.linspace(0.0, length, _division(length, size) + 1)
    angle = np.maximum(along - stop, 0.0) / d
    points = np.stack([np.minimum(along, stop) + d * np.sin(angle), -d * np.cos(angle)])
    points[:, -1] = stop + d, 0.0
    return _Row(points, first, 0, d)


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
