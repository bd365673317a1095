"""What the radii of a node have been through, of which the mesh knows the mean.

A node in contact in part is kept by strips, in the order of their radii (:class:`NodeStrips`). Of the nodes
that the edge has left, what radii hold beyond the mean is kept as an energy: that of one more component
without a profile, at the place where a step began (:class:`NodeBorders`). In contact its ``v`` is zero,
outside it bears no force, and the edge releases and covers it as it passes the place. It is much where an
edge that has rested sets off or jumps by less than a node, and little where it goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.components import Components, VariablesOfParts

Array = NDArray[np.float64]

_MOST_STRIPS = 16
"""Strips kept of a node: an edge that swings within it leaves one in each step, and a few that differ."""
_LEAST_FREE = 1e-3
"""Share of a node that is free below which its mean does not tell what the free radii have been through: mean
and radii in contact agree to the second order of a step, which is divided by this share."""


@dataclass(frozen=True)
class NodeStrips:
    """Strips of the node in contact in part, from the inner to the outer, each with a past of its own.

    What an edge has left last it covers first, and what it has covered last it leaves first.

    Parameters
    ----------
    shares : ndarray, shape (strips,)
        Of the node; 1 in sum.
    b : ndarray, shape (branches, strips)
    turned : bool
        Whether the edge has begun to recede within the node, where the fields jump.
    """

    shares: Array
    b: Array
    turned: bool = False

    @classmethod
    def two(cls, share: float, held: Array, free: Array, turned: bool) -> NodeStrips:
        """A part in contact, and one free; ``held`` and ``free`` have shape (branches,)."""
        return cls(np.array([share, 1.0 - share]), np.stack([held, free], axis=1), turned)

    def within(self, low: float, high: float) -> tuple[Array, Array]:
        """Shares (k,) and branch variables (branches, k) of the strips between two shares of the node."""
        ends = np.cumsum(self.shares)
        shares = np.minimum(ends, high) - np.maximum(ends - self.shares, low)
        kept = shares > 0.0
        return shares[kept], self.b[:, kept]

    def mean(self, low: float, high: float) -> Array:
        """Mean of the branch variables between two shares of the node; shape (branches,)."""
        shares, b = self.within(low, high)
        if shares.size:
            return np.asarray(b @ shares / shares.sum())
        at = int(np.searchsorted(np.cumsum(self.shares), low, side="right"))
        return self.b[:, min(at, len(self.shares) - 1)]

    def few(self) -> NodeStrips:
        """The two neighbours most alike as one, where there are too many."""
        if self.shares.size <= _MOST_STRIPS:
            return self
        one, other = self.shares[:-1], self.shares[1:]
        weights = one * other / (one + other)
        at = int(np.argmin(weights * np.sum(np.diff(self.b, axis=1) ** 2, axis=0)))
        joined = self.b[:, at : at + 2] @ self.shares[at : at + 2] / self.shares[at : at + 2].sum()
        b = np.delete(self.b, at + 1, axis=1)
        b[:, at] = joined
        return NodeStrips(np.concatenate([one[:at], [one[at] + other[at]], other[at + 1 :]]), b, self.turned)


@dataclass(frozen=True)
class LeftStrips:
    """Strips of the nodes within which the edge has begun to recede, and that it has left, all free.

    What the closure sees of such a node are its radii within the zone, and where the edge turned they jump.

    Parameters
    ----------
    nodes, shares : ndarray, shape (strips,)
    b : ndarray, shape (branches, strips)
    """

    nodes: Array
    shares: Array
    b: Array

    @classmethod
    def none(cls, branches: int) -> LeftStrips:
        """No node so far."""
        return cls(np.zeros(0, dtype=int), np.zeros(0), np.zeros((branches, 0)))

    def within(self, first: int, last: int) -> LeftStrips:
        """Those of the nodes ``first..last``."""
        kept = (self.nodes >= first) & (self.nodes <= last)
        return LeftStrips(self.nodes[kept], self.shares[kept], self.b[:, kept])

    def of(self, node: int) -> NodeStrips | None:
        """Those of one node, if the edge turned there."""
        own = self.nodes == node
        return NodeStrips(self.shares[own], self.b[:, own]) if own.any() else None

    def and_of(self, node: int, strips: NodeStrips) -> LeftStrips:
        """With those of one more node."""
        nodes = np.append(self.nodes, np.full(len(strips.shares), node))
        return LeftStrips(nodes, np.append(self.shares, strips.shares), np.hstack([self.b, strips.b]))


@dataclass(frozen=True)
class NodeParts:
    """A node in contact in part; each pair is ``v`` of shape (1,) and ``b`` of shape (branches, 1).

    Parameters
    ----------
    solid : Components
    share : float
        Of it, in contact; below 1.
    mean, contact : tuple of ndarray
        Of all its radii, and of those in contact.
    """

    solid: Components
    share: float
    mean: VariablesOfParts
    contact: VariablesOfParts

    @property
    def free_known(self) -> bool:
        """Whether the mean tells what the free radii have been through."""
        return 1.0 - self.share >= _LEAST_FREE

    @property
    def free(self) -> VariablesOfParts:
        """The free radii; where they are too few for the mean to tell, radii that are released now."""
        if not self.free_known:
            return self.released
        (v, b), (imposed, held) = self.mean, self.contact
        return (v - self.share * imposed) / (1.0 - self.share), (b - self.share * held) / (1.0 - self.share)

    @property
    def released(self) -> VariablesOfParts:
        """Radii in contact right after their release."""
        v = self.solid.relieved(*self.contact, 0.0)
        return v, self.solid.linear(*self.contact, 0.0, v)

    @property
    def energy_beyond_mean(self) -> float:
        """What the radii in contact and the free ones hold beyond their mean."""
        if self.share == 0.0:
            return 0.0
        (v, b), (imposed, held) = self.free, self.contact
        apart = self.solid.stored(imposed - v, held - b)
        return self.share * (1.0 - self.share) * float(apart[0])

    def jumped(self, imposed: float, share: float) -> VariablesOfParts:
        """What a load jump leaves beyond the means of the radii in contact, or of the free ones.

        Those on both sides of the place where the edge was have jumped from different states. With shares s
        and t of the node they hold, beyond their mean, what ``sqrt(s t/(s + t))`` of their difference holds.
        """
        before, to = self.share, np.array([imposed])
        (v, b), held = self.free, self.solid.linear(*self.contact, 0.0, to)
        if share > before:
            weight = np.sqrt(before * (share - before) / share)
            return np.zeros(1), weight * (self.solid.linear(v, b, 0.0, to) - held)
        left, released = NodeParts(self.solid, before, self.mean, (to, held)).released
        weight = np.sqrt((1.0 - before) * (before - share) / (1.0 - share))
        return weight * (left - v), weight * (released - b)


_MOST = 64
"""Borders that are kept: an edge that has rested, or jumped, leaves a few that hold much, one that goes on
leaves one in each step. The energy of those that hold least counts as dissipated."""


@dataclass(frozen=True)
class NodeBorders:
    """What radii hold beyond the means of their nodes, each at the contact radius at which a step began.

    Parameters
    ----------
    radii, v : ndarray, shape (m,)
    b : ndarray, shape (branches, m)
    """

    radii: Array
    v: Array
    b: Array

    @classmethod
    def none(cls, branches: int) -> NodeBorders:
        """No step so far."""
        return cls(np.zeros(0), np.zeros(0), np.zeros((branches, 0)))

    def stored(self, solid: Components) -> float:
        """Energy of the springs."""
        return float(np.sum(solid.stored(self.v, self.b)))

    def with_border(self, radius: float, difference: VariablesOfParts) -> NodeBorders:
        """One more."""
        v, b = difference
        return NodeBorders(np.append(self.radii, radius), np.append(self.v, v), np.hstack([self.b, b]))

    def most_energetic(self, solid: Components) -> NodeBorders:
        """Without those that hold least, where there are too many."""
        if self.radii.size <= _MOST:
            return self
        kept = np.sort(np.argsort(solid.stored(self.v, self.b))[-_MOST:])
        return NodeBorders(self.radii[kept], self.v[kept], self.b[:, kept])

    def after(
        self, solid: Components, dt: float, edge: tuple[float, float], moments: Callable[[Array], Array]
    ) -> tuple[NodeBorders, float, float]:
        """At the end of a step, every one released or covered in its own time."""
        if not self.radii.size:
            return self, 0.0, 0.0
        held, holds = (self.radii < radius for radius in edge)
        share = np.where(held == holds, 1.0, moments(self.radii))
        until = self._relaxed(solid, held, share * dt)
        passed = until._passed(solid, holds)
        last = passed._relaxed(solid, holds, (1.0 - share) * dt)
        before, reached, left, after = (one.stored(solid) for one in (self, until, passed, last))
        return last, before - reached + left - after, left - reached

    def _relaxed(self, solid: Components, held: NDArray[np.bool_], time: Array) -> NodeBorders:
        """After times in contact, or without force."""
        v, b = solid.recovered(self.b, time)
        within = solid.linear(self.v, self.b, time, self.v)
        return NodeBorders(self.radii, np.where(held, self.v, v), np.where(held, within, b))

    def _passed(self, solid: Components, holds: NDArray[np.bool_]) -> NodeBorders:
        """Covered and released: what the edge has not passed stays."""
        v = np.where(holds, 0.0, solid.relieved(self.v, self.b, 0.0))
        return NodeBorders(self.radii, v, solid.linear(self.v, self.b, 0.0, v))
