"""Travels of the edge that all scenes step through, and what of a step does not depend on the scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.zone import BEHIND, COUNT, SHORTEST, SWEPT, Quadrature, quadrature
from validation.reference.path.numerics import gauss

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Kind = Literal["opening", "closing", "turned"]
"""An edge that opens from rest on what is relaxed, one that closes, and one that opens where it closed."""

WIDEST: dict[Kind, float] = {"opening": 1.2, "closing": 0.6, "turned": 1.2}
"""Longest steps in travels, or in what is left of the radius, times the resolution; where the load turns
slowly an edge that closed by longer ones is not found again."""
BESIDE, FROM = 0.3, 0.2
"""Longest steps of an edge that opens where it closed, and the travel, in the least radius, from which on
they hold: there it comes by the place from which it closed, a corner between two rows."""
ROWS = 6
"""Rows of a polynomial over the travel."""
NEAR = np.array([0.0, 4e-3, 3e-2, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0])
DEEP, DEEPER = 4.0, 0.5
"""Ends of panels of what is left in contact next to the edge. Beyond, a panel is as wide as the larger of
``DEEP`` zones and ``DEEPER`` of its depth, over the resolution: the place from which the edge closed, a
corner, lies in one of them."""
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
    for the edge.
    """

    points: Quadrature
    passed: int
    near: int
    first: int
    old: Array
    new: Array
    guess: Array
    within: Array
    first_depth: int
    behind: Array


class Depths:
    """Depths ``s`` (m,) behind an edge that has come to rest, in zones, and polynomials through values there.

    They lie in panels, in the root of the depth: times of cover may be smooth in that only.
    """

    def __init__(self, deepest: float, resolution: int) -> None:
        ends = [*NEAR]
        while ends[-1] < deepest:
            ends.append(ends[-1] + max(DEEP, DEEPER * ends[-1]) / resolution)
        self.ends = np.sqrt(ends)
        self.width = np.diff(self.ends)[:, None]
        self.s = ((self.ends[:-1, None] + self.width * PLACES) ** 2).ravel()

    def panel(self, s: Array) -> tuple[Whole, Array]:
        """Panels in which depths lie, and weights (m, ROWS) of the values there."""
        root = np.sqrt(s)
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
        """Integrals (m, B) of values (m, B) from the edge to the depths, in zones."""
        panels = values.reshape(len(self.width), ROWS, -1)
        begin, width = 2.0 * self.width * self.ends[:-1, None], 2.0 * self.width**2
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
    steps: dict[int, Travel] = field(default_factory=dict)

    @cached_property
    def depths(self) -> Depths:
        """Of what the edge comes by."""
        return Depths(float(self.g[-1]) + 1.0, int(self.breaks[1]))

    def panels(self, panel: Whole, newest: Whole | int) -> tuple[Whole, Whole]:
        """First row and number of rows of the polynomials in panels, of rows up to ``newest``."""
        after = self.breaks.searchsorted(panel, side="right")
        low = self.breaks[after - 1]
        high = np.minimum(np.append(self.breaks, len(self.g))[after], newest)
        count = np.minimum(ROWS, high - low + 1)
        return np.minimum(np.maximum(panel - (count - 2) // 2, low), high - count + 1), count

    def weights(
        self, at: Array, newest: int, smooth_in: Callable[[Array], Array] = np.asarray
    ) -> tuple[int, Array, Whole]:
        """First row that matters for travels, weights (m, n) of rows from it to the newest, and last rows."""
        first, count = self.panels(np.clip(self.g.searchsorted(at) - 1, 0, newest - 1), newest)
        begin = int(first.min())
        table = np.zeros((len(at), newest + 1 - begin))
        for i in np.unique(count):
            those = np.flatnonzero(count == i)
            rows = first[those, None] + np.arange(i)
            table[those[:, None], rows - begin] = lagrange(smooth_in(self.g[rows]), smooth_in(at[those]))
        return begin, table, first + count - 1

    def step(self, k: int) -> Travel:
        """Made when it is first asked for."""
        if k not in self.steps:
            self.steps[k] = self._made(k)
        return self.steps[k]

    def _made(self, k: int) -> Travel:
        now = self.g[k]
        closing, turned = self.kind == "closing", self.kind == "turned"
        corners = now - self.g[self.breaks]
        if turned and now < 1.0:  # it may set off as a root, and comes by layers that relax
            corners = np.concatenate((corners, now - NEAR, 1.0 - NEAR))
        corners = corners[(corners > 0.0) & (corners < 1.0)]
        points = quadrature(tuple(corners.tolist()), closing, self.count)
        points = points if closing else points.up_to(1.0 / max(self.least - now, SHORTEST))
        passed = now - (1.0 - points.v[:, 0] if closing else points.v[:, 0])
        passed = passed[passed > 0.0]
        behind = 0, np.zeros((0, 0))
        if turned:
            behind = self.depths.weights(now + np.append(1.0 - np.append(BEHIND, points.v), 0.0))
        if k == 0:
            none = np.zeros((0, 0))
            return Travel(points, 0, 0, 0, none, np.zeros((0, 1)), np.zeros(0), none, *behind)
        s = np.asarray if self.kind == "closing" else np.sqrt  # an edge may set off with no speed
        begin, weights, _ = self.weights(passed, k, s)
        low = max(int(self.breaks[self.breaks.searchsorted(k - 1) - 1]), k - ROWS) if k > 1 else 0
        guess = lagrange(s(self.g[None, low:k]), s(np.array([now])))[0]
        old, near = np.ascontiguousarray(weights[:, :-1]), int(weights[:, -1].nonzero()[0].max()) + 1
        rows = np.arange(int(self.panels(np.array([k - 1]), k)[0][0]), k + 1)
        at = self.g[k - 1] + (now - self.g[k - 1]) * SWEPT
        within = lagrange(self.g[rows] + 0.0 * at[:, None], at)
        return Travel(points, len(passed), near, begin, old, weights[:near, -1:], guess, within, *behind)


def lagrange(nodes: Array, at: Array) -> Array:
    """Weights (m, n) of values at nodes (m, n) for places (m,)."""
    weights = np.ones(nodes.shape)
    for i in range(nodes.shape[1]):
        for j in range(nodes.shape[1]):
            if i != j:
                weights[:, i] *= (at - nodes[:, j]) / (nodes[:, i] - nodes[:, j])
    return weights


@lru_cache(maxsize=128)
def grid(resolution: int, size: int, kind: Kind, count: int = COUNT) -> Grid:
    """For radii from ``2^size`` zones to twice that.

    Where an edge sets off from rest its travel goes like the square of the time. Rows even in the root of the
    travel follow that, and layers beside the corner far shorter than the zone; in the next zone too, as the
    edge then leaves the fields it set off with. Beyond, a step is a part of the travel, or of what is left of
    the radius. ``count``: points of Gauss between two breaks.
    """
    radius, graded, rest = 2.0**size, (np.arange(1, resolution + 1) / resolution) ** 2, [2.0]
    while (travel := rest[-1]) < 2.0 * radius:
        left = max(radius - travel, 0.25 * max(radius, travel))
        widest = BESIDE if kind == "turned" and travel > FROM * radius else WIDEST[kind]
        rest.append(travel + widest / resolution * min(travel - 1.0, left))
    breaks = np.array([0, resolution, 2 * resolution])
    return Grid(np.concatenate(([0.0], graded, 1.0 + graded, rest[1:])), breaks, kind, radius, count)
