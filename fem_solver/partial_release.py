"""The node next to the edge, in contact in part, and what its radii and those of other nodes went through.

Part of the radii that belong to the node are in contact, the others are free, and the node follows their
mean. The former follow the indenter, while the mean of a relaxed state lies between. An instant later the
half-space answers with its glassy modulus, so the force that the *mean* would have in full contact is not
that of the part in contact: shared by it, the force of the node would change with the length of the step
alone, by up to the ratio of the two moduli.

What is kept is the depth of the part in contact beyond the mean, with a history of its own. With a share s in
contact the others lie ``s/(1 - s)`` as far on the other side of the mean. What the edge covers has that past
and bears least, and it is what the edge leaves first when it turns: the node is kept by strips, in the order
of their radii. Were they mixed, an edge that opens what it has just closed would release their mean. What the
edge leaves does not change the others.

A node that the edge has passed keeps its strips until they have faded: in contact they have the depth of
their mean, free they bear nothing. Where the edge of a relaxed contact moves on, what it bore stays as a
place of stress, with a per cent of the energy that a small swing stores, and the edge meets it on its way
back.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fem_solver.node_strips import Strips
from fem_solver.series_modulus import SeriesModulus, SeriesStep

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StripsInStep:
    """The strips where a step begins, and what they bear at its end.

    Parameters
    ----------
    strips : Strips
    beyond : ndarray, shape (strips,)
        ``y`` of each strip beyond that of the whole node, if that came into contact, per modulus.
    looked_up : dict
        Shares and ``beyond`` of the strips of nodes that were asked for.
    """

    strips: Strips
    beyond: Array
    looked_up: dict[int, list[tuple[float, float]]] = field(default_factory=dict)

    def bearing(self, node: int, share: float, whole: float) -> float:
        """``y`` of a node per modulus, in contact in part at the end.

        The strips that the edge leaves bear nothing; those that it covers bear what they would in contact.

        Parameters
        ----------
        node : int
        share : float
            Of it, in contact at the end.
        whole : float
            ``y`` per modulus in full contact, if all of it had the past of the mean.

        Returns
        -------
        float
        """
        if node not in self.looked_up:
            own = self.strips.of(node)
            pairs = zip(self.strips.shares[own].tolist(), self.beyond[own].tolist(), strict=True)
            self.looked_up[node] = list(pairs)
        beyond, left = 0.0, share
        for strip, one in self.looked_up[node]:
            beyond += min(strip, left) * one
            left -= strip
            if left <= 0.0:
                break
        return share * whole + beyond


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
    """The node next to an adhesive edge in an accepted state, with the strips of all nodes that have some.

    Parameters
    ----------
    contact : PartialContact
    modulus : SeriesModulus
    strips : Strips
    energies : ndarray, shape (strips,)
        Of each strip, per square of ``e``.
    """

    contact: PartialContact
    modulus: SeriesModulus
    strips: Strips
    energies: Array

    def stresses_of_tip(self, modulus: float) -> tuple[float, float]:
        """``y/e``, beyond the mean, of what opens first, and of what closes first, once in contact.

        Parameters
        ----------
        modulus : float
            Glassy shear modulus.

        Returns
        -------
        tuple of float
        """
        contact, own = self.contact, self.strips.chosen(self.strips.of(self.contact.node))
        first_free = int(np.count_nonzero(own.within(contact.node, contact.share)))
        stresses = own.stresses
        closing = contact.depth - self.modulus.depths(own.parts)[first_free]
        return float(stresses[max(first_free - 1, 0)]), float(stresses[first_free] + modulus * closing)

    def released(self, step: SeriesStep, unit: Array) -> StripsInStep:
        """The strips in a step; ``unit`` (n,) is ``e`` of the surface then."""
        memory = step.memory_depth(self.strips.parts)
        return StripsInStep(self.strips, unit[self.strips.nodes] * memory)

    def energy(self, unit: Array) -> float:
        """Energy of all strips beyond that of the means; ``unit`` (n,) is ``e`` of the glassy surface."""
        return float(self.energies @ unit[self.strips.nodes] ** 2)


def partly_held(
    before: PartlyHeld | None, step: SeriesStep, contact: PartialContact | None
) -> PartlyHeld | None:
    """The node next to an adhesive edge at the end of a step.

    Parameters
    ----------
    before : PartlyHeld or None
        At its begin.
    step : SeriesStep
    contact : PartialContact or None
        At its end.

    Returns
    -------
    PartlyHeld or None
    """
    if contact is None:
        return None
    node, share, modulus = contact.node, contact.share, step.series
    strips = Strips.undeformed(node, modulus) if before is None else before.strips
    strips = strips.divided(node, share).joined(node, share)
    memory, within = step.memory_depth(strips.parts), strips.within(node, share)
    depths, own = np.where(within, 0.0, -memory), strips.of(node)
    held = within[own]
    borne = float(strips.shares[own][held] @ (contact.depth + memory[own][held]))
    depths[own] = np.where(held, contact.depth, -memory[own] - borne / (1.0 - share))
    strips = strips.after(step, depths)
    energies = strips.energies(modulus)
    kept = strips.bearing(energies, node)
    if not kept.all():
        strips, energies = strips.chosen(kept), energies[kept]
    return PartlyHeld(contact, modulus, strips, energies)


def energy_at_edge(partly: PartlyHeld | None, unit: Array, forces: Array, gap: Array) -> float:
    """Energy of the node next to the edge, and of those passed before, beyond that of their means.

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
    return -0.5 * float(forces @ gap) if partly is None else partly.energy(unit)
