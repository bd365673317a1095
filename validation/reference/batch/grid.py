"""Travels of the edge that all scenes step through, and what of a step does not depend on the scene."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from validation.reference.batch.zone import SWEPT, Quadrature, quadrature

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Kind = Literal["opening", "closing", "sharp", "smooth"]
"""An edge that opens from rest on what is relaxed, one that closes, and two that open after a turn."""

WIDEST = 1.2
"""Steps of a grid in travels or radii, times the resolution."""
ROWS = 5
"""Rows of a polynomial over the travel."""


@dataclass(frozen=True)
class Travel:
    """A step of the grid: points, and how they and the first guess follow from the rows before."""

    points: Quadrature
    passed: int
    first: int
    old: Array
    new: Array
    guess: Array
    within: Array


@dataclass
class Grid:
    """Travels ``g``, and the rows ``breaks`` at which the path has corners."""

    g: Array
    breaks: Whole
    kind: Kind
    steps: dict[int, Travel] = field(default_factory=dict)

    def panels(self, panel: Whole, newest: Whole | int) -> tuple[Whole, Whole]:
        """First row and number of rows of the polynomials in panels, of rows up to ``newest``."""
        after = self.breaks.searchsorted(panel, side="right")
        low = self.breaks[after - 1]
        high = np.minimum(np.append(self.breaks, len(self.g))[after], newest)
        count = np.minimum(ROWS, high - low + 1)
        return np.minimum(np.maximum(panel - (count - 2) // 2, low), high - count + 1), count

    def step(self, k: int) -> Travel:
        """Made when it is first asked for."""
        if k not in self.steps:
            self.steps[k] = self._made(k)
        return self.steps[k]

    def _made(self, k: int) -> Travel:
        now = self.g[k]
        corners = now - self.g[self.breaks]
        corners = corners[(corners > 0.0) & (corners < 1.0)]
        closing, turned = self.kind == "closing", self.kind in ("sharp", "smooth")
        points = quadrature(tuple(corners.tolist()), closing, turned and now < 1.0)
        passed = now - (1.0 - points.v[:, 0] if closing else points.v[:, 0])
        passed = passed[passed > 0.0]
        if k == 0:
            return Travel(points, 0, 0, np.zeros((0, 0)), np.zeros((0, 1)), np.zeros(0), np.zeros((0, 0)))
        s = np.sqrt if self.kind == "smooth" else np.asarray  # a turn may be smooth in time
        panel = np.minimum(self.g.searchsorted(passed) - 1, k - 1)
        first, count = self.panels(panel, k)
        begin = int(first.min())
        weights = np.zeros((len(passed), k + 1 - begin))
        for i in np.unique(count):
            those = np.flatnonzero(count == i)
            rows = first[those, None] + np.arange(i)
            weights[those[:, None], rows - begin] = lagrange(s(self.g[rows]), s(passed[those]))
        low = max(int(self.breaks[self.breaks.searchsorted(k - 1) - 1]), k - ROWS) if k > 1 else 0
        guess = lagrange(s(self.g[None, low:k]), s(np.array([now])))[0]
        old, new = np.ascontiguousarray(weights[:, :-1]), weights[:, -1:]
        rows = np.arange(int(self.panels(np.array([k - 1]), k)[0][0]), k + 1)
        at = self.g[k - 1] + (now - self.g[k - 1]) * SWEPT
        within = lagrange(self.g[rows] + 0.0 * at[:, None], at)
        return Travel(points, len(passed), begin, old, new, guess, within)


def lagrange(nodes: Array, at: Array) -> Array:
    """Weights (m, n) of values at nodes (m, n) for places (m,)."""
    weights = np.ones(nodes.shape)
    for i in range(nodes.shape[1]):
        for j in range(nodes.shape[1]):
            if i != j:
                weights[:, i] *= (at - nodes[:, j]) / (nodes[:, i] - nodes[:, j])
    return weights


@lru_cache(maxsize=128)
def grid(resolution: int, size: int, kind: Kind) -> Grid:
    """For radii from ``2^(size/2)`` zones to 1.4 times that.

    A corner is followed by a quarter of a ``resolution``-th of a zone, and steps that grow by a ratio to such
    a part of the travel, or of what is left of the radius.
    """
    least, ratio, radius = 0.25 / resolution, 1.0 + 1.6 / resolution, 2.0 ** (0.5 * size)
    g, breaks = [np.zeros(1)], [0]
    for begin in (0.0, 1.0):
        steps = np.minimum(least * ratio ** np.arange(8 * resolution), 0.25)
        ends = steps.cumsum()
        last = int(ends.searchsorted(1.0)) + 1
        g.append(begin + ends[:last] / ends[last - 1])
        breaks.append(breaks[-1] + last)
    travel, step, rest = 2.0, 2.0 * least, []
    while travel < math.sqrt(2.0) * radius:
        travel += step
        rest.append(travel)
        step = min(step * ratio, WIDEST / resolution * min(travel, max(radius - travel, 0.25 * radius)))
    return Grid(np.concatenate((*g, rest)), np.array(breaks), kind)
