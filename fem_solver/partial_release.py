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
covers has that past and bears least, and it is what the edge leaves first when it turns: the part in contact
is kept by strips, in the order in which they came into contact, all of the same depth. Were they mixed, an
edge that opens what it has just closed would release their mean. What the edge leaves does not change the
others. The two strips that differ least are joined where there are more than ``_MOST_STRIPS``. The last nodes
that came into full contact keep their strips, too, for an edge that turns just beyond them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fem_solver.prony import Increment, Prony, RelaxingField

Array = NDArray[np.float64]

_MOST_STRIPS = 8
"""Strips kept of a node: an edge that swings within a node leaves a few that differ, one for each turn; those
of a steady edge differ little."""
_NODES_BEHIND = 2
"""Nodes in full contact that keep their strips: an edge that swings over more is resolved by their means."""


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

    def at_rest(self, count: int = 1) -> tuple[RelaxingField, ...]:
        """Undeformed strips."""
        return tuple(RelaxingField.at_rest(modulus, count) for modulus in self.moduli)

    def step(self, dt: float) -> SeriesStep:
        """What a step does to states."""
        steps = tuple(modulus.increment(dt) for modulus in self.moduli)
        softness = sum(part / step.modulus for part, step in zip(self.compliances, steps, strict=True))
        return SeriesStep(self, steps, 1.0 / softness)

    def stored(self, parts: tuple[RelaxingField, ...]) -> Array:
        """Energy of the springs of each strip, per square of ``e``; shape (strips,)."""
        springs = [
            weight
            * (
                part.modulus.relaxed * part.x**2
                + np.sum(part.branches**2 / part.modulus.moduli[:, None], axis=0)
            )
            for weight, part in zip(self.compliances, parts, strict=True)
        ]
        return 0.5 * np.sum(springs, axis=0)


@dataclass(frozen=True)
class SeriesStep:
    """A step of :class:`SeriesModulus`; ``modulus`` is the stress at its end per depth."""

    series: SeriesModulus
    increments: tuple[Increment, ...]
    modulus: float

    def memory_depth(self, parts: tuple[RelaxingField, ...]) -> Array:
        """Depth that would cause, without a past, the stress left at the end at no depth; shape (strips,)."""
        left = self._memories(parts)
        depths = (
            weight * stress / step.modulus
            for weight, stress, step in zip(self.series.compliances, left, self.increments, strict=True)
        )
        return sum(depths, np.zeros(len(parts[0].x)))

    def advanced(self, parts: tuple[RelaxingField, ...], depth: float) -> tuple[RelaxingField, ...]:
        """State of the strips at the end.

        Parameters
        ----------
        parts : tuple of RelaxingField
            State of each modulus at the begin.
        depth : float
            At the end.

        Returns
        -------
        tuple of RelaxingField
        """
        stress = self.modulus * (depth + self.memory_depth(parts))
        reached = (
            (stress - left) / step.modulus
            for left, step in zip(self._memories(parts), self.increments, strict=True)
        )
        return tuple(
            RelaxingField(part.modulus, x, step.advance(part.branches, x - part.x))
            for part, x, step in zip(parts, reached, self.increments, strict=True)
        )

    def _memories(self, parts: tuple[RelaxingField, ...]) -> list[Array]:
        return [
            step.decay @ part.branches - float(step.gain.sum()) * part.x
            for part, step in zip(parts, self.increments, strict=True)
        ]


@dataclass(frozen=True)
class PartlyReleasedNode:
    """The node in contact in part where a step begins, and what it bears at its end.

    Parameters
    ----------
    node : int
    shares : list of float
        Of it in contact at the begin, in the order in which they came into contact.
    beyond : list of float
        ``y`` of each strip beyond that of the whole node, if that came into contact, per modulus.
    """

    node: int
    shares: list[float]
    beyond: list[float]

    def bearing(self, share: float, whole: float) -> float:
        """``y`` of the node per modulus, with a share of it in contact at the end; ``whole`` in full contact.

        What the edge leaves bears nothing, the last strip first; what it covers bears what the free part
        would in contact.
        """
        held, covered = 0.0, share
        for strip, beyond in zip(self.shares, self.beyond, strict=True):
            held += min(strip, covered) * beyond
            if covered <= strip:
                return share * whole + held
            covered -= strip
        return share * whole + (1.0 - covered / (1.0 - share + covered)) * held


