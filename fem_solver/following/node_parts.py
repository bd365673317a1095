"""The node in contact in part: the mesh knows the mean of its radii, they hold more than it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem_solver.following.components import Components, VariablesOfParts

_LEAST_FREE = 1e-3
"""Share of a node that is free below which its mean does not tell what the free radii have been through: mean
and radii in contact agree to the second order of a step, which is divided by this share."""


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

        Parameters
        ----------
        imposed : float
            ``v`` in contact after the jump.
        share : float
            Of the node, in contact then.

        Returns
        -------
        tuple of ndarray
            ``v`` and ``b`` of the difference.
        """
        before, to = self.share, np.array([imposed])
        (v, b), held = self.free, self.solid.linear(*self.contact, 0.0, to)
        if share > before:
            weight = np.sqrt(before * (share - before) / share)
            return np.zeros(1), weight * (self.solid.linear(v, b, 0.0, to) - held)
        left, released = NodeParts(self.solid, before, self.mean, (to, held)).released
        weight = np.sqrt((1.0 - before) * (before - share) / (1.0 - share))
        return weight * (left - v), weight * (released - b)
