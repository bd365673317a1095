"""Where the contact edge settles: by the closure with adhesion, by vanishing singularity without.

At a fixed instant the response is glassy and reversible in the edge position ``s``, so the closure is one
function of it. The edge recedes where ``I > dg`` and advances where ``I < dg``; it rests at the first root it
meets, where ``I`` rises through ``dg``. Beyond the last root the contact is unstable.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

import numpy as np
from scipy.optimize import brentq

from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.release import ContactProblem

_NODE_TOLERANCE = 1e-10
"""Accuracy of the edge position, in node spacings."""
_STRIDE, _NARROW_STRIDE = 0.25, 2.0**-12
"""First stride of a search, in node spacings: the usual one, and that next to the last root."""
_WIDEST_STRIDE = 0.5
"""Widest stride of a search, in shortest zones: the closure, a mean over a zone, hardly turns within it."""
NO_CONTACT = -1.0
"""Edge position at which no node is in contact."""


class EdgeMotion(Enum):
    """Result of a search: the edge rests within the range searched, or leaves it inwards or outwards."""

    RESTING = "resting"
    RECEDING = "receding"
    ADVANCING = "advancing"


@dataclass(frozen=True)
class EdgePosition:
    """Result of a search: edge position ``s`` in equilibrium, otherwise the end of the range searched."""

    motion: EdgeMotion
    s: float


class EdgeLaw(Protocol):
    """Law of the contact edge; ``lowest`` is the least edge position it resolves."""

    lowest: float

    def start(self, problem: ContactProblem) -> EdgePosition:
        """Largest stable contact."""
        ...

    def seek(self, problem: ContactProblem, s: float, low: float, high: float) -> EdgePosition:
        """Follow the edge to where it rests.

        Parameters
        ----------
        problem : ContactProblem
        s : float
            Edge position, in nodes, from which the search starts.
        low, high : float
            Range searched.

        Returns
        -------
        EdgePosition
        """
        ...

    def radius(self, problem: ContactProblem, s: float) -> float:
        """Contact radius of an edge at rest."""
        ...


class AdhesiveEdge:
    """Closure integral equal to the work of adhesion.

    A search makes strides of at most ``widest`` nodes. It begins with the first of ``first_strides``, and
    again with the next one where that ends in a receding edge.
    """

    def __init__(self, geometry: EdgeGeometry, work: float) -> None:
        self.geometry, self.work = geometry, work
        # contact of less than one element cannot be distinguished from no contact
        self.lowest = 2.0
        within = geometry.radii[: geometry.last + 1]
        spacing = float(np.median(np.diff(within))) if len(within) > 1 else math.inf
        self.widest = max(_WIDEST_STRIDE * (geometry.shortest or 0.0) / spacing, _STRIDE)
        self.first_strides: tuple[float, ...] = (_STRIDE, _NARROW_STRIDE)

    def taken(self, problem: ContactProblem, s: float) -> float:
        """Energy per area that the edge takes up on its way to ``s``."""
        return self.work

    def _excess(self, problem: ContactProblem, s: float) -> float:
        value = problem.closure(s) / self.taken(problem, s) - 1.0
        return value if value > -1.0 else -1.0

    def start(self, problem: ContactProblem) -> EdgePosition:
        """Scan inwards from the largest contact for the first stable root.

        A root below one process zone is returned as well: the caller names it in its error.
        """
        last = self.geometry.last
        beyond = self._excess(problem, last)
        if beyond <= 0.0:
            if self.geometry.capped:
                return EdgePosition(EdgeMotion.RESTING, float(last))
            return EdgePosition(EdgeMotion.ADVANCING, float(last))
        for node in range(last - 1, 0, -1):
            excess = self._excess(problem, node)
            if excess < 0.0:
                ends = {float(node): excess, node + 1.0: beyond}
                return EdgePosition(EdgeMotion.RESTING, self._root(problem, ends))
            beyond = excess
        if problem.penetration(1.0) >= 0.0:  # in compression, but smaller than the mesh resolves
            return EdgePosition(EdgeMotion.RESTING, 1.0)
        return EdgePosition(EdgeMotion.RECEDING, self.lowest)

    def seek(self, problem: ContactProblem, s: float, low: float, high: float) -> EdgePosition:
        """Expand a bracket from ``s`` in the direction in which the closure moves the edge.

        Next to the last root the interval between two roots is narrower than the usual stride, so a search
        that ends in a receding edge is repeated with a far shorter one.

        Parameters
        ----------
        problem, s, low, high
            As of :meth:`EdgeLaw.seek`.

        Returns
        -------
        EdgePosition
        """
        for stride in self.first_strides:
            search = self._expand(problem, s, low, high, stride)
            if search.motion is not EdgeMotion.RECEDING:
                break
        return search

    def _expand(
        self, problem: ContactProblem, s: float, low: float, high: float, stride: float
    ) -> EdgePosition:
        low, high = max(low, self.lowest), min(high, float(self.geometry.last))
        here = min(max(s, low), high)
        excess = self._excess(problem, here)
        way = -1.0 if excess > 0.0 else 1.0
        limit = low if way < 0.0 else high
        while here != limit:
            ahead = here + way * stride
            if (limit - ahead) * way <= 0.0:
                ahead = limit
            beyond = self._excess(problem, ahead)
            if beyond * way >= 0.0:
                return EdgePosition(EdgeMotion.RESTING, self._root(problem, {here: excess, ahead: beyond}))
            here, excess, stride = ahead, beyond, min(2.0 * stride, self.widest)
        if way > 0.0 and self.geometry.capped and limit == self.geometry.last:
            return EdgePosition(EdgeMotion.RESTING, limit)
        return EdgePosition(EdgeMotion.ADVANCING if way > 0.0 else EdgeMotion.RECEDING, limit)

    def _root(self, problem: ContactProblem, ends: dict[float, float]) -> float:
        """The root between two positions, given with their excess.

        Arguments are not kept, as what a function holds would be in a reference cycle of scipy's.
        """
        known = problem, ends
        root = brentq(self._known_excess, min(ends), max(ends), known, xtol=_NODE_TOLERANCE, rtol=1e-15)
        return float(root)

    def _known_excess(self, s: float, problem: ContactProblem, ends: dict[float, float]) -> float:
        return ends[s] if s in ends else self._excess(problem, s)

    def radius(self, problem: ContactProblem, s: float) -> float:
        """Effective radius of the partly released set."""
        return self.geometry.radius(s)


class AdhesionlessEdge:
    """No tension inside, no penetration outside: whole nodes, ``s`` an integer.

    Parameters
    ----------
    geometry : EdgeGeometry
    positions, depths : list of float
        Radius at which the contact that ends at each node is without singularity, and the penetration that
        presses an elastic half-space into that contact.
    plane_tip : float
        Radius of a plane tip, all of which is in contact if any is; 0 without one.
    """

    def __init__(
        self, geometry: EdgeGeometry, positions: list[float], depths: list[float], plane_tip: float = 0.0
    ) -> None:
        self.geometry, self.plane_tip = geometry, plane_tip
        self.lowest = NO_CONTACT
        self._positions, self._depths = positions, depths

    def start(self, problem: ContactProblem) -> EdgePosition:
        """Grow the contact from nothing."""
        return self.seek(problem, NO_CONTACT, NO_CONTACT, float(self.geometry.last))

    def seek(self, problem: ContactProblem, s: float, low: float, high: float) -> EdgePosition:
        """Release nodes in tension, or cover nodes that would penetrate, one after the other.

        Parameters
        ----------
        problem, s, low, high
            As of :meth:`EdgeLaw.seek`.

        Returns
        -------
        EdgePosition
        """
        lowest, highest = math.ceil(max(low, NO_CONTACT)), math.floor(min(high, self.geometry.last))
        m = int(s)
        while m < highest and self._presses(problem, m + 1):
            m += 1
        capped = self.geometry.capped and m == self.geometry.last
        if m == highest and not capped and self._presses(problem, m + 1):
            return EdgePosition(EdgeMotion.ADVANCING, float(m))
        if m > s:
            return EdgePosition(EdgeMotion.RESTING, float(m))
        while m > lowest and not self._presses(problem, m):
            m -= 1
        untouched = m == NO_CONTACT and s == NO_CONTACT and not self._pulls(problem)
        held = m > NO_CONTACT and self._presses(problem, m) and not self._is_let_go(problem)
        return EdgePosition(EdgeMotion.RESTING if held or untouched else EdgeMotion.RECEDING, float(m))

    @staticmethod
    def _presses(problem: ContactProblem, node: int) -> bool:
        """Whether contact up to this node leaves it under pressure."""
        return problem.intensity(node, float(node)) > 0.0

    @staticmethod
    def _is_let_go(problem: ContactProblem) -> bool:
        """Whether the prescribed force presses no more: a plane tip would touch at none."""
        return problem.control == "force" and problem.value <= 0.0

    @staticmethod
    def _pulls(problem: ContactProblem) -> bool:
        """Whether the prescribed force is a tension, which a contact without adhesion cannot carry."""
        return problem.control == "force" and problem.value < 0.0

    def radius(self, problem: ContactProblem, s: float) -> float:
        """Where the singularity vanishes between the last node inside and the first outside."""
        m = int(s)
        if m < 0:
            return 0.0
        if self.geometry.capped and m == self.geometry.last:
            return self.geometry.radius(s)
        inside = max(problem.intensity(m, s), 0.0) / self._kept(problem, m - 1, s)
        outside = min(problem.intensity(m + 1, s), 0.0) / self._kept(problem, m + 1, s)
        share = inside / (inside - outside) if inside > outside else 0.5
        between = self._positions[m] + (self._positions[m + 1] - self._positions[m]) * share
        return max(between, self.plane_tip)

    def _kept(self, problem: ContactProblem, node: int, s: float) -> float:
        """How steeply the intensity falls to the next node, relative to an elastic contact.

        Under the indenter stresses relax, while the gap beside it does not: read as one line, both would let
        the edge of a contact at rest creep by parts of an element.
        """
        if not 0 <= node < self.geometry.last:
            return 1.0
        elastic = self._depths[node + 1] - self._depths[node]
        fall = problem.intensity(node, s) - problem.intensity(node + 1, s)
        return fall / elastic if fall > 0.0 and elastic > 0.0 else 1.0
