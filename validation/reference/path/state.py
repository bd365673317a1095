"""What a step begins with: the load, the memory of the contact, the table of passages, and sums over it.

Where the load had a kink or the edge turned, what it left has a jump, or one of slope. The closure has its
breaks there. The path has a corner where the edge or an end of its zone comes to one of these kinks. It is
passed over: the next steps are predicted by as many rows as lie behind. At the sharpest, what was never in
contact, the rows begin anew.

Kinks fade, and what many old turns have left is then smooth. So at every new one the entries of the table are
looked at two by two, and those joined that one polynomial replaces. A kink is what is still between entries.
The rows begin anew there, too: no step is predicted across the little that this changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.closure import BASE
from validation.reference.path.fields import NODES, TO_POWERS, Passages, along
from validation.reference.path.numerics import NEGLIGIBLE, ROUNDING, SMALL_PART, powers, total
from validation.reference.path.rheology import IndentedBody

Array = NDArray[np.float64]
GRADING = 8.0
"""Ratio of the distances from the edge of breaks and cuts that see a layer relax."""
FADED = 1e-2
"""Change, in tolerances and the field at the edge, below which two entries are joined: times their width, in
zones or as seen from the edge, for it is integrals over the fields that count. And times zone over radius: it
takes so little at least to drive the edge by a zone."""


@dataclass(frozen=True)
class State:
    """A row of the path and all that lies behind it.

    ``depths``: ``(D, C)``, of which ``memory`` (K + 1, n) is. ``held`` (K + 1, n), ``held_squares`` (n,):
    ``int phi b_k dx`` and ``int b_k^2 dx`` over the contact; ``free``, ``free_squares``: those of ``e_j``
    over the free surface. ``layer``: the shortest way that a closing edge has gone in the shortest
    relaxation time, which is how deep what it covers still relaxes. Not the last one: as the number of breaks
    changes so does their error, which would let an edge that sets off stop again.
    """

    parameter: float
    time: float
    depths: Array
    radius: float
    force: float
    memory: Array
    surface: Passages
    held: Array
    held_squares: Array
    free: Array
    free_squares: Array
    layer: float = math.inf
    zone: float = 0.0

    @property
    def depth(self) -> float:
        """Penetration."""
        return float(self.depths[0])

    def at_depth(self, depth: float) -> State:
        """The same with the indenter elsewhere, where it touches nothing."""
        return replace(self, depths=np.append(depth, self.depths[1:]))

    def carried(self, body: IndentedBody, x: Array) -> tuple[Array, Array, Array]:
        """``phi`` (m, K + 1), ``G`` at distances from the edge; branch forces or unit strains (m, n)."""
        rheology, at = body.rheology, np.maximum(self.radius + x, 0.0)
        phi, G = body.image.functions(at), body.transform(at)
        held, carried = self.surface.at(x, G, rheology.times, rheology.retardation)
        carried += np.where(held[:, None], phi @ (rheology.moduli * self.memory), 0.0)
        return phi, G, carried

    def in_contact(self, body: IndentedBody, x: Array) -> tuple[Array, Array]:
        """Branch forces (m, n) and strain (m,) at distances from the edge, in contact."""
        phi, G, branches = self.carried(body, x)
        return branches, phi @ self.depths - G

    def edges_between(self, low: float, high: float) -> Array:
        """Edges of the table strictly between two distances from the edge."""
        edges = self.surface.edges
        first, last = edges.searchsorted(low, side="right"), edges.searchsorted(high, side="left")
        return edges[first:last]

    def cuts(self, travel: float, knots: Array) -> Array:
        """Distances on the way, in its order, between which profile and fields passed are smooth."""
        low, high = sorted((0.0, travel))
        inner = self.edges_between(low, high)
        knots = knots - self.radius
        inner = np.union1d(inner, knots) if len(knots) else inner
        least = NEGLIGIBLE * (high - low)
        inner = inner[(inner - low > least) & (high - inner > least)]
        cuts = np.concatenate(([low], inner, [high]))
        return cuts if travel > 0.0 else cuts[::-1]

    def breaks(self, travel: float, zone: float) -> Array:
        """Breaks of the closure after some travel, from the inner end of the zone."""
        behind = self.edges_between(travel - zone, travel) - (travel - zone)
        ahead = self.edges_between(travel, travel + zone) - travel
        breaks = np.concatenate((BASE * zone, behind, ahead, *self._layers(travel, zone)))
        return np.unique(breaks[(breaks >= 0.0) & (breaks <= zone)])

    def _layers(self, travel: float, zone: float) -> tuple[Array, ...]:
        """The layer that relaxes behind the edge, and behind where it was before."""
        thickest = BASE[1] * zone
        if not self.layer < thickest:
            return ()
        thinnest = max(self.layer, ROUNDING * zone)
        count = math.ceil(math.log(thickest / thinnest) / math.log(GRADING))
        depth = thickest * GRADING ** -np.arange(1.0, count + 1.0)
        return zone - depth, zone - travel - depth


def faded(state: State, body: IndentedBody, zone: float, tolerance: float) -> State:
    """The state with entries joined that have come to agree."""
    if state.radius == 0.0 or len(state.surface.held) < 2:
        return state
    size, relaxed = zone or SMALL_PART * state.radius, body.rheology.relaxed
    phi, G, carried = state.carried(body, size * np.array([-1.0, -ROUNDING, ROUNDING, 1.0]))
    field = np.abs(total(carried) + np.array([relaxed, relaxed, -1.0, -1.0]) * (phi @ state.depths - G))
    allowed = FADED * tolerance * size / state.radius * np.array([field[2:].max(), field[:2].max()])
    surface = state.surface
    for first in (0, 1):
        surface = _joined(surface, body, state.radius, first, size, allowed)
    return replace(state, surface=surface)


def _joined(
    surface: Passages, body: IndentedBody, radius: float, first: int, size: float, allowed: Array
) -> Passages:
    """The table with every other pair of entries joined where that changes less than ``allowed``.

    The new one carries what they do now, as if it were passed now.
    """
    pairs = np.arange(first, len(surface.held) - 1, 2)
    pairs = pairs[surface.held[pairs] == surface.held[pairs + 1]]
    if not len(pairs):
        return surface
    low, middle, high = surface.edges[pairs], surface.edges[pairs + 1], surface.edges[pairs + 2]
    parabola = _over_both(surface.parabola[pairs], surface.parabola[pairs + 1], low, middle, high)
    linear, one, two = parabola[:, 2:], (middle - low)[:, None] * NODES, (high - middle)[:, None] * NODES
    new = (high - low)[:, None] * NODES * (linear + (1.0 - linear) * NODES)
    x = np.hstack((low[:, None] + new, low[:, None] + one, middle[:, None] + two))
    G = body.transform(np.maximum(radius + x.ravel(), 0.0))
    carried = surface.at(x.ravel(), G, body.rheology.times, body.rheology.retardation)[1]
    carried = carried.reshape(*x.shape, -1)
    count = len(NODES)
    left = np.matmul(TO_POWERS, carried[:, :count])
    g = along(parabola.repeat(2 * count, axis=0), x[:, count:].ravel())[0]
    fitted = np.matmul(powers(g, count - 1).reshape(len(pairs), 2 * count, count), left)
    change = np.abs(fitted - carried[:, count:]).sum(axis=2).max(axis=1)
    width, away = high - low, np.minimum(np.abs(low), np.abs(high))
    share = width / np.minimum(np.maximum(width, away), size)
    agree = change * share < allowed[surface.held[pairs].astype(int)]
    return surface.joined(pairs[agree], parabola[agree], left[agree])


def _over_both(one: Array, two: Array, low: Array, middle: Array, high: Array) -> Array:
    """Parabolas that leave with the slope of one, arrive with that of the next, and have its pace between."""
    (begin, leaving), (met, before) = along(one, low), along(one, middle)
    (after, behind), (end, arriving) = along(two, middle), along(two, high)
    pace = behind / before
    length = np.abs(met - begin) + np.abs(end - after) * pace
    linear = 1.0 + 0.5 * length * (leaving - arriving / pace) / (high - low)
    linear[~np.isfinite(linear)] = 1.0  # the edge turned between them
    return np.column_stack((low, high - low, np.minimum(np.maximum(linear, 0.0), 2.0)))
