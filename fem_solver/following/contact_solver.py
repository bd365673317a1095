"""Contact state at the end of a trial step, with a mesh that follows the edge."""

from __future__ import annotations

import math
from typing import cast

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters
from contact_scene.loading import Control
from fem_solver.contact_solver import ContactCandidate
from fem_solver.edge import NO_CONTACT, EdgeMotion, EdgePosition
from fem_solver.following.edge_search import FollowingEdgeSearch, SearchRange
from fem_solver.following.path import missed_by_extrapolation
from fem_solver.following.problem import FollowingProblem
from fem_solver.following.setup import FollowingSetup
from fem_solver.release import ContactProblem

Array = NDArray[np.float64]

_RIPPLE = 1.0
"""Travel, in elements, within which the passage of nodes ripples the edge's path more than its steps do."""


class FollowingContactSolver:
    """Solves for the contact state at one instant and counts the work; as ``ContactSolver``.

    Positions of the edge that come in are nodes of the surface of the accepted state, those of candidates are
    nodes of the surface of their problem.
    """

    def __init__(self, setup: FollowingSetup, counters: Counters) -> None:
        self.setup, self.counters = setup, counters

    def start(self, control: Control, value: float, relaxed: bool) -> ContactCandidate:
        """Glassy or relaxed equilibrium, from the undeformed half-space; a flat face touches up to its rim.

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
        if math.isfinite(self.setup.surfaces.rim):
            whole = self.held(dt, control, value, self.setup.surfaces.rim)
            if whole.problem.closure(whole.edge.s) <= self.setup.adhesion.work:
                return whole
        search = self._search(dt, control, value)
        radius = search.sharp_radius(self.setup.surfaces.largest)
        if radius == 0.0:
            return search.first_contact()
        return search.followed(SearchRange(radius, 0.0, math.inf))

    def trial(
        self, dt: float, control: Control, value: float, start: float, limits: tuple[float, float]
    ) -> ContactCandidate:
        """Equilibrium of the edge at the end of a step.

        Parameters
        ----------
        dt, control, value, limits
            As of :meth:`fem_solver.contact_solver.ContactSolver.trial`.
        start : float
            Edge position before the step.

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
        search = self._search(dt, control, value)
        if not self.setup.adhesion.reversible:
            return search.leaving(SearchRange(radius, low, high))
        starts = [radius]
        if not self.setup.has_history:  # each state is an equilibrium by itself
            starts.insert(0, search.sharp_radius(state.radius) or radius)
        for start_radius in dict.fromkeys(starts):
            radii = SearchRange(start_radius, low, high).clipped()
            found = search.followed(radii, abs(radii.expected - state.radius))
            if found.in_equilibrium:
                break
        return found

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
        problem = cast("ContactProblem", self._search(dt, control, value).problem(placement))
        return ContactCandidate(dt, problem, EdgePosition(EdgeMotion.RESTING, s))

    def extended(self, candidate: ContactCandidate) -> ContactCandidate:
        """The search of a candidate without equilibrium, continued as far as contact goes."""
        problem, radius = cast("FollowingProblem", candidate.problem), self.radius(candidate)
        limits = (radius, math.inf) if candidate.edge.motion is EdgeMotion.ADVANCING else (0.0, radius)
        search = self._search(candidate.dt, problem.control, problem.value)
        return search.followed(SearchRange(radius, *limits))

    def radius(self, candidate: ContactCandidate) -> float:
        """Contact radius."""
        return candidate.problem.geometry.radius(candidate.edge.s)

    def missed_by_extrapolation(self, candidate: ContactCandidate) -> float:
        """Distance by which the edge misses the extrapolation of its path.

        Parameters
        ----------
        candidate : ContactCandidate

        Returns
        -------
        float
            A length; 0 where the path does not matter, or a step passes too few nodes to tell it.
        """
        state, geometry = self.setup.history.state, candidate.problem.geometry
        if not self.setup.has_history or not 0.0 < candidate.dt < math.inf or candidate.edge.s < 0.0:
            return 0.0
        radius, node = self.radius(candidate), int(candidate.edge.s)
        element = float(geometry.radii[node + 2] - geometry.radii[node])
        if abs(radius - state.radius) < _RIPPLE * element:
            return 0.0
        return missed_by_extrapolation(state.radius, radius, candidate.dt, state.before)

    def accept(self, candidate: ContactCandidate, forces: Array) -> float:
        """Make a candidate the accepted state; the work done on the surface so far."""
        self.setup.history.accept(cast("FollowingProblem", candidate.problem), candidate.edge.s)
        return self.setup.history.state.received

    def _search(self, dt: float, control: Control, value: float) -> FollowingEdgeSearch:
        return FollowingEdgeSearch(self.setup, self.counters, dt, control, value)
