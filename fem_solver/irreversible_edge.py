"""Edge that opens at another energy than it closes at, or at one that follows its speed.

Definition: ``contact_scene``.

The closure is one function of the edge position at an instant, but what it is compared with depends on where
the edge comes from: an edge is pinned between the closing and the opening energy, and opens at the speed
``v = -da/dt`` at the end of the step, by the backward differentiation formula of second order.
"""

from __future__ import annotations

import math

from contact_scene import Adhesion
from fem_solver.edge import AdhesiveEdge, EdgeMotion, EdgePosition
from fem_solver.edge_geometry import EdgeGeometry
from fem_solver.release import ContactProblem


class IrreversibleEdge(AdhesiveEdge):
    """Closure integral equal to what the edge takes up in its direction, at its speed."""

    def __init__(self, geometry: EdgeGeometry, adhesion: Adhesion) -> None:
        super().__init__(geometry, adhesion.work)
        self.adhesion = adhesion

    def taken(self, problem: ContactProblem, s: float) -> float:
        """Energy per area that the edge takes up on its way to ``s``; at rest that at which it opens."""
        origin = problem.origin
        if origin is None or s > origin.edge:
            return self.adhesion.closing
        if s == origin.edge or self.adhesion.rate is None:
            return self.adhesion.work
        speed = origin.opening_speed(self.geometry.radius(s), problem.dt)
        return self.adhesion.opening(max(speed, 0.0))

    def start(self, problem: ContactProblem) -> EdgePosition:
        """Largest stable contact that has closed; a flat face touches up to its rim unless that opens."""
        last = self.geometry.last
        if self.geometry.capped and problem.closure(last) <= self.work:
            return EdgePosition(EdgeMotion.RESTING, float(last))
        return super().start(problem)

    def seek(self, problem: ContactProblem, s: float, low: float, high: float) -> EdgePosition:
        """Leave the edge where it is pinned, or follow it in the direction in which it moves.

        Parameters
        ----------
        problem : ContactProblem
            With the edge of the last accepted state.
        s, low, high : float
            Edge positions, in nodes: begin of the search and its range.

        Returns
        -------
        EdgePosition
            Pinned at ``s``, at rest elsewhere, or the end of the range.
        """
        origin = problem.origin
        if origin is None or s != origin.edge:
            return super().seek(problem, s, low, high)
        motion = self.departure(problem, s)
        if motion is EdgeMotion.RECEDING:
            return super().seek(problem, s, low, s)
        if motion is EdgeMotion.ADVANCING:
            return super().seek(problem, s, s, high)
        return EdgePosition(EdgeMotion.RESTING, s)

    def departure(self, problem: ContactProblem, s: float) -> EdgeMotion:
        """Which way the edge leaves the position ``s`` where a step begins, or whether it is pinned there."""
        closure = problem.closure(s)
        opening = self.adhesion.opening(math.inf) if problem.dt <= 0.0 else self.work
        if closure > opening:
            return EdgeMotion.RECEDING
        return EdgeMotion.ADVANCING if closure < self.adhesion.closing else EdgeMotion.RESTING


def edge_law(geometry: EdgeGeometry, adhesion: Adhesion) -> AdhesiveEdge:
    """The law of an adhesive edge."""
    if adhesion.reversible:
        return AdhesiveEdge(geometry, adhesion.work)
    return IrreversibleEdge(geometry, adhesion)


def energy_spent(adhesion: Adhesion, radii: tuple[float, float], closures: tuple[float, float]) -> float:
    """Energy that the interface takes up in a step of the edge; negative where it closes.

    Parameters
    ----------
    adhesion : Adhesion
    radii : tuple of float
        Contact radius before and after.
    closures : tuple of float
        Closure integral before and after, to which an opening edge is equal.

    Returns
    -------
    float
    """
    before, after = radii
    area = math.pi * (before**2 - after**2)
    if area <= 0.0:
        return adhesion.closing * area
    if adhesion.rate is None:
        return adhesion.work * area
    most = adhesion.opening(math.inf)
    energies = [min(max(closure, adhesion.work), most) for closure in closures]
    return 0.5 * (energies[0] + energies[1]) * area
