"""Travels of the edge that all scenes step through, and what of a step does not depend on the scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.zone import (
    BEHIND,
    COUNT,
    LAYERED,
    NEAR,
    SHARES,
    SHORTEST,
    Quadrature,
    quadrature,
)
from validation.reference.path.numerics import gauss

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Flags = NDArray[np.bool_]
Kind = Literal["opening", "closing", "turned", "corner"]
"""An edge that opens from rest on what is relaxed, one that closes, one that opens where it closed, and the
same beside the place from which it closed: a corner of what it left, from which these travels count."""

WIDEST: dict[Kind, float] = {"opening": 1.2, "closing": 0.6, "turned": 1.2, "corner": 1.2}
"""Longest steps in travels, or in what is left of the radius, times the resolution; of an edge that closes by
longer ones the error is told three times as large, and a spring too soft for its turn is not found out."""
SPRUNG = 0.5
"""Part of these of an edge that opens on a spring: on a soft one the largest tension is close to the loss of
contact, to which the edge speeds up."""
ROWS = 6
"""Rows of a polynomial over the travel."""
DEEPER = 2.0
"""Width of a panel of what is left in contact, in parts of its depth, times the resolution; next to the edge
panels are ``NEAR``."""
PLACES = gauss(ROWS)[0]
_INVERSE = np.linalg.inv(PLACES[:, None] ** np.arange(ROWS))
_UP_TO = np.append(PLACES, 1.0)[:, None]
RUNNING = [(_UP_TO ** (np.arange(ROWS) + m) / (np.arange(ROWS) + m)) @ _INVERSE for m in (1, 2)]
"""Integrals from the beginning of a panel to its places and its end, of values there, and of their product
with the share of the panel."""


@dataclass(frozen=True)
class Travel:
    """A step of the grid: points, and how they and the first guess follow from the rows before.

    ``passed``: points that the edge has passed, of which the first, ``near``, see the new row. ``behind``:
    weights of values at depths, from the first that matters, for nodes and points behind the edge and, last,
    for the edge. ``rows``: travels, or roots of them, of the rows of the polynomial over the step, of which
    the last two are its ends.
    """

    points: Quadrature
    passed: int
    near: int
    first: int
    old: Array
    new: Array
    guess: Array
    rows: Array
    first_depth: int
    behind: Array

    @cached_property
    def gained(self) -> tuple[Array, Array]:
        """As of :func:`gained`, shapes (Q, n)."""
        weights, parts = gained(self.rows, np.full(len(self.rows), True))
        return weights.T, parts.T


class Depths:
    """Depths ``s`` (m,) behind a radius, in zones, and polynomials through values there.

    They lie in panels, in the root of the distance: times of cover may be smooth in that only.
    """

    def __init__(self, least: float, deepest: float, resolution: int) -> None:
        sides = []
        for farthest in (-least, deepest):
            ends = [*NEAR] if farthest > 0.0 else [0.0]
            while ends[-1] < farthest:
                ends.append(ends[-1] * (1.0 + DEEPER / resolution))
            sides.append(np.sqrt(ends))
        self.ends = np.concatenate((-sides[0][:0:-1], sides[1]))
        self.width = np.diff(self.ends)[:, None]
        root = self.ends[:-1, None] + self.width * PLACES
        self.s = (root * np.abs(root)).ravel()

    def panel(self, s: Array) -> tuple[Whole, Array]:
        """Panels in which depths lie, and weights (m, ROWS) of the values there."""
        root = np.sign(s) * np.sqrt(np.abs(s))
        panel = np.clip(self.ends.searchsorted(root, side="right") - 1, 0, len(self.width) - 1)
        share = (root - self.ends[panel]) / self.width[panel, 0]
        return panel, lagrange(np.broadcast_to(PLACES, (len(s), ROWS)), share)

    def at(self, values: Array, s: Array) -> Array:
        """Values (n, B) at a depth of each scene, of some (m, n, B)."""
        panel, weights = self.panel(s)
        places = ROWS * panel[:, None] + np.arange(ROWS)
        return np.asarray(np.einsum("br,brn->nb", weights, values[places, :, np.arange(len(s))[:, None]]))

    def weights(self, s: Array) -> tuple[int, Array]:
        """First place that matters for depths, and weights (m, n) from it on."""
        panel, values = self.panel(s)
        first = int(panel.min())
        table = np.zeros((len(s), int(panel.max()) + 1 - first, ROWS))
        table[np.arange(len(s)), panel - first] = values
        return ROWS * first, table.reshape(len(s), -1)

    def running(self, values: Array) -> Array:
        """Integrals (m, B) of values (m, B) from the least depth to the others, in zones."""
        panels = values.reshape(len(self.width), ROWS, -1)
        begin, side = self.ends[:-1, None], np.sign(self.ends[:-1, None] + self.ends[1:, None])
        begin, width = 2.0 * side * self.width * begin, 2.0 * side * self.width**2
        parts = begin[:, None] * (RUNNING[0] @ panels) + width[:, None] * (RUNNING[1] @ panels)
        before = np.concatenate((0.0 * parts[:1, -1], parts[:-1, -1].cumsum(axis=0)))
        return (before[:, None] + parts[:, :-1]).reshape(values.shape)


@dataclass
class Grid:
    """Travels ``g``, rows ``breaks`` at which the path has corners; ``least``: radius in zones."""

    g: Array
    breaks: Whole
    kind: Kind
    least: float
    count: int
    sprung: bool
    steps: dict[int, Travel] = field(default_factory=dict)

    @cached_property
    def depths(self) -> Depths:
        """Of what the edge comes by."""
        return Depths(float(self.g[0]), float(self.g[-1]) + 1.0, int(self.breaks[-1] - self.breaks[-2]))

    def weights(
        self, at: Array, newest: int, smooth_in: Callable[[Array], Array] = np.asarray
    ) -> tuple[int, Array]:
        """First row that matters for travels, and weights (m, n) of rows from it to the newest."""
        first, count = panels(
            self.breaks[:, None], np.clip(self.g.searchsorted(at) - 1, 0, newest - 1), newest
        )
        begin = int(first.min())
        table = np.zeros((len(at), newest + 1 - begin))
        for i in np.unique(count):
            those = np.flatnonzero(count == i)
            rows = first[those, None] + np.arange(i)
            table[those[:, None], rows - begin] = lagrange(smooth_in(self.g[rows]), smooth_in(at[those]))
        return begin, table

    def step(self, k: int) -> Travel:
        """Made when it is first asked for."""
        if k not in self.steps:
            self.steps[k] = self._made(k)
        return self.steps[k]

    def _made(self, k: int) -> Travel:
        now = self.g[k]
        closing, turned, corner = (self.kind == kind for kind in ("closing", "turned", "corner"))
        corners = now - self.g[self.breaks]
        if turned or corner:
            corners = np.concatenate((corners, NEAR))
        if turned and now < 1.0:  # it may set off as a root, and comes by layers that relax
            corners = np.concatenate((corners, now - NEAR, 1.0 - NEAR))
        corners = corners[(corners > 0.0) & (corners < 1.0)]
        points = quadrature(tuple(corners.tolist()), closing, self.count)
        points = points if closing else points.up_to(1.0 / max(self.least - now, SHORTEST))
        passed = now - (1.0 - points.v[:, 0] if closing else points.v[:, 0])
        passed = passed[passed > self.g[0]]
        behind = 0, np.zeros((0, 0))
        if turned or corner:
            behind = self.depths.weights(now + np.append(1.0 - np.append(BEHIND, points.v), 0.0))
        if k == 0:
            none = np.zeros((0, 0))
            return Travel(points, 0, 0, 0, none, np.zeros((0, 1)), np.zeros(0), np.zeros(0), *behind)
        s = np.asarray if closing or corner else np.sqrt  # an edge may set off with no speed
        begin, weights = self.weights(passed, k, s)
        low = max(int(self.breaks[self.breaks.searchsorted(k - 1) - 1]), k - ROWS) if k > 1 else 0
        guess = lagrange(s(self.g[None, low:k]), s(np.array([now])))[0]
        old, near = np.ascontiguousarray(weights[:, :-1]), int(weights[:, -1].nonzero()[0].max()) + 1
        rows = np.arange(int(panels(self.breaks[:, None], np.array([k - 1]), k)[0][0]), k + 1)
        new = weights[:near, -1:]
        return Travel(points, len(passed), near, begin, old, new, guess, s(self.g[rows]), *behind)


def panels(breaks: Whole, panel: Whole, newest: Whole | int) -> tuple[Whole, Whole]:
    """First row and number of rows of the polynomials in panels, of rows up to ``newest``.

    None goes across one of the breaks (l, ...), of which the first is zero.
    """
    low = np.where(breaks <= panel, breaks, 0).max(axis=0)
    high = np.minimum(np.where(breaks > panel, breaks, newest).min(axis=0), newest)
    count = np.minimum(ROWS, high - low + 1)
    return np.minimum(np.maximum(panel - (count - 2) // 2, low), high - count + 1), count


def lagrange(nodes: Array, at: Array) -> Array:
    """Weights (m, n) of values at nodes (m, n) for places (m,)."""
    same = np.eye(nodes.shape[1], dtype=bool)
    apart = np.where(same, 1.0, nodes[:, :, None] - nodes[:, None])
    return np.asarray(np.where(same, 1.0, (at[:, None] - nodes)[:, None] / apart).prod(axis=2))


def gained(rows: Array, known: Flags) -> tuple[Array, Array]:
    """Weights (n, Q, ...) of rows (n, ...) for values at points of the step between the last two, and for the
    parts of their change there; rows that are not ``known`` count nothing.

    The last point begins the layer next to the end, over which values are straight: it is one part.
    """
    past, now = rows[-2:]
    at = past + np.multiply.outer(LAYERED, now - past)
    weights, slopes = np.ones((2, len(rows), *at.shape))
    slopes *= 0.0
    for j, (row, there) in enumerate(zip(rows, known, strict=True)):
        others = np.arange(len(rows)) != j
        apart = np.where(there, rows[others] - row, 1.0)[:, None]
        slopes[others] = np.where(
            there, (slopes[others] * (at - row) + weights[others]) / apart, slopes[others]
        )
        weights[others] *= np.where(there, (at - row) / apart, 1.0)
    parts = slopes * (now - past)
    parts[:, :-1] *= np.expand_dims(SHARES[:-COUNT], tuple(range(1, at.ndim)))
    parts[:-1, -1], parts[-1, -1] = -weights[:-1, -1], 1.0 - weights[-1, -1]
    mask = known[:, None]
    return np.where(mask, weights, 0.0), np.where(mask, parts, 0.0)


@lru_cache(maxsize=256)  # a batch of all zones and speeds takes 170
def grid(
    resolution: int, size: int, kind: Kind, count: int = COUNT, sprung: bool = False, ahead: int = 0
) -> Grid:
    """For radii from ``2^size`` zones to twice that.

    Where an edge sets off from rest its travel goes like the square of the time. Rows even in the root of the
    travel follow that, and layers beside the corner far shorter than the zone; in the next zone too, as the
    edge then leaves the fields it set off with. Beyond, a step is a part of the travel, or of what is left of
    the radius. Rows ``2^ahead`` zones ahead of a corner lie as those after it. ``count``: points of Gauss
    between two breaks.
    """
    radius, graded = 2.0**size, (np.arange(1, resolution + 1) / resolution) ** 2
    widest, corner = (SPRUNG if sprung else 1.0) * WIDEST[kind] / resolution, kind == "corner"
    first, rest, far = 1.0 if corner else 2.0, [], [1.0]
    travel = first
    while travel < 2.0 * radius:
        left = max(radius - travel, 0.25 * max(radius, travel))
        travel += widest * min(travel - first + 1.0, left)
        rest.append(travel)
    if not corner:
        breaks = np.array([0, resolution, 2 * resolution])
        return Grid(np.concatenate(([0.0], graded, 1.0 + graded, rest)), breaks, kind, radius, count, sprung)
    while far[-1] < 2.0**ahead:
        far.append(far[-1] * (1.0 + widest))
    g = np.concatenate((-np.array(far[:0:-1]), -graded[::-1], [0.0], graded, rest))
    return Grid(g, np.append(0, len(far) - 1 + resolution * np.arange(3)), kind, radius, count, sprung)
