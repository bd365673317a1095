"""Search for an edge on a mesh that is placed where the edge is expected, and moved on where it is not."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import cast

from contact_scene import Adhesion, Counters
from contact_scene.loading import Control
from fem_solver.contact_solver import ContactCandidate
from fem_solver.edge import AdhesiveEdge, EdgeMotion, EdgePosition
from fem_solver.following.placement import Placement
from fem_solver.following.problem import FollowingProblem
from fem_solver.following.setup import FollowingSetup
from fem_solver.following.sharp_edge import sharp_rest
from fem_solver.irreversible_edge import IrreversibleEdge, edge_law
from fem_solver.release import ContactProblem

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


@dataclass(frozen=True)
class SearchRange:
    """Radii at which an edge is sought, all of them lengths.

    Parameters
    ----------
    expected : float
        Contact radius where the search starts.
    low, high : float
        Least and largest contact radius searched.
    """

    expected: float
    low: float
    high: float

    def clipped(self) -> SearchRange:
        """The same, with the search starting within its limits."""
        return replace(self, expected=min(max(self.expected, self.low), self.high))


class FollowingEdgeSearch:
    """Edge at the end of one trial step, on meshes that are moved on until they hold it.

    Parameters
    ----------
    setup : FollowingSetup
    counters : Counters
        Take the work.
    dt : float
        Length of the step; 0 for a glassy response, infinite for a relaxed one.
    control : "penetration", "force" or "stage"
    value : float
        Of the controlled quantity at the end of the step.
    """

    def __init__(
        self, setup: FollowingSetup, counters: Counters, dt: float, control: Control, value: float
    ) -> None:
        self.setup, self.counters = setup, counters
        self.dt, self.control, self.value = dt, control, value

    def problem(self, placement: Placement) -> FollowingProblem:
        """All contact states possible at the end of the step, with the mesh at a place."""
        history = self.setup.history
        state, compliance = history.at(placement), self.setup.compliance
        return FollowingProblem(
            placement, history.solid, state, self.dt, self.control, self.value, compliance
        )

    def candidate(self, problem: FollowingProblem, edge: EdgePosition) -> ContactCandidate:
        """The candidate with its edge where a search has ended; the work of the search is counted."""
        self.counters.closure_evaluations += problem.evaluations
        self.counters.linear_solves += 1
        return ContactCandidate(self.dt, cast("ContactProblem", problem), edge)

    def first_contact(self) -> ContactCandidate:
        """Largest stable contact, with the mesh placed around the axis."""
        placement = self.setup.surfaces.around(0.0)
        problem = self.problem(placement)
        edge = placed_law(placement, self.setup.adhesion).start(cast("ContactProblem", problem))
        return self.candidate(problem, edge)

    def leaving(self, radii: SearchRange) -> ContactCandidate:
        """An edge that is pinned where it is, or leaves it in one direction and is followed there."""
        state, adhesion = self.setup.history.state, self.setup.adhesion
        placement = self.setup.surfaces.around(state.radius)
        problem, law = self.problem(placement), edge_law(placement.geometry, adhesion)
        assert problem.origin is not None
        assert isinstance(law, IrreversibleEdge)
        here = problem.origin.edge
        motion = law.departure(cast("ContactProblem", problem), here)
        pinned = self.candidate(problem, EdgePosition(EdgeMotion.RESTING, here))
        if motion is EdgeMotion.RESTING:
            return pinned
        if motion is EdgeMotion.ADVANCING:
            ahead = replace(radii, low=state.radius).clipped()
        else:
            ahead = replace(radii, high=state.radius).clipped()
        found = self.followed(ahead, abs(ahead.expected - state.radius))
        # another place of the mesh may see the closure on the other side of what moves the edge
        return found if found.in_equilibrium or found.edge.motion is motion else pinned

    def followed(self, radii: SearchRange, travel: float = 0.0) -> ContactCandidate:
        """Follow the edge from a radius, moving the mesh on where the edge leaves its fine strip.

        Parameters
        ----------
        radii : SearchRange
        travel : float
            Travel expected of the step, a length.

        Returns
        -------
        ContactCandidate

        Raises
        ------
        EdgeNotFound
        """
        surfaces, adhesion = self.setup.surfaces, self.setup.adhesion
        low, high = radii.low, min(radii.high, surfaces.reach)
        radius = min(radii.expected, high)
        far, stride = low == 0.0 or high == surfaces.reach, 0.0
        within, beyond = 0.0, math.inf  # radii at which the edge advances, and recedes
        passed = 0.0  # without a look at the closure, from the place before
        for _ in range(_MOST_PLACES):
            found, ended = self._sought(radius, low, high, travel, passed)
            reached, outwards = found.problem.geometry.radius(found.edge.s), _outwards(found)
            if ended and outwards and high == surfaces.rim:  # held by the rim of the indenter
                return replace(found, edge=EdgePosition(EdgeMotion.RESTING, found.edge.s))
            if found.in_equilibrium or ended:
                return found
            work = adhesion.closing if outwards else adhesion.opening(math.inf)
            if far and math.isfinite(work):
                problem = cast("FollowingProblem", found.problem)
                radius, far = sharp_rest(problem, self.setup, reached, work, outwards), False
                if radius == 0.0:
                    return replace(found, edge=EdgePosition(EdgeMotion.RECEDING, 2.0))
                continue
            within, beyond = (reached, beyond) if outwards else (within, reached)
            if within < beyond < math.inf and within > 0.0:  # it rests between the two
                radius, passed = 0.5 * (within + beyond), 0.0
                continue
            fine_range = cast("FollowingProblem", found.problem).placement.fine_range
            stride = min(2.0 * stride + 0.25 * fine_range, _STRIDE_OF_RADIUS * reached)
            radius, passed = min(max(reached + (stride if outwards else -stride), low), high), stride
        raise EdgeNotFound(f"the edge is not found around the contact radius {radius:.6g}")

    def _sought(
        self, radius: float, low: float, high: float, travel: float, passed: float
    ) -> tuple[ContactCandidate, bool]:
        """The search from one place of the mesh.

        Parameters
        ----------
        radius : float
            Where it starts, and the mesh is placed.
        low, high : float
            Least and largest contact radius searched.
        travel : float
            Travel expected of the step, a length.
        passed : float
            Distance from the end of the search at the place before: nothing was asked there, so nothing finer
            is here. 0 at the first place.

        Returns
        -------
        found : ContactCandidate
        ended : bool
            Whether the edge has come to the end of the range in its direction.
        """
        placement = self.setup.surfaces.around(radius)
        geometry = placement.geometry
        law = placed_law(placement, self.setup.adhesion, max(_STRIDE_OF_TRAVEL * travel, passed))
        if passed > 0.0:
            law.first_strides = (law.widest,)
        problem = self.problem(placement)
        ends = geometry.position(low), geometry.position(high)
        edge = law.seek(cast("ContactProblem", problem), geometry.position(radius), *ends)
        found = self.candidate(problem, edge)
        return found, edge.s >= ends[1] if _outwards(found) else edge.s <= max(ends[0], 2.0)

    def sharp_radius(self, radius: float) -> float:
        """Contact radius of a sharp edge if all happens at once: the outermost stable, or 0.

        The first search has the mesh at ``radius``, each other one where the one before has found the edge.
        """
        for _ in range(_SHARP_SEARCHES):
            problem = self.problem(self.setup.surfaces.around(radius))
            radius = sharp_rest(problem, self.setup, math.inf, self.setup.adhesion.closing)
            if radius == 0.0:
                break
        return radius


def _outwards(candidate: ContactCandidate) -> bool:
    return candidate.edge.motion is EdgeMotion.ADVANCING