@dataclass(frozen=True)
class PartialContact:
    """The node next to an adhesive edge at the end of a step.

    Parameters
    ----------
    node : int
    share : float
        Of it, in contact; below 1 next to the edge.
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
    shares : ndarray, shape (strips,)
        Of the node, in the order in which they came into contact; their sum is that in contact.
    parts : tuple of RelaxingField
        Of the depth of the strips, beyond the mean of the node.
    behind : tuple of PartlyHeld
        The last nodes that came into full contact, the latest first.
    """

    contact: PartialContact
    modulus: SeriesModulus
    shares: Array
    parts: tuple[RelaxingField, ...]
    behind: tuple[PartlyHeld, ...] = ()

    @property
    def stresses(self) -> Array:
        """``y/e`` of the strips, beyond the mean; shape (strips,)."""
        part = self.parts[0]
        return np.asarray(part.modulus.relaxed * part.x + part.branches.sum(axis=0))

    @property
    def stress(self) -> float:
        """``y/e`` of the part in contact, beyond the mean."""
        share = self.contact.share
        return float(self.shares @ self.stresses) / share if share > 0.0 else float(self.stresses[-1])

    @property
    def stored(self) -> float:
        """Energy that the parts in contact and free hold beyond that of their mean, per square of ``e``."""
        held = float(self.shares @ self.modulus.stored(self.parts))
        if self.contact.share == 1.0:
            return held
        return held + (1.0 - self.contact.share) * float(self.modulus.stored(self.free)[0])

    @property
    def free(self) -> tuple[RelaxingField, ...]:
        """The part that is free, on the other side of the mean."""
        odds = -self.shares / (1.0 - self.contact.share)
        return tuple(part.combined(odds[:, None]) for part in self.parts)

    def released(self, dt: float, unit: Array) -> tuple[PartlyReleasedNode, ...]:
        """The node and those behind it in a step; ``unit`` (n,) is ``e`` of the surface then."""
        step, released = self.modulus.step(dt), []
        for one in (self, *self.behind):
            beyond = float(unit[one.contact.node]) * step.memory_depth(one.parts)
            released.append(PartlyReleasedNode(one.contact.node, one.shares.tolist(), beyond.tolist()))
        return tuple(released)

    def followed(self, step: SeriesStep, contact: PartialContact) -> PartlyHeld:
        """The same node at the end of a step, without those behind it."""
        shares, parts = self.turned_to(contact.share)
        return PartlyHeld(contact, self.modulus, shares, step.advanced(parts, contact.depth))

    def turned_to(self, share: float) -> tuple[Array, tuple[RelaxingField, ...]]:
        """The strips where this share of the node comes into contact, with what they have been through."""
        if share == self.contact.share:
            return self.shares, self.parts
        if share > self.contact.share:
            shares = np.append(self.shares, share - self.contact.share)
            return joined(shares, tuple(a.beside(b) for a, b in zip(self.parts, self.free, strict=True)))
        begin = np.cumsum(self.shares) - self.shares
        left = max(int(np.searchsorted(begin, share)), 1)
        shares = self.shares[:left].copy()
        shares[-1] = share - begin[left - 1]
        return shares, tuple(part.combined(np.eye(len(begin), left)) for part in self.parts)


def joined(shares: Array, parts: tuple[RelaxingField, ...]) -> tuple[Array, tuple[RelaxingField, ...]]:
    """At most ``_MOST_STRIPS`` strips, the first of some share: the neighbours that differ least are joined.

    Parameters
    ----------
    shares : ndarray, shape (strips,)
    parts : tuple of RelaxingField

    Returns
    -------
    shares : ndarray, shape (fewer,)
    parts : tuple of RelaxingField
    """
    if shares[0] == 0.0:
        parts, shares = tuple(part.combined(np.eye(len(shares), k=-1)[:, :-1]) for part in parts), shares[1:]
    while len(shares) > _MOST_STRIPS:
        differences = sum(np.sum(np.diff(part.branches, axis=1) ** 2, axis=0) for part in parts)
        at = int(np.argmin(differences * shares[1:] * shares[:-1] / (shares[1:] + shares[:-1])))
        pair = shares[at] + shares[at + 1]
        means = np.delete(np.eye(len(shares)), at + 1, axis=1)
        means[at : at + 2, at] = shares[at : at + 2] / pair
        parts = tuple(part.combined(means) for part in parts)
        shares = np.concatenate([shares[:at], [pair], shares[at + 2 :]])
    return shares, parts


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
    known = {} if before is None else {one.contact.node: one for one in (before, *before.behind)}
    own = known.get(contact.node) or PartlyHeld(
        contact, modulus, np.array([contact.share]), modulus.at_rest()
    )
    step = modulus.step(dt)
    behind = tuple(
        known[node].followed(step, PartialContact(node, 1.0, 0.0))
        for node in range(contact.node - 1, contact.node - 1 - _NODES_BEHIND, -1)
        if node in known
    )
    return replace(own.followed(step, contact), behind=behind)


def energy_at_edge(partly: PartlyHeld | None, unit: Array, forces: Array, gap: Array) -> float:
    """Energy of the node next to the edge, and of those behind it, beyond that of their means.

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
    return sum(float(unit[one.contact.node] ** 2 * one.stored) for one in (partly, *partly.behind))
