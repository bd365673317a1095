"""Node-release closure and its process zone: nodes one zone further out, and the length at fixed stress.

The closure ``(1/(2 da)) int sigma(r) g(r + da) dr`` over the process zone is read as the work of the nodal
reactions ``f_i`` (which contain ``2 pi r``) through the gap one zone further out,

    ``I(s) = (1/(2 da)) sum_i -f_i/(2 pi r_i) g(r_i + da)``.

On a uniform mesh with a whole number of elements per zone a shifted vertex is a vertex and a shifted mid-side
node a mid-side node; the sum is then the virtual crack closure integral, equal to the discrete energy release
of an elastic body exactly, with no error from the singular stress. Otherwise the gap at ``r_i + da`` is
interpolated between the neighbouring nodes *of the same kind*, which keeps that property up to second order:
interpolation by the quadratic shape functions would mix the two kinds, whose reactions differ by a factor
of two, and ripple from node to node.

A zone of fixed cohesive stress ``s`` is as long as the mean tension over it is ``(4/pi) s`` (definition:
``contact_scene.adhesion``). The tension over a length is a sum of nodal forces, which the mesh knows far
better than the singular stress itself; between vertices its square, nearly linear in the distance from the
edge, is interpolated.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LEAST_ZONE = 1e-2
"""Shortest zone of fixed stress that is followed, in zones at rest: a tenth of an element."""


class ZoneShift:
    """Between which nodes the point one zone outside each node lies.

    ``radii`` are those of vertices and mid-side nodes in turn, from the axis. On a uniform mesh with a whole
    number of elements per zone that point is a node; otherwise the gap there is interpolated between the
    neighbouring nodes *of the same kind*.
    """

    def __init__(self, radii: Array, zone: float) -> None:
        count = len(radii)
        self.radii, self.zone = radii, zone
        self.low = np.zeros(count, dtype=int)
        self.high = np.zeros(count, dtype=int)
        self.share = np.zeros(count)
        for kind in (0, 1):
            nodes = np.arange(kind, count, 2)
            own = radii[nodes]
            targets = own + zone
            right = np.clip(np.searchsorted(own, targets), 1, len(nodes) - 1)
            width = own[right] - own[right - 1]
            share = np.clip((targets - own[right - 1]) / width, 0.0, 1.0)
            self.low[nodes], self.high[nodes], self.share[nodes] = nodes[right - 1], nodes[right], share
        self._ends = self.low + self.share * (self.high - self.low)
        # first node whose shifted point can lie outside the contact of the nodes 0..m
        self.first = np.searchsorted(np.maximum.accumulate(self.high), np.arange(count), side="right")

    def nodes(self, last: int, top: int) -> tuple[int, int]:
        """First node whose force the closure asks for, and the end of those whose gap it asks for.

        ``last`` is the last node in full contact, ``top`` the last with a force.
        """
        first = max(int(self.first[last]), 1)
        return first, int(self.high[first : top + 1].max()) + 1

    def seen(self, s: float) -> float:
        """Position, in nodes, of the end of the zone in front of an edge at ``s``."""
        m = math.floor(s)
        return float(self._ends[m] + (s - m) * (self._ends[m + 1] - self._ends[m]))

    def closure(self, first: int, forces: Array, gap: Array) -> Array | float:
        """Closure integral: half of what the nodal forces do over the gaps one zone further out, per area.

        Forces of the nodes from ``first`` to the last with one, gaps from that last one on.
        """
        top = first + forces.shape[-1] - 1
        inside = slice(first, top + 1)
        known = np.concatenate([np.zeros((*gap.shape[:-1], top - first)), gap], axis=-1)
        low, high, share = self.low[inside] - first, self.high[inside] - first, self.share[inside]
        shifted = (1.0 - share) * known[..., low] + share * known[..., high]
        return (-forces / self.radii[inside]) @ shifted.T / (4.0 * np.pi * self.zone)


def zone_of_stress(
    radii: Array, forces: Callable[[int], Array], edge: float, stress: float, at_rest: float
) -> float:
    """Length of the process zone of fixed stress, from as many nodes from the edge inwards as it takes."""
    reach = 2.0 * at_rest
    while True:
        first = max(int(np.searchsorted(radii, edge - reach)), 1)
        tension = -forces(first) / (2.0 * np.pi * radii[first:])
        length = zone_length(radii[first:], tension, first, edge, stress)
        if length is not None:
            return max(length, LEAST_ZONE * at_rest)
        if first == 1:
            return edge
        reach *= 2.0


def zone_length(radii: Array, tension: Array, first: int, edge: float, stress: float) -> float | None:
    """Length over which the mean tension is ``(4/pi) stress``; ``None`` if it reaches beyond the first node.

    ``tension`` is force per length of the nodes ``first``, ...; vertices have even numbers.
    """
    allowed = 4.0 / math.pi * stress
    beyond = np.cumsum(tension[::-1])[::-1]
    vertices = np.arange(first % 2, len(radii), 2)
    vertices = vertices[radii[vertices] < edge][::-1]  # from the edge inwards
    over = beyond[vertices] - 0.5 * tension[vertices]
    inwards = radii[vertices]
    if (
        first == 1 and len(vertices) > 1
    ):  # to the axis, where no force tells a stress, as between the last two
        growth = (over[-1] - over[-2]) / (inwards[-2] - inwards[-1])
        over = np.append(over, over[-1] + growth * inwards[-1])
        inwards = np.append(inwards, 0.0)
    squares = np.concatenate(([0.0], over * np.abs(over)))
    distance = np.concatenate(([0.0], edge - inwards))
    excess = squares - (allowed * distance) ** 2
    pulling = np.flatnonzero(excess > 0.0)
    if not len(pulling):
        return 0.0
    after = np.flatnonzero(excess[pulling[0] :] <= 0.0)
    if not len(after):
        return None
    end = int(pulling[0] + after[0])
    start, width = distance[end - 1], distance[end] - distance[end - 1]
    # squares linear, (allowed d)^2 quadratic in the share of the interval
    a = (allowed * width) ** 2
    b = 2.0 * allowed**2 * start * width - (squares[end] - squares[end - 1])
    c = -excess[end - 1]
    return float(start + width * (-2.0 * c) / (b + math.sqrt(b * b - 4.0 * a * c)))
