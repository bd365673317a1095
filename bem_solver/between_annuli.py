"""What the load inside the contact holds between the collocation radii.

Stress at the edge, force and gap outside are integrals of the required ``v`` over the contact, each with a
weight that varies slowly over an annulus. Collocation reads ``v`` at one radius of each: as good as its
cubics where ``v`` is smooth there. But annuli widen with the distance from the edge, and what an edge has
left behind where it set out slowly or turned may be far narrower. Read at single radii it comes and goes as
those pass over it. The closure of an advancing edge changes little with its place: it becomes a wave over
many process zones, on which the edge stops, and jumps, where there is nothing.

So the part of ``v`` beyond the cubics through the collocation radii counts, too. It is known at the nodes of
the history, which lie close where the history is not smooth; each gives it to the annuli around in the shares
of their cubics. Any weight that such cubics follow then sees all of ``v``, wherever the radii are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bem_solver.annuli import Annuli
from bem_solver.history import NODES_APART

Array = NDArray[np.float64]

_CROWDED, _EVEN = 0.25, 0.5
"""Distances of nodes from each other, in those asked for where the history is smooth, up to which they count
in full and from which on they do not: there the cubics hold ``v`` better than sums over nodes that come and
go. Nodes that are taken out again in pairs come no closer than the second for long."""
_AROUND = 3
"""Annuli on both sides of crowded nodes in which all nodes count: so far the cubics feel what is there."""


@dataclass(frozen=True)
class LoadBetween:
    """What nodes of the history inside a contact add to the load of its annuli.

    Attributes
    ----------
    radius : ndarray (m,)
        Of the nodes.
    annulus : ndarray of int (4, m)
        Annuli around each.
    share : ndarray (4, m)
        Their shares in it.
    width : ndarray (m,)
        How many annuli each stands for.
    """

    radius: Array
    annulus: NDArray[np.intp]
    share: Array
    width: Array

    @classmethod
    def of(cls, annuli: Annuli, edge: float, nodes: Array) -> LoadBetween | None:
        """Nodes around places where they are closer than their distance from the edge asks for.

        Parameters
        ----------
        annuli : Annuli
        edge : float
            Contact radius.
        nodes : ndarray (n,)
            Radii of all nodes, rising.

        Returns
        -------
        LoadBetween or None
            ``None`` if there are no such places.
        """
        count = int(nodes.searchsorted(edge))
        radius = nodes[:count]
        high = np.minimum(np.append(0.5 * (nodes[1:] + nodes[:-1]), edge)[:count], edge)
        low = np.append(radius[:1], high[:-1])
        apart = (high - low) / (NODES_APART * (edge - radius))
        apart[:1] *= 2.0  # nothing on the other side of the axis
        if apart.min(initial=_EVEN) >= _EVEN:
            return None
        crowded = np.minimum((_EVEN - apart) / (_EVEN - _CROWDED), 1.0)
        position = annuli.position_at(edge - radius, edge)
        at = np.minimum(position.astype(int), annuli.count - 1)
        most = np.zeros(annuli.count + 2 * _AROUND)
        np.maximum.at(most, at + _AROUND, crowded)
        weight = sliding_window_view(most, 2 * _AROUND + 1).max(axis=1)[at]
        some = np.flatnonzero(weight)
        wide = annuli.position_at(edge - high[some], edge) - annuli.position_at(edge - low[some], edge)
        return cls(radius[some], *annuli.cubic_shares(position[some]), weight[some] * wide)

    def added(self, load: Array, at_nodes: Array) -> Array:
        """``v`` (M,) for the annuli, from that at their collocation radii (M,) and at the nodes (m,)."""
        rest = self.width * (at_nodes - (self.share * load[self.annulus]).sum(axis=0))
        return load + np.bincount(self.annulus.ravel(), (self.share * rest).ravel(), len(load))
