"""What a step begins with: the load, the memory of the contact, the table of passages, and sums over it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.closure import BASE
from validation.reference.path.fields import Passages
from validation.reference.path.rheology import Body

Array = NDArray[np.float64]
GRADED, GRADING = 1.5, 8.0
"""First cut from the end of a long step, in zones, and ratio of the distances of the next ones."""
LAYER = 2e-3
"""Thickness of a layer, in zones, below which breaks are graded towards the edge for it."""
_NEAR = np.array([0.0, 1e-3, 1e-2, 0.1, -1e-3, -1e-2, -0.1])


@dataclass(frozen=True)
class State:
    """A row of the path and all that lies behind it.

    ``held``, ``held_squares``: ``int b_k dx`` and ``int b_k^2 dx`` over the contact; ``free_squares``: ``int
    e_j^2 dx`` over the free surface. ``layer``: the way of the edge in the shortest relaxation time, which is
    how deep what it covers still relaxes.
    """

    parameter: float
    time: float
    depth: float
    radius: float
    force: float
    memory: Array
    surface: Passages
    held: Array
    held_squares: Array
    free_squares: Array
    layer: float = math.inf

    def carried(self, body: Body, x: Array) -> tuple[Array, Array]:
        """``G`` at distances (m,) from the edge, and branch forces or unit strains there (m, n)."""
        rheology, G = body.rheology, body.transform(np.maximum(self.radius + x, 0.0))
        held, carried = self.surface.at(x, G, rheology.times, rheology.retardation)
        carried[held] += rheology.moduli * self.memory
        return G, carried

    def in_contact(self, body: Body, x: Array) -> tuple[Array, Array]:
        """Branch forces (m, n) and strain (m,) at distances from the edge, in contact."""
        G, branches = self.carried(body, x)
        return branches, self.depth - G

    def edges_between(self, low: float, high: float) -> Array:
        """Edges of the table strictly between two distances from the edge, each once."""
        edges = self.surface.edges
        first, last = edges.searchsorted(low, side="right"), edges.searchsorted(high, side="left")
        edges = edges[first:last]
        return edges[np.append(True, edges[1:] > edges[:-1])] if len(edges) else edges

    def cuts(self, travel: float, zone: float, knots: Array) -> Array:
        """Distances on the way, in its order, between which profile and fields passed are smooth."""
        low, high = sorted((0.0, travel))
        inner = self.edges_between(low, high)
        knots = knots - self.radius
        inner = np.union1d(inner, knots) if len(knots) else inner
        inner = inner[(inner - low > 1e-9 * (high - low)) & (high - inner > 1e-9 * (high - low))]
        if zone and high - low > 2.0 * GRADED * zone:  # what a closure looks at is known on its own scale
            count = int(math.log((high - low) / (GRADED * zone)) / math.log(GRADING)) + 1
            near = travel - math.copysign(GRADED * zone, travel) * GRADING ** np.arange(count)
            inner = np.union1d(inner, near[(near > low) & (near < high)])
        cuts = np.concatenate(([low], inner, [high]))
        return cuts if travel > 0.0 else cuts[::-1]

    def breaks(self, travel: float, zone: float) -> Array:
        """Breaks of the closure after some travel, from the inner end of the zone."""
        behind = self.edges_between(travel - zone, travel) - (travel - zone)
        ahead = self.edges_between(travel, travel + zone) - travel
        breaks = np.concatenate((BASE * zone, behind, ahead, self._layers(travel, zone)))
        breaks = np.sort(breaks[(breaks >= 0.0) & (breaks <= zone)])
        apart = breaks[1:] - breaks[:-1] > 1e-12 * zone
        breaks = breaks[np.append(True, apart)]
        breaks[-1] = zone
        return breaks

    def _layers(self, travel: float, zone: float) -> Array:
        """Where the edge was before, as seen from a zone that passes it, and layers that relax."""
        both = np.array([-travel, zone - travel])
        near = (both[:, None] + zone * _NEAR).ravel()
        thickest = LAYER * zone
        if not 0.0 < self.layer < thickest:
            return near
        count = math.ceil(math.log(thickest / self.layer) / math.log(GRADING))
        depth = thickest * GRADING ** -np.arange(1.0, count + 1.0)
        return np.concatenate((near, zone - depth, both[1] - depth))
