"""What the surface remembers: internal variables on nodes that stay where they are.

Each side of the edge keeps the variables that are smooth there: scaled Maxwell stresses inside, where ``v`` has
no singularity, and scaled Voigt strains outside, which do not carry the square root that ``v`` has at the edge.
Nodes are laid where the edge goes, graded towards it, and taken out again where a straight line through
their neighbours says the same to the stated tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Track:
    """Nodes at ``radius`` (n,), rising, and their internal variables ``state`` (n, K).

    ``tip`` is the edge from which the root of the distance is the coordinate of interpolation: outside an edge
    that has lingered, the strains have its square root. ``None``: the radius itself.
    """

    radius: Array
    state: Array
    tip: float | None = None

    def coordinate(self, radius: Array) -> Array:
        """The variable in which the state is smooth."""
        return radius if self.tip is None else np.sqrt(np.maximum(radius - self.tip, 0.0))

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """Coordinates (n,) and derivatives (n, K) there: of the parabola through neighbouring nodes."""
        at = self.coordinate(self.radius)
        gap = np.diff(at)[:, None]
        secant = np.diff(self.state, axis=0) / gap
        if len(gap) < 2:
            return at, np.repeat(secant, 2, axis=0)
        left, right = gap[:-1], gap[1:]
        middle = (secant[:-1] * right + secant[1:] * left) / (left + right)
        first, last = 2.0 * secant[:1] - middle[:1], 2.0 * secant[-1:] - middle[-1:]
        return at, np.concatenate((first, middle, last))

    def at(self, radius: Array) -> Array:
        """Variables (m, K) at any radii (m,), by cubics through values and slopes; constant beyond the ends."""
        if len(self.radius) == 0:
            return np.zeros((len(radius), self.state.shape[1]))
        if len(self.radius) == 1:
            return np.repeat(self.state, len(radius), axis=0)
        nodes, slope = self._nodes
        x = self.coordinate(radius)
        right = np.clip(np.searchsorted(nodes, x), 1, len(nodes) - 1)
        left = right - 1
        x0 = nodes[left]
        width = nodes[right] - x0
        z = np.clip((x - x0) / width, 0.0, 1.0)
        up = z * z * (3.0 - 2.0 * z)
        in_slope, out_slope = width * z * (1.0 - z) ** 2, width * z * z * (z - 1.0)
        y0 = self.state[left]
        return (
            y0
            + up[:, None] * (self.state[right] - y0)
            + in_slope[:, None] * slope[left]
            + out_slope[:, None] * slope[right]
        )

    def thinned(self, tolerance: float, spacing: Array, parity: int) -> Track:
        """Without every second node that its neighbours reproduce; both ends stay.

        Parameters
        ----------
        tolerance : float
            Largest change of any variable, in their own unit.
        spacing : ndarray (n,)
            Largest distance allowed between neighbours.
        parity : int
            0 or 1: which nodes are looked at.
        """
        i = np.arange(1 + parity, len(self.radius) - 1, 2)
        if len(i) == 0:
            return self
        at = self.coordinate(self.radius)
        x0, x, x1 = at[i - 1], at[i], at[i + 1]
        share = ((x - x0) / (x1 - x0))[:, None]
        change = np.abs(self.state[i - 1] * (1 - share) + self.state[i + 1] * share - self.state[i]).max(
            axis=1
        )
        keep = np.ones(len(self.radius), bool)
        keep[i[(change <= tolerance) & (self.radius[i + 1] - self.radius[i - 1] <= spacing[i])]] = False
        return Track(self.radius[keep], self.state[keep], self.tip)


@dataclass(frozen=True)
class History:
    """Scaled Maxwell stresses up to the edge, scaled Voigt strains from the edge on."""

    inner: Track
    outer: Track

    @property
    def radius(self) -> Array:
        """All nodes, rising, the edge once."""
        return np.union1d(self.inner.radius, self.outer.radius)

    @classmethod
    def blank(cls, branches: int) -> History:
        """Nothing has happened yet."""
        nothing = Track(np.empty(0), np.empty((0, branches)))
        return cls(nothing, nothing)


def distinct(radius: Array, edge: float, smallest: float) -> Array:
    """Sorted radii at least ``smallest`` apart, the edge among them.

    Slopes between closer nodes would mean nothing, and feed back.
    """
    merged = np.unique(radius)
    merged = merged[(np.abs(merged - edge) >= smallest) | (merged == edge)]
    keep = np.ones(len(merged), bool)
    close = np.flatnonzero(np.diff(merged) < smallest)
    # of a close pair the outer goes, unless it is the edge; runs of close nodes lose every second
    for index in close:
        if keep[index]:
            keep[index if merged[index + 1] == edge else index + 1] = False
    return merged[keep]


def graded_nodes(annuli_radii: Array, edge: float, reach: float) -> Array:
    """Collocation radii within ``reach`` inside the edge, their mirror images outside, and the edge."""
    inside = edge * annuli_radii
    inside = inside[inside >= edge - reach]
    return np.concatenate((inside, [edge], 2.0 * edge - inside))


def gaps_to_halve(radius: Array, spacing: Array) -> Array:
    """Mid-points of the intervals that are longer than ``spacing`` (n - 1,) allows."""
    wide = np.diff(radius) > spacing
    return 0.5 * (radius[1:] + radius[:-1])[wide]
