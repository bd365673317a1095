"""The node next to the edge, in contact in part: what the radii in contact have been through.

Part of the radii that belong to the node are in contact, the others are free, and the node follows their
mean. The former follow the indenter, while the mean of a relaxed state lies between. An instant later the
half-space answers with its glassy modulus, so the force that the *mean* would have in full contact is not
that of the part in contact: shared by it, the force of the node would change with the length of the step
alone, by up to the ratio of the two moduli.

What is kept is the depth of the part in contact beyond the mean, with a history of its own. In the components
``v = L^-1 u``, ``y = L^T f`` of the surface (see ``surface``) the depth is ``v/e``, ``e = L^-1 1``; the
half-space answers to it with the one modulus that a frictionless surface knows, ``1/E* = 1/(4 G) +
3/(4 (3 K + G))``, so ``y/e`` follows it as two moduli in series do; as one, ``G``, where all relax alike.

With a share s in contact the others lie ``s/(1 - s)`` as far on the other side of the mean. What the edge
covers adds free radii to those in contact: the past of their difference then shrinks by the ratio of
``s/(1 - s)`` before and after. What it leaves does not change the others.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.prony import Prony, RelaxingField

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SeriesModulus:
    """Moduli that bear the same stress ``y``: the depth is ``sum_j compliance_j x_j`` with ``m_j * x_j = y``.

    Parameters
    ----------
    moduli : tuple of Prony
    compliances : tuple of float
        Dimensionless weights of their strains.
    """

    moduli: tuple[Prony, ...]
    compliances: tuple[float, ...] = (1.0,)

    def at_rest(self) -> tuple[RelaxingField, ...]:
        """Undeformed."""
        return tuple(RelaxingField.at_rest(modulus, 1) for modulus in self.moduli)

    def modulus(self, dt: float) -> float:
        """Stress at the end of a step per depth."""
        steps = (modulus.increment(dt).modulus for modulus in self.moduli)
        return 1.0 / sum(part / step for part, step in zip(self.compliances, steps, strict=True))

    def memory_depth(self, dt: float, parts: tuple[RelaxingField, ...]) -> float:
        """Depth that would cause, without a past, the stress left at the end of a step at no depth."""
        left = (float(part.memory(dt)[0]) / part.modulus.increment(dt).modulus for part in parts)
        return sum(weight * depth for weight, depth in zip(self.compliances, left, strict=True))

    def advanced(
        self, dt: float, parts: tuple[RelaxingField, ...], depth: float
    ) -> tuple[RelaxingField, ...]:
        """State at the end of a step that ends at a depth.

        Parameters
        ----------
        dt : float
            Length of the step.
        parts : tuple of RelaxingField
            State of each modulus at its begin.
        depth : float

        Returns
        -------
        tuple of RelaxingField
        """
        stress = self.modulus(dt) * (depth + self.memory_depth(dt, parts))
        return tuple(
            part.advanced(dt, (stress - part.memory(dt)) / part.modulus.increment(dt).modulus)
            for part in parts
        )

    def stored(self, parts: tuple[RelaxingField, ...]) -> float:
        """Energy of the springs, per square of ``e``."""
        springs = (
            part.modulus.relaxed * part.x[0] ** 2
            + float(np.sum(part.branches[:, 0] ** 2 / part.modulus.moduli))
            for part in parts
        )
        return 0.5 * sum(weight * spring for weight, spring in zip(self.compliances, springs, strict=True))


@dataclass(frozen=True)
class PartlyReleasedNode:
    """The node in contact in part where a step begins, and what it bears at its end.

    Parameters
    ----------
    node : int
    before : float
        Share of it in contact at the begin, below 1.
    beyond : float
        ``y`` of the part in contact beyond that of the whole node, if that came into contact, per modulus.
    """

    node: int
    before: float
    beyond: float

    def bearing(self, share: float, whole: float) -> float:
        """``y`` of the node per modulus, with a share of it in contact at the end; ``whole`` in full contact.

        What the edge leaves bears nothing; what it covers bears what the free part would in contact.
        """
        held = whole + self.beyond
        if share <= self.before:
            return share * held
        covered = (share - self.before) / (1.0 - self.before)
        return (1.0 - covered) * self.before * held + covered * whole


@dataclass(frozen=True)
class PartialContact:
    """The node next to an adhesive edge at the end of a step.

    Parameters
    ----------
    node : int
    share : float
        Of it, in contact; below 1.
    depth : float
        Of the part in contact, beyond the mean.
    """

    node: int
    share: float
    depth: float


@dataclass(frozen=True)
class PartlyHeld:
    """The node next to an adhesive edge in an accepted state, and the past of its part in contact.

    Parameters
    ----------
    contact : PartialContact
    modulus : SeriesModulus
    parts : tuple of RelaxingField
        Of the depth of the part in contact, beyond the mean.
    """

    contact: PartialContact
    modulus: SeriesModulus
    parts: tuple[RelaxingField, ...]

    @property
    def odds(self) -> float:
        """Share in contact per share that is free."""
        return self.contact.share / (1.0 - self.contact.share)

    @property
    def stress(self) -> float:
        """``y/e`` of the part in contact, beyond the mean."""
        part = self.parts[0]
        return float(part.modulus.relaxed * part.x[0] + part.branches.sum())

    @property
    def stored(self) -> float:
        """Energy that the parts in contact and free hold beyond that of their mean, per square of ``e``."""
        return self.odds * self.modulus.stored(self.parts)

    def released(self, dt: float, unit: Array) -> PartlyReleasedNode:
        """The node in a step; ``unit`` (n,) is ``e`` of the surface then."""
        beyond = float(unit[self.contact.node]) * self.modulus.memory_depth(dt, self.parts)
        return PartlyReleasedNode(self.contact.node, self.contact.share, beyond)


def partly_held(
    before: PartlyHeld | None, modulus: SeriesModulus, dt: float, contact: PartialContact | None
) -> PartlyHeld | None:
    """The node next to an adhesive edge at the end of a step.

    Parameters
    ----------
    before : PartlyHeld or None
        At its begin.
    modulus : SeriesModulus
    dt : float
        Length of the step.
    contact : PartialContact or None
        At its end.

    Returns
    -------
    PartlyHeld or None
    """
    if contact is None:
        return None
    parts = modulus.at_rest()
    if before is not None and before.contact.node == contact.node:
        parts = before.parts
        if contact.share > before.contact.share:
            free = (1.0 - contact.share) / contact.share
            parts = tuple(part.scaled(before.odds * free) for part in parts)
    return PartlyHeld(contact, modulus, modulus.advanced(dt, parts, contact.depth))


def energy_at_edge(partly: PartlyHeld | None, unit: Array, forces: Array, gap: Array) -> float:
    """Energy of the node next to the edge beyond that of its mean.

    Parameters
    ----------
    partly : PartlyHeld or None
    unit : ndarray, shape (n,)
        ``e`` of the glassy surface.
    forces, gap : ndarray, shape (n,)
        Nodal forces and openings: without a history of its parts the interface holds the node as a spring.

    Returns
    -------
    float
    """
    if partly is None:
        return -0.5 * float(forces @ gap)
    return float(unit[partly.contact.node] ** 2 * partly.stored)
