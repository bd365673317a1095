"""Contact state at the end of a trial step: response of the half-space, then the search for the edge.

A trial changes nothing but the work counters; what it returns is accepted, or dropped, by ``stepping``.
Penetration is positive downwards, force positive in compression.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters
from contact_scene.loading import Control
from fem_solver.edge import NO_CONTACT, EdgeMotion, EdgePosition
from fem_solver.edge_geometry import EdgeOrigin
from fem_solver.release import ContactProblem
from fem_solver.setup import Setup

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ContactCandidate:
    """Contact state at the end of a trial step.

    ``problem`` holds all states that are possible then, ``edge`` selects one.
    """

    dt: float
    problem: ContactProblem
    edge: EdgePosition

    @property
    def in_equilibrium(self) -> bool:
        """Whether the edge rests."""
        return self.edge.motion is EdgeMotion.RESTING

    @property
    def penetration(self) -> float:
        """Penetration."""
        return self.problem.penetration(self.edge.s)

    @property
    def force(self) -> float:
        """Total force."""
        return self.problem.force(self.edge.s)

    @property
    def singular_force(self) -> float:
        """Force of the flat punch, as large as the contact, that leaves the same edge singularity."""
        return self.problem.singular_force(self.edge.s)

    @property
    def response(self) -> float:
        """Penetration where the force is prescribed, otherwise the force."""
        return self.penetration if self.problem.control == "force" else self.force


@dataclass
class ContactSolver:
    """Solves for the contact state at one instant and counts the work.

    ``origin`` gives the edge of the last accepted state.
    """

    setup: Setup
    counters: Counters
    origin: Callable[[], EdgeOrigin | None]

    def start(self, control: Control, value: float, relaxed: bool) -> ContactCandidate:
        """Glassy or relaxed equilibrium, from the undeformed half-space.

        Parameters
        ----------
        control : "penetration", "force" or "stage"
        value : float
            Of the controlled quantity.
        relaxed : bool

        Returns
        -------
        ContactCandidate
        """
        dt = math.inf if relaxed else 0.0
        problem = self._problem(dt, control, value)
        return self._searched(dt, problem, lambda: self.setup.law.start(problem))

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
            Edge position, in nodes, from which the search starts.
        limits : tuple of float
            Least and largest edge position searched.

        Returns
        -------
        ContactCandidate
            In equilibrium, or with the limit at which the search ended.
        """
        problem = self._problem(dt, control, value)
        return self._searched(dt, problem, lambda: self.setup.law.seek(problem, start, *limits))

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
        s = self.setup.geometry.position(radius) if radius > 0.0 else NO_CONTACT
        edge = EdgePosition(EdgeMotion.RESTING, s)
        return ContactCandidate(dt, self._problem(dt, control, value), edge)

    def plane_contact(self, dt: float, control: Control, value: float) -> ContactCandidate | None:
        """Contact of all of a plane tip, as it touches or is let go; ``None`` without one of two nodes.

        Parameters
        ----------
        dt, control, value
            As of :meth:`trial`.

        Returns
        -------
        ContactCandidate or None
        """
        last = int(np.count_nonzero(self.setup.height[: self.setup.geometry.last + 1] == 0.0)) - 1
        if last < 1:
            return None
        self.counters.linear_solves += 1
        edge = EdgePosition(EdgeMotion.RESTING, float(last))
        return ContactCandidate(dt, self._problem(dt, control, value), edge)

    def extended(self, candidate: ContactCandidate) -> ContactCandidate:
        """The search of a candidate without equilibrium, continued to the end of the mesh."""
        edge, law = candidate.edge, self.setup.law
        advancing = edge.motion is EdgeMotion.ADVANCING
        limits = (edge.s, math.inf) if advancing else (law.lowest, edge.s)
        problem = candidate.problem
        return self._searched(candidate.dt, problem, lambda: law.seek(problem, edge.s, *limits))

    def radius(self, candidate: ContactCandidate) -> float:
        """Contact radius."""
        return self.setup.law.radius(candidate.problem, candidate.edge.s)

    def missed_by_extrapolation(self, candidate: ContactCandidate) -> float:
        """Nothing that could be told from the passage of nodes: a step goes over a part of an element."""
        return 0.0

    def accept(self, candidate: ContactCandidate, forces: Array) -> float | None:
        """Make a candidate with these nodal forces the accepted state.

        Returns
        -------
        float or None
            Work done on the surface so far, where the history itself knows it.
        """
        contact = candidate.problem.partial_contact(candidate.edge.s)
        self.setup.history.commit(candidate.dt, forces, contact)
        return None

    def _problem(self, dt: float, control: Control, value: float) -> ContactProblem:
        setup = self.setup
        return ContactProblem(
            setup.geometry,
            setup.history.respond(dt),
            setup.height,
            control,
            value,
            compliance=setup.compliance,
            dt=dt,
            origin=self.origin(),
        )

    def _searched(
        self, dt: float, problem: ContactProblem, search: Callable[[], EdgePosition]
    ) -> ContactCandidate:
        """The candidate that a search yields; its evaluations of the closure are counted once."""
        before = problem.evaluations
        edge = search()
        self.counters.closure_evaluations += problem.evaluations - before
        self.counters.linear_solves += 1
        return ContactCandidate(dt, problem, edge)
