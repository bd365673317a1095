"""Search for the edge with a mesh that is placed where the edge is expected, and moved on where it is not."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion, Counters
from contact_scene.segment import Control
from fem_solver.contact_solver import ContactCandidate
from fem_solver.edge import NO_CONTACT, AdhesiveEdge, EdgeMotion, EdgePosition
from fem_solver.following.placement import Placement
from fem_solver.following.problem import FollowingProblem
from fem_solver.following.setup import FollowingSetup
from fem_solver.following.sharp_edge import sharp_rest
from fem_solver.irreversible_edge import IrreversibleEdge, edge_law
from fem_solver.release import ContactProblem

Array = NDArray[np.float64]

_STRIDE_OF_TRAVEL = 0.1
"""Widest stride of a search, relative to the travel expected of the step: within a step the closure changes
on the scale of its travel."""
_STRIDE_OF_RADIUS = 0.02
"""Farthest that a search goes to the next place of the mesh, relative to the contact radius: stable and
unstable contact are farther apart."""
_SHARP_SEARCHES = 4
"""Places at which the radius of a sharp edge is sought, each finer around it than the one before."""


_MOST_PLACES = 400
"""Places of the mesh that a search asks at most: over the whole range of radii it takes some tens."""


class EdgeNotFound(Exception):
    """The places of the mesh around the edge do not agree on where it rests."""


def placed_law(placement: Placement, adhesion: Adhesion, stride: float = 0.0) -> AdhesiveEdge:
    """The edge law where the mesh resolves the zone.

    Parameters
    ----------
    placement : Placement
    adhesion : Adhesion
    stride : float
        Widest stride of a search, a length, if it is more than half a zone.

    Returns
    -------
    AdhesiveEdge
    """
    law = edge_law(placement.geometry, adhesion)
    law.lowest = placement.lowest
    law.widest = max(law.widest, stride / (placement.fine_range / placement.fine_intervals))
    return law


class FollowingContactSolver:
    """Solves for the contact state at one instant and counts the work; as ``ContactSolver``.

    Positions of the edge that come in are nodes of the surface of the accepted state, those of candidates are
    nodes of the surface of their problem.
    """

    def __init__(self, setup: FollowingSetup, counters: Counters) -> None:
        self.setup, self.counters = setup, counters

    def start(self, control: Control, value: float, relaxed: bool) -> ContactCandidate:
        """Glassy or relaxed equilibrium, from the undeformed half-space.

        Parameters
        ----------
        control : "penetration" or "stage"
        value : float
            Of the controlled quantity.
        relaxed : bool

        Returns
        -------
        ContactCandidate
        """
        dt = math.inf if relaxed else 0.0
        radius = self._sharp_radius(dt, control, value, self.setup.surfaces.largest)
        if radius == 0.0:
            placement = self.setup.surfaces.around(0.0)
            problem = self._problem(placement, dt, control, value)
            edge = placed_law(placement, self.setup.adhesion).start(cast("ContactProblem", problem))
            return self._found(dt, problem, edge)
        return self._search(dt, control, value, radius, (0.0, math.inf), 0.0)

    def trial(
        self, dt: float, control: Control, value: float, start: float, limits: tuple[float, float]
    ) -> ContactCandidate:
        """Equilibrium of the edge at the end of a step.

        Parameters
        ----------
        dt : float
            Length of the step; 0 for a glassy response.
        control : "penetration", "force" or "stage"
        value : float
            Of the controlled quantity at the end of the step.
        start : float
            Edge position before the step.
        limits : tuple of float
            Least and largest edge position searched.

        Returns
        -------
        ContactCandidate
            In equilibrium, or with the limit at which the search ended.
        """
        geometry, state = self.setup.geometry, self.setup.history.state
        low = geometry.radius(limits[0]) if limits[0] > self.setup.law.lowest else 0.0
        high = geometry.radius(limits[1]) if math.isfinite(limits[1]) else math.inf
        expected = 0.0
        if state.before and 0.0 < dt < math.inf:
            expected = (state.radius - state.before[0][1]) / state.before[0][0] * dt
        radius = state.radius + expected
        if not self.setup.adhesion.reversible:
            return self._leaving(dt, control, value, radius, (low, high))
        if not self.setup.has_history:  # each state is an equilibrium by itself
            radius = self._sharp_radius(dt, control, value, state.radius) or radius
        radius = min(max(radius, low), high)
        return self._search(dt, control, value, radius, (low, high), abs(radius - state.radius))

    def held(self, dt: float, control: Control, value: float, radius: float) -> ContactCandidate:
        """State at the end of a step with the edge at a given radius, in equilibrium or not.

        Parameters
        ----------
        dt, control, value
            As of :meth:`trial`.
        radius : float
            Contact radius; 0 is no contact.

        Returns
        -------
        ContactCandidate
        """
        self.counters.linear_solves += 1
        lost = radius <= 0.0
        placement = self.setup.history.placement if lost else self.setup.surfaces.around(radius)
        s = NO_CONTACT if lost else placement.geometry.position(radius)
        problem = cast("ContactProblem", self._problem(placement, dt, control, value))
        return ContactCandidate(dt, problem, EdgePosition(EdgeMotion.RESTING, s))

    def extended(self, candidate: ContactCandidate) -> ContactCandidate:
        """The search of a candidate without equilibrium, continued as far as contact goes."""
        problem, radius = cast("FollowingProblem", candidate.problem), self.radius(candidate)
        limits = (radius, math.inf) if candidate.edge.motion is EdgeMotion.ADVANCING else (0.0, radius)
        return self._search(candidate.dt, problem.control, problem.value, radius, limits, 0.0)

    def radius(self, candidate: ContactCandidate) -> float:
        """Contact radius."""
        return candidate.problem.geometry.radius(candidate.edge.s)

    def accept(self, candidate: ContactCandidate, forces: Array) -> float:
        """Make a candidate the accepted state; the work done on the surface so far."""
        self.setup.history.accept(cast("FollowingProblem", candidate.problem), candidate.edge.s)
        return self.setup.history.state.received

    def _problem(self, placement: Placement, dt: float, control: Control, value: float) -> FollowingProblem:
        history = self.setup.history
        state, compliance = history.at(placement), self.setup.compliance
        return FollowingProblem(placement, history.solid, state, dt, control, value, compliance)

    def _found(self, dt: float, problem: FollowingProblem, edge: EdgePosition) -> ContactCandidate:
        self.counters.closure_evaluations += problem.evaluations
        self.counters.linear_solves += 1
        return ContactCandidate(dt, cast("ContactProblem", problem), edge)

    def _leaving(
        self, dt: float, control: Control, value: float, radius: float, limits: tuple[float, float]
    ) -> ContactCandidate:
        """An edge that is pinned where it is, or leaves it in one direction and is followed there.

        Parameters
        ----------
        dt, control, value
            As of :meth:`trial`.
        radius : float
            Expected contact radius.
        limits : tuple of float
            Least and largest contact radius searched.

        Returns
        -------
        ContactCandidate
        """
        state, adhesion = self.setup.history.state, self.setup.adhesion
        placement = self.setup.surfaces.around(state.radius)
        problem, law = self._problem(placement, dt, control, value), edge_law(placement.geometry, adhesion)
        assert problem.origin is not None
        assert isinstance(law, IrreversibleEdge)
        here = problem.origin.edge
        motion = law.departure(cast("ContactProblem", problem), here)
        pinned = self._found(dt, problem, EdgePosition(EdgeMotion.RESTING, here))
        if motion is EdgeMotion.RESTING:
            return pinned
        low, high = limits
        low, high = (state.radius, high) if motion is EdgeMotion.ADVANCING else (low, state.radius)
        radius = min(max(radius, low), high)
        found = self._search(dt, control, value, radius, (low, high), abs(radius - state.radius))
        # another place of the mesh may see the closure on the other side of what moves the edge
        return found if found.in_equilibrium or found.edge.motion is motion else pinned

    def _search(
        self,
        dt: float,
        control: Control,
        value: float,
        radius: float,
        limits: tuple[float, float],
        travel: float,
    ) -> ContactCandidate:
        """Follow the edge from a radius, moving the mesh on where the edge leaves its fine strip.

        Parameters
        ----------
        dt, control, value
            As of :meth:`trial`.
        radius : float
            Where the search starts.
        limits : tuple of float
            Least and largest contact radius searched.
        travel : float
            Travel expected of the step.

        Returns
        -------
        ContactCandidate

        Raises
        ------
        EdgeNotFound
        """
        surfaces, low, high = self.setup.surfaces, limits[0], min(limits[1], self.setup.surfaces.reach)
        adhesion = self.setup.adhesion
        far, stride = low == 0.0 or high == surfaces.reach, 0.0
        within, beyond = 0.0, math.inf  # radii at which the edge advances, and recedes
        for _ in range(_MOST_PLACES):
            placement = surfaces.around(radius)
            geometry = placement.geometry
            law = placed_law(placement, adhesion, _STRIDE_OF_TRAVEL * travel)
            problem = self._problem(placement, dt, control, value)
            ends = geometry.position(low), geometry.position(high)
            edge = law.seek(cast("ContactProblem", problem), geometry.position(radius), *ends)
            found = self._found(dt, problem, edge)
            reached, outwards = geometry.radius(edge.s), edge.motion is EdgeMotion.ADVANCING
            ended = edge.s >= ends[1] if outwards else edge.s <= max(ends[0], 2.0)
            if found.in_equilibrium or ended:
                return found
            work = adhesion.closing if outwards else adhesion.opening(math.inf)
            if far and math.isfinite(work):
                radius, far = sharp_rest(problem, self.setup, reached, work, outwards), False
                if radius == 0.0:
                    return replace(found, edge=EdgePosition(EdgeMotion.RECEDING, 2.0))
                continue
            within, beyond = (reached, beyond) if outwards else (within, reached)
            if within < beyond < math.inf and within > 0.0:  # it rests between the two
                radius = 0.5 * (within + beyond)
                continue
            stride = min(2.0 * stride + 0.25 * placement.fine_range, _STRIDE_OF_RADIUS * reached)
            radius = min(max(reached + (stride if outwards else -stride), low), high)
        raise EdgeNotFound(f"the edge is not found around the contact radius {radius:.6g}")

    def _sharp_radius(self, dt: float, control: Control, value: float, radius: float) -> float:
        """Contact radius of a sharp edge if all happens at once: the outermost stable, or 0.

        The first search has the mesh at ``radius``, each other one where the one before has found the edge.
        """
        for _ in range(_SHARP_SEARCHES):
            problem = self._problem(self.setup.surfaces.around(radius), dt, control, value)
            radius = sharp_rest(problem, self.setup, math.inf, self.setup.adhesion.closing)
            if radius == 0.0:
                break
        return radius
