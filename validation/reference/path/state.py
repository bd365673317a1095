"""What a step begins with: the load, the memory of the contact, the table of passages, and sums over it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.closure import BASE
from validation.reference.path.fields import Passages, untouched
from validation.reference.path.polynomials import gauss
from validation.reference.tracking.surface import Body

__all__ = ["Body", "State", "start_state"]

Array = NDArray[np.float64]
_POINTS, _WEIGHTS = gauss(8)
GRADING = 0.3
"""Least distance of two cuts over that to the next kink: layers of any thickness are resolved."""
SPACING = 0.1
"""Largest distance of cuts within old fields, in zones; without a zone in tenths of the radius."""


@dataclass(frozen=True)
class State:
    """A row of the path and all that lies behind it.

    ``held``, ``held_squares``: ``int b_k dx`` and ``int b_k^2 dx`` over the contact; ``free_squares``:
    ``int e_j^2 dx`` over the free surface. ``kinks``: radii at which the path had a kink.
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
    kinks: tuple[float, ...] = ()

    def edges_between(self, low: float, high: float) -> Array:
        """Edges of the table strictly between two radii."""
        edges = self.surface.edges
        first, last = np.searchsorted(edges, low, side="right"), np.searchsorted(edges, high, side="left")
        return edges[first:last]

    def thinned(self, edges: Array, spacing: float) -> Array:
        """Edges that rise, the closer the nearer to a kink; kinks themselves stay."""
        if not len(edges):
            return edges
        kinks = np.array(self.kinks)
        away = np.abs(edges[:, None] - kinks).min(axis=1, initial=math.inf)
        least = np.minimum(GRADING * away, spacing)
        kept, last = [], -math.inf
        for x, apart in zip(edges.tolist(), least.tolist(), strict=True):
            if x - last > apart or apart < 1e-12 * x:
                kept.append(x)
                last = x
        return np.array(kept)

    def cuts(self, radius: float, zone: float) -> Array:
        """Radii from here to another, in that order, between which the fields passed are smooth."""
        low, high = sorted((self.radius, radius))
        inner = self.thinned(self.edges_between(low, high), SPACING * (zone or 0.1 * high))
        inner = inner[(inner - low > 1e-9 * (high - low)) & (high - inner > 1e-9 * (high - low))]
        cuts = np.concatenate(([low], inner, [high]))
        return cuts if radius > self.radius else cuts[::-1]

    def breaks(self, radius: float, zone: float) -> Array:
        """Breaks of the closure at a radius, from the inner end of the zone."""
        behind = self.thinned(self.edges_between(radius - zone, radius), SPACING * zone) - (radius - zone)
        ahead = self.thinned(self.edges_between(radius, radius + zone), SPACING * zone) - radius
        breaks = np.concatenate((BASE * zone, behind, ahead, self._layers(radius, zone)))
        breaks = np.unique(breaks[(breaks >= 0.0) & (breaks <= zone)])
        breaks = breaks[np.append(True, np.diff(breaks) > 1e-12 * zone)]
        breaks[-1] = zone
        return breaks

    def _layers(self, radius: float, zone: float) -> Array:
        """Where the radius it began from lies as seen from a zone, while it is passed."""
        here = np.array([self.radius])
        both = np.concatenate((here - radius, here - radius + zone))
        return (both[:, None] + zone * np.array([0.0, 1e-3, 1e-2, 0.1, -1e-3, -1e-2, -0.1])).ravel()


def start_state(body: Body, depth: float, radius: float, glassy: bool) -> State:
    """The elastic contact of that radius on a surface never touched before, glassy or relaxed."""
    rheology = body.rheology
    moduli = rheology.moduli if glassy else 0.0 * rheology.moduli
    breaks = radius * np.array([0.0, 0.02, 0.1, 0.3, 0.6, 1.0])
    width = np.diff(breaks)
    x = (breaks[:-1, None] + width[:, None] * _POINTS).ravel()
    weight = (width[:, None] * _WEIGHTS).ravel()
    strain = depth - body.transform(x)
    whole = depth * radius - body.transform.integral(radius)
    return State(
        parameter=0.0,
        time=0.0,
        depth=depth,
        radius=radius,
        force=2.0 * (rheology.relaxed + float(moduli.sum())) * whole,
        memory=np.zeros_like(moduli),
        surface=untouched(radius, 0.0, moduli * depth, -moduli),
        held=moduli * whole,
        held_squares=moduli**2 * float(weight @ strain**2),
        free_squares=np.zeros_like(moduli),
        kinks=(radius,),
    )
