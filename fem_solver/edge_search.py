"""Contact state at the end of a trial step: where the edge rests, with the mesh placed around it.

The mesh is placed where the edge is expected, and moved on where it is not. A trial changes nothing but the
work counters; what it returns is accepted, or dropped, by ``time_step``. Where a sharp edge comes to rest
needs no resolved process zone, so any place of the mesh serves. Penetration is positive downwards, force
positive in compression.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters
from contact_scene.loading import Control
from fem_solver.contact_problem import ContactCandidate, ContactProblem
from fem_solver.edge import AdhesiveEdge, IrreversibleEdge, edge_law
from fem_solver.edge_path import NO_CONTACT, EdgeMotion, EdgePosition, extrapolated
from fem_solver.placement import Placement
from fem_solver.setup import Setup

Array = NDArray[np.float64]


def sharp_rest(
    problem: ContactProblem, setup: Setup, radius: float, work: float, outwards: bool = False
) -> float:
    """Radius at which a sharp edge that leaves a radius all at once comes to rest; 0 if contact is lost.

    One that would outgrow the mesh rests at the largest radius the mesh is made for.
    """
    reach = setup.surfaces.reach
    x = problem.placement.positions
    excess = sharp_release_rates(problem) - work
    excess[x > setup.surfaces.rim] = np.inf
    stable = (excess[:-1] < 0.0) & (excess[1:] >= 0.0)
    stable &= (x[:-1] > radius) if outwards else (x[1:] < radius)
    rests = np.flatnonzero(stable)
    if not rests.size:
        return reach if outwards else 0.0
    at = rests[0] if outwards else rests[-1]
    if x[at + 1] > setup.surfaces.rim:
        return setup.surfaces.rim
    share = excess[at] / (excess[at] - excess[at + 1])
    return float(min(x[at] + share * (x[at + 1] - x[at]), reach))


def sharp_release_rates(problem: ContactProblem) -> Array:
    """Energy release rate of a sharp edge at every component, if all happens at once; shape (n,).

    It needs no process zone to be resolved: ``(e q)^2/2``, with ``q`` the flat punch that leaves the same
    singularity there, over the area of the component; zero where the edge would be under pressure. On the
    half-space it is ``E* q^2/(2 pi x)``.
    """
    here, state = problem.placement, problem.state
    free = problem.solid.relieved(state.components, state.branches, problem.dt)
    if problem.control == "penetration":
        penetration = np.full(len(here.unit), problem.value)
    elif problem.control == "stage":
        softness = problem.compliance
        penetration = (problem.value - softness * problem.held_force) / (1.0 + softness * problem.stiffness)
    else:
        penetration = (problem.value - problem.held_force) / problem.stiffness
    q = penetration - (here.profile + free) / here.unit
    twice = problem.modulus * (here.unit * np.minimum(q, 0.0)) ** 2
    areas = 2.0 * np.pi * here.positions * np.diff(here.geometry.effective, prepend=0.0)
    return 0.5 * np.divide(twice, areas, out=np.zeros_like(areas), where=areas > 0.0)


_MOST_PLACES = 400
"""Places of the mesh that a search asks at most: over the whole range of radii it takes some tens."""


class EdgeNotFound(Exception):
    """The places of the mesh around the edge do not agree on where it rests."""


@dataclass(frozen=True)
class EdgeSearch:
    """Edge at the end of one trial step, on meshes that are moved on until they hold it.

    ``dt`` is the length of the step, 0 for a glassy response, infinite for a relaxed one; ``value`` that of
    the controlled quantity at its end, ``middle`` a penetration prescribed half-way. The counters take the
    work.
    """

    setup: Setup
    counters: Counters
    dt: float
    control: Control
    value: float
    middle: float | None = None

    def problem(self, placement: Placement) -> ContactProblem:
        """All contact states possible at the end of the step, with the mesh at a place."""
        setup = self.setup
        state = setup.at(placement)
        prescribed = self.control, self.value, setup.compliance, self.middle
        return ContactProblem(placement, setup.solid, state, self.dt, *prescribed)

    def candidate(self, problem: ContactProblem, edge: EdgePosition) -> ContactCandidate:
        """The candidate with its edge where a search has ended; the work of the search is counted."""
        self.counters.closure_evaluations += problem.evaluations
        self.counters.linear_solves += 1
        return ContactCandidate(problem, edge)

    def start(self) -> ContactCandidate:
        """Glassy or relaxed equilibrium, undeformed before; a flat face touches up to its rim."""
        surfaces, adhesion = self.setup.surfaces, self.setup.adhesion
        if adhesion is None:
            return self.followed(0.0, 0.0, math.inf)
        if math.isfinite(surfaces.rim):
            whole = self.held(surfaces.rim)
            if whole.problem.closure(whole.edge.s) <= adhesion.work:
                return whole
        found = self.followed(surfaces.largest, 0.0, math.inf)
        return self.first_contact() if found.edge.motion is EdgeMotion.RECEDING else found

    def trial(self, low: float, high: float) -> ContactCandidate:
        """Equilibrium of the edge at the end of a step, within a range of radii."""
        state, adhesion = self.setup.state, self.setup.adhesion
        takes_time = 0.0 < self.dt < math.inf
        expected = extrapolated(state.radius, self.dt, state.before) if takes_time else state.radius
        if adhesion is not None and not adhesion.reversible:
            return self.leaving(expected, low, high)
        # an elastic edge that adheres may be in equilibrium at two radii: it is sought from where it is
        ahead = self.setup.has_history or adhesion is None
        return self.followed(expected if ahead else state.radius, low, high)

    def extended(self, candidate: ContactCandidate) -> ContactCandidate:
        """An edge that has left the range of its search, followed to where it rests again, or is lost."""
        radius, outwards = candidate.radius, _outwards(candidate)
        if not outwards and candidate.edge.s <= self.setup.law.lowest:
            return candidate
        return self.followed(radius, *((radius, math.inf) if outwards else (0.0, radius)))

    def plane_contact(self) -> ContactCandidate | None:
        """Contact of all of a plane tip, as it touches or is let go; ``None`` without one."""
        return self.held(self.setup.plane_tip) if self.setup.plane_tip > 0.0 else None

    def held(self, radius: float) -> ContactCandidate:
        """State with the edge at a given radius, in equilibrium or not."""
        here = self.setup.placement if radius <= 0.0 else self.setup.around(radius)
        s = NO_CONTACT if radius <= 0.0 else here.geometry.position(radius)
        return self.candidate(self.problem(here), EdgePosition(EdgeMotion.RESTING, s))

    def resting(self) -> ContactCandidate:
        """State with the edge where the step begins, in equilibrium or not."""
        problem = self.problem(self.setup.around(self.setup.state.radius))
        return self.candidate(problem, EdgePosition(EdgeMotion.RESTING, problem.state.edge))

    def first_contact(self) -> ContactCandidate:
        """Largest stable contact, with the mesh placed around the axis."""
        placement = self.setup.around(0.0)
        problem = self.problem(placement)
        return self.candidate(problem, self._law(placement, 0.0).start(problem))

    def leaving(self, expected: float, low: float, high: float) -> ContactCandidate:
        """An edge that is pinned where it is, or leaves it in one direction and is followed there."""
        radius, pinned = self.setup.state.radius, self.resting()
        law = self._law(pinned.problem.placement, 0.0)
        assert isinstance(law, IrreversibleEdge)
        self.counters.closure_evaluations += 1
        motion = law.departure(pinned.problem, pinned.edge.s)
        if motion is EdgeMotion.RESTING:
            return pinned
        low, high = (radius, high) if motion is EdgeMotion.ADVANCING else (low, radius)
        found = self.followed(expected, low, high)
        # another place of the mesh may see the closure on the other side of what moves the edge
        return found if found.in_equilibrium or found.edge.motion is motion else pinned

    def followed(self, radius: float, low: float, high: float) -> ContactCandidate:
        """Follow the edge from a radius, moving the mesh on where the edge leaves its fine strip."""
        surfaces, adhesion = self.setup.surfaces, self.setup.adhesion
        high = min(high, surfaces.reach)
        radius = min(max(radius, low), high)
        far, stride = low == 0.0 or high == surfaces.reach, 0.0
        within, beyond = 0.0, math.inf  # radii at which the edge advances, and recedes
        passed = 0.0  # without a look at the closure, from the place before
        for _ in range(_MOST_PLACES):
            found, ended = self._sought(radius, low, high, passed)
            reached, outwards = found.radius, _outwards(found)
            if ended and outwards and high == surfaces.rim:  # held by the rim of the indenter
                return replace(found, edge=EdgePosition(EdgeMotion.RESTING, found.edge.s))
            if found.in_equilibrium or ended:
                return found
            assert adhesion is not None  # otherwise the first place serves all radii
            closes = outwards or found.problem.state.edge <= NO_CONTACT
            work = adhesion.closing if closes else adhesion.opening(math.inf)
            if far and math.isfinite(work):
                radius, far = sharp_rest(found.problem, self.setup, reached, work, outwards), False
                if radius < adhesion.zone:  # no mesh is made for what would be no contact
                    return replace(found, edge=EdgePosition(EdgeMotion.RECEDING, 2.0))
                continue
            within, beyond = (reached, beyond) if outwards else (within, reached)
            if within < beyond < math.inf and within > 0.0:  # it rests between the two
                radius, passed = 0.5 * (within + beyond), 0.0
                continue
            here = found.problem.placement
            fine_range = here.geometry.spacing * (here.geometry.last - here.lowest)
            # stable and unstable contact are farther apart than an edge goes in a step
            stride = min(2.0 * stride + 0.25 * fine_range, self.setup.travel(reached))
            radius, passed = min(max(reached + (stride if outwards else -stride), low), high), stride
        raise EdgeNotFound(f"the edge is not found around the contact radius {radius:.6g}")

    def _law(self, placement: Placement, stride: float) -> AdhesiveEdge:
        """The edge law where the mesh resolves the zone, with strides that are at least as wide."""
        law = edge_law(placement.geometry, self.setup.adhesion, self.setup.plane_tip)
        if self.setup.adhesion is not None:
            law.lowest = placement.lowest
            law.widest = max(law.widest, stride / placement.geometry.spacing)
        return law

    def _sought(self, radius: float, low: float, high: float, passed: float) -> tuple[ContactCandidate, bool]:
        """The search from one place of the mesh, and whether the edge has come to the end of the range."""
        placement = self.setup.around(radius)
        geometry, law = placement.geometry, self._law(placement, passed)
        if passed > 0.0:
            law.first = law.widest
        problem = self.problem(placement)
        ends = geometry.position(low), geometry.position(high)
        found = self.candidate(problem, law.seek(problem, geometry.position(radius), *ends))
        if _outwards(found):
            return found, found.edge.s >= ends[1]
        return found, found.edge.s <= max(ends[0], self.setup.law.lowest)


def _outwards(candidate: ContactCandidate) -> bool:
    return candidate.edge.motion is EdgeMotion.ADVANCING
