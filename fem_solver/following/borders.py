"""Places where steps began: radii of a node have been through different things, before them and beyond.

A node of the mesh follows the mean of its radii. What they hold beyond it is what one more component holds
that has no profile: in contact its ``v`` is zero, outside it bears no force, and the edge releases and covers
it as it passes the place. It is much where an edge that has rested sets off or jumps by less than a node, and
little where it goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.following.components import Components, VariablesOfParts

Array = NDArray[np.float64]

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
        """At the end of a step, every one released or covered in its own time.

        Parameters
        ----------
        solid : Components
        dt : float
        edge : tuple of float
            Contact radius at the begin and at the end.
        moments : callable(ndarray) -> ndarray
            Shares of the step at which the edge is at radii between.

        Returns
        -------
        borders : NodeBorders
        dissipated, received : float
            Energy dissipated in the branches, and work done on the surface.
        """
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
