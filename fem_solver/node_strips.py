"""Nodes in parts side by side: strips that came into contact, or free, at different times.

A node follows the mean of its radii. What is kept of a strip is its depth beyond that mean, with a past of
its own (see ``series_modulus``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.prony import RelaxingField
from fem_solver.series_modulus import SeriesModulus, SeriesStep

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MOST_STRIPS = 8
"""Strips kept of a node on each side of the edge: an edge that swings within a node leaves a few that differ,
one for each turn; those of a steady edge differ little."""
_FADED = 1e-9
"""Energy of the strips of a node, relative to the largest of any, below which they are forgotten."""


@dataclass(frozen=True)
class Strips:
    """Strips of some nodes, node by node, and from the inner to the outer within a node.

    Parameters
    ----------
    nodes : ndarray of int, shape (strips,)
        In ascending order.
    shares : ndarray, shape (strips,)
        Of their node; 1 in sum over a node.
    parts : tuple of RelaxingField
        Of their depth beyond the mean of the node, for each modulus in series.
    """

    nodes: NDArray[np.int64]
    shares: Array
    parts: tuple[RelaxingField, ...]

    @classmethod
    def undeformed(cls, node: int, modulus: SeriesModulus) -> Strips:
        """A node as a single strip."""
        return cls(np.array([node]), np.ones(1), modulus.at_rest())

    @property
    def stresses(self) -> Array:
        """``y/e`` beyond the mean; shape (strips,)."""
        part = self.parts[0]
        return np.asarray(part.modulus.relaxed * part.x + part.branches.sum(axis=0))

    def energies(self, modulus: SeriesModulus) -> Array:
        """Of each strip, per square of ``e``; shape (strips,)."""
        return self.shares * modulus.stored(self.parts)

    def of(self, node: int) -> slice:
        """The strips of a node."""
        return slice(int(self.nodes.searchsorted(node)), int(self.nodes.searchsorted(node + 1)))

    def within(self, node: int, share: float) -> Mask:
        """Which strips lie within a place: in nodes before it, or in the inner share of its node."""
        within, own = self.nodes < node, self.of(node)
        within[own] = np.cumsum(self.shares[own]) - 0.5 * self.shares[own] < share
        return within

    def divided(self, node: int, share: float) -> Strips:
        """The same with a border between two strips at a share of a node, and this node among them."""
        own = self.of(node)
        if own.start == own.stop:
            return self._with_undeformed(own.start, node).divided(node, share)
        ends = np.cumsum(self.shares[own])
        cut = min(int(np.searchsorted(ends, share)), len(ends) - 1)
        inner = share - (ends[cut] - self.shares[own][cut])
        if not 0.0 < inner < self.shares[own][cut]:
            return self
        cut += own.start
        twice = self._with_another(cut)
        twice.shares[cut : cut + 2] = inner, self.shares[cut] - inner
        return twice

    def joined(self, node: int, share: float) -> Strips:
        """The same with at most ``_MOST_STRIPS`` on either side of a border: the two most alike are one."""
        strips = self
        if len(self.shares[self.of(node)]) <= _MOST_STRIPS:
            return self
        for inner in (True, False):
            side = np.flatnonzero((strips.nodes == node) & (strips.within(node, share) == inner))
            if len(side) > _MOST_STRIPS:
                strips = strips._with_joined(strips._most_alike(side))
        return strips

    def after(self, step: SeriesStep, depths: Array) -> Strips:
        """At the end of a step, with these depths; shape (strips,)."""
        return Strips(self.nodes, self.shares, step.advanced(self.parts, depths))

    def bearing(self, energies: Array, node: int) -> Mask:
        """All strips but those of nodes that bear next to nothing any more, other than this one.

        ``energies`` (strips,) are those of :meth:`energies`.
        """
        of_nodes = np.bincount(self.nodes, energies)[self.nodes]
        return (of_nodes > _FADED * of_nodes.max()) | (self.nodes == node)

    def chosen(self, index: NDArray[np.int64] | Mask | slice) -> Strips:
        """Some strips, or some of them twice; copies but for a slice."""
        return Strips(self.nodes[index], self.shares[index], tuple(part.chosen(index) for part in self.parts))

    def _with_another(self, at: int) -> Strips:
        """One more strip, like that in its place, or like the last."""
        index = np.arange(len(self.shares) + 1)
        index[at + 1 :] -= 1
        index[-1] = len(self.shares) - 1
        return self.chosen(index)

    def _with_undeformed(self, at: int, node: int) -> Strips:
        """A node more, as a single strip."""
        more = self._with_another(at)
        more.nodes[at], more.shares[at] = node, 1.0
        for part in more.parts:
            part.x[at] = part.branches[:, at] = 0.0
        return more

    def _most_alike(self, side: NDArray[np.int64]) -> int:
        """The first of the two neighbours that differ least among strips side by side."""
        differences = sum(np.sum(np.diff(part.branches[:, side], axis=1) ** 2, axis=0) for part in self.parts)
        one, next_one = self.shares[side[:-1]], self.shares[side[1:]]
        return int(side[np.argmin(differences * one * next_one / (one + next_one))])

    def _with_joined(self, at: int) -> Strips:
        """One strip in place of a strip and the next."""
        one, next_one = self.shares[at : at + 2]
        weights = np.array([one, next_one]) / (one + next_one)
        kept = self.chosen(np.delete(np.arange(len(self.shares)), at + 1))
        kept.shares[at] = one + next_one
        for part, former in zip(kept.parts, self.parts, strict=True):
            part.x[at] = former.x[at : at + 2] @ weights
            part.branches[:, at] = former.branches[:, at : at + 2] @ weights
        return kept
