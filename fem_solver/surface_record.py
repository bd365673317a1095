"""What the edge has left on the surface, finer than the mesh holds where it is not at present.

Away from the edge a component changes by itself: in contact by the penetration, outside by recovery, and its
intensity, the branch variables over ``L^-1 1``, by the same law at every radius. Points that a fine strip has
seen are thus followed exactly, whatever mesh there is now, and where the edge passes them in a step, the path
of the edge tells when.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fem_solver.components import Components

Array = NDArray[np.float64]
Selection = slice | NDArray[np.bool_] | NDArray[np.intp]

_STRAIGHT = 1e-5
"""Deviation from a line between its neighbours below which a point is dropped, relative to the largest
intensity of the branch: a tenth of what the path of an edge may miss in a step, relative to its radius, so
that an edge that comes back does not have to make steps for points that are gone."""


@dataclass(frozen=True)
class SurfaceRecord:
    """Intensities (branches, m) of the branch variables at radii ``positions``, rising.

    ``profile`` is the penetration at which contact without adhesion ends there; ``edge`` points are in
    contact, the next one is the node that is released in part; ``needed`` were left away from the fine strip
    where it was thinned last, and it is thinned again where there are twice as many.
    """

    positions: Array
    intensity: Array
    profile: Array
    edge: int
    needed: int = 0

    def renewed(self, nodes: SurfaceRecord, fine: slice) -> SurfaceRecord:
        """The record with what the mesh knows where it is fine, thinned elsewhere as far as it can be."""
        inner = self.positions < nodes.positions[fine][0]
        outer = self.positions > nodes.positions[fine][-1]
        within, beyond = slice(fine.start, nodes.edge), slice(nodes.edge, fine.stop)
        left = self._at(inner)._followed_by(nodes._at(within))
        right = nodes._at(beyond)._followed_by(self._at(outer))
        thinned = inner.sum() + outer.sum() > 2 * self.needed
        if thinned:
            left = left._thinned(int(inner.sum()))
            right = right._thinned(int(outer.sum()), -1)
        both = left._followed_by(right)
        away = both.positions.size - nodes.positions[fine].size
        return replace(both, edge=len(left.positions), needed=away if thinned else self.needed)

    def after(
        self,
        solid: Components,
        dt: float,
        way: tuple[float, float, float],
        edge: float,
        moments: Callable[[Array], Array],
        nodes: SurfaceRecord,
    ) -> SurfaceRecord:
        """The record after a step, every point released or covered in its own time, exactly.

        The way is penetration at its begin, change of it, and bend; ``edge`` is where the edge is at the end,
        and ``moments`` tells shares of the step at which it is at radii between.

        A node of a wide element stands for the radii between two positions of the edge, and not evenly: its
        mean is that of another radius, to one side at vertices and to the other between them. Left behind as
        points, nodes would make the surface uneven for an edge that comes back.
        """
        known = self._with_points(nodes, edge)
        x, b, profile = known.positions, known.intensity, known.profile
        begin, change, bend = way
        first, last = begin - profile, begin + change - profile
        before, after = known.edge, int(np.searchsorted(x, edge))
        low, high = sorted((before, after))
        held = solid.modulus.increment(dt).advance(b[:, :low], change, bend)
        free = solid.recovered(b[:, high:], dt)[1]
        share, at_pass = moments(x[low:high]), slice(low, high)
        passed, left = first[at_pass] + share * (change + (share - 1.0) * bend), (1.0 - share) * dt
        if after < before:
            until = solid.linear(first[at_pass], b[:, at_pass], share * dt, passed)
            released = solid.linear(passed, until, 0.0, solid.relieved(passed, until, 0.0))
            changed = solid.recovered(released, left)[1]
        else:
            v, until = solid.recovered(b[:, at_pass], share * dt)
            changed = solid.linear(passed, solid.linear(v, until, 0.0, passed), left, last[at_pass])
        return SurfaceRecord(x, np.hstack([held, changed, free]), profile, after, self.needed)

    def _with_points(self, nodes: SurfaceRecord, edge: float) -> SurfaceRecord:
        """Without the node that is released in part, and with the nodes that the edge passes on its way."""
        within, beyond = self._at(slice(self.edge)), self._at(slice(self.edge + 1, None))
        if beyond.positions.size and edge > beyond.positions[0]:
            beyond = beyond._refined(nodes, beyond.positions[0], edge)
        elif within.positions.size and edge < within.positions[-1]:
            within = within._refined(nodes, edge, within.positions[-1])
        return replace(within._followed_by(beyond), edge=len(within.positions))

    def _refined(self, nodes: SurfaceRecord, low: float, high: float) -> SurfaceRecord:
        """The same points, and the nodes between two radii."""
        x = nodes.positions
        added = nodes._at((x > low) & (x < high) & ~np.isin(x, self.positions))
        intensity = interpolated(self.positions, self.intensity, added.positions)
        both = self._followed_by(replace(added, intensity=intensity))
        return both._at(np.argsort(both.positions))

    def _thinned(self, count: int, sign: int = 1) -> SurfaceRecord:
        """Without those of the first, or with ``sign`` -1 the last, ``count`` points that are not needed."""
        kept = _needed(sign * self.positions[::sign], self.intensity[:, ::sign], count)[::sign]
        return self if kept.all() else self._at(kept)._thinned(count - int(np.count_nonzero(~kept)), sign)

    def _at(self, selection: Selection) -> SurfaceRecord:
        """Some of the points, all on one side of the edge."""
        return SurfaceRecord(
            self.positions[selection], self.intensity[:, selection], self.profile[selection], 0
        )

    def _followed_by(self, other: SurfaceRecord) -> SurfaceRecord:
        """The points of two records, those of this one first."""
        return SurfaceRecord(
            np.concatenate([self.positions, other.positions]),
            np.hstack([self.intensity, other.intensity]),
            np.concatenate([self.profile, other.profile]),
            0,
        )


def interpolated(x: Array, values: Array, at: Array) -> Array:
    """Lines between the points of every row, continued by at most one interval."""
    if x.size < 2:
        return np.repeat(values[:, -1:], len(at), axis=1) if x.size else np.zeros((len(values), len(at)))
    at = np.clip(at, 2.0 * x[0] - x[1], 2.0 * x[-1] - x[-2])
    right = np.clip(np.searchsorted(x, at), 1, len(x) - 1)
    share = (at - x[right - 1]) / (x[right] - x[right - 1])
    return np.asarray((1.0 - share) * values[:, right - 1] + share * values[:, right])


def averaged(x: Array, values: Array, bounds: Array) -> Array:
    """Means of the same lines over adjoining intervals: what a jump adds to a sum over them stays."""
    if x.size < 2:
        return interpolated(x, values, bounds[1:])
    within = np.clip(bounds, x[0], x[-1])
    left = np.clip(np.searchsorted(x, within) - 1, 0, len(x) - 2)
    passed = np.cumsum(0.5 * np.diff(x) * (values[:, 1:] + values[:, :-1]), axis=1)
    total = np.insert(passed, 0, 0.0, axis=1)[:, left]
    total += 0.5 * (within - x[left]) * (values[:, left] + interpolated(x, values, within))
    total += values[:, :1] * np.minimum(bounds - x[0], 0.0) + values[:, -1:] * np.maximum(bounds - x[-1], 0.0)
    width, there = np.diff(bounds), interpolated(x, values, bounds[1:])
    return np.divide(np.diff(total, axis=1), width, out=there, where=width > 0.0)


def _needed(x: Array, values: Array, count: int) -> NDArray[np.bool_]:
    """All points but every second of the first ones, where a line between its neighbours tells it."""
    kept = np.ones(len(x), dtype=bool)
    middle = np.arange(1, min(count, len(x) - 1), 2)
    if not middle.size:
        return kept
    others = np.delete(np.arange(len(x)), middle)
    missed = np.abs(values[:, middle] - interpolated(x[others], values[:, others], x[middle]))
    kept[middle[(missed <= _STRAIGHT * np.abs(values).max(axis=1, keepdims=True)).all(axis=0)]] = False
    return kept
