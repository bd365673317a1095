"""Events: load jumps, edge jumps where a run of stable states ends, contact as short as its process zone.

Load jumps and edge jumps are instantaneous, the half-space answers with its glassy modulus. Nothing is
accepted here; see ``stepping``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from scipy.optimize import brentq

from contact_scene.loading import Control
from fem_solver.contact_problem import ContactCandidate, ContactProblem
from fem_solver.edge_geometry import EdgeMotion
from fem_solver.edge_search import ContactSolver
from fem_solver.recorder import SurfaceState, work_of_bends

_SHORTEST_PART = 2.0**-10
"""Least part of a load jump where the response is curved, relative to the jump."""
_LAST_PART = 2.0**-24
"""Least part of a load jump before contact counts as lost, relative to the jump."""
_SHARE_TOLERANCE = 1e-12
"""Accuracy of the share of a step or load jump at which the contact is as short as its process zone."""


@dataclass
class LoadJump:
    """A load that changes instantaneously, taken in parts over which the response is nearly linear.

    The work is then that of an edge that moves with the load, and contact is lost where the edge has no
    equilibrium, not where the jump began.

    Parameters
    ----------
    control : "penetration", "force" or "stage"
    first, last : float
        Values of the controlled quantity.
    begin : SurfaceState
        The state before the jump.
    done, part : float
        Share of the jump that is accepted, and of the next part.
    response_scale : float
        Largest change of the response so far.
    bent : float
        Work in the last part beyond its trapezoid, ``int F dD`` along parabolas through its middle.
    """

    control: Control
    first: float
    last: float
    begin: SurfaceState
    done: float = 0.0
    part: float = 1.0
    response_scale: float = 0.0
    bent: float = 0.0

    @property
    def complete(self) -> bool:
        """Whether the whole jump is accepted."""
        return self.done >= 1.0

    def trial(self, solver: ContactSolver, state: SurfaceState, tolerance: float) -> ContactCandidate | None:
        """The next part; ``None`` if it has to be shorter, without equilibrium where contact is lost."""
        self.part = min(self.part, 1.0 - self.done)
        end = self._at(solver, state, self.done + self.part)
        if not end.in_equilibrium:
            return None if self.part > _LAST_PART else end
        middle = self._at(solver, state, self.done + 0.5 * self.part)
        change = abs(end.response - self._response(self.begin))
        self.response_scale = max(self.response_scale, change)
        deviation = abs(middle.response - 0.5 * (self._response(state) + end.response))
        curved = not middle.in_equilibrium or deviation > tolerance * self.response_scale
        if curved and self.part > _SHORTEST_PART:
            return None
        self.bent = _work_of_bend(state, middle, end) if middle.in_equilibrium else 0.0
        return end

    def halve(self) -> None:
        """Try again with half the part."""
        self.part *= 0.5

    def advance(self) -> None:
        """Accept the part."""
        self.done += self.part
        self.part *= 2.0

    def value(self, share: float) -> float:
        """The controlled quantity at a share of the jump."""
        return self.last if share == 1.0 else self.first + share * (self.last - self.first)

    def _response(self, state: SurfaceState) -> float:
        return state.penetration if self.control == "force" else state.force

    def _at(self, solver: ContactSolver, state: SurfaceState, share: float) -> ContactCandidate:
        limits = (solver.setup.law.lowest, math.inf)
        return solver.trial(0.0, self.control, self.value(share), state.edge, limits)


def _work_of_bend(first: SurfaceState, middle: ContactCandidate, last: ContactCandidate) -> float:
    """``int F dD`` beyond the trapezoid, along parabolas through three states."""
    depth_bend = 2.0 * (first.penetration + last.penetration) - 4.0 * middle.penetration
    force_bend = 2.0 * (first.force + last.force) - 4.0 * middle.force
    rises = last.penetration - first.penetration, last.force - first.force
    return work_of_bends(rises, (depth_bend, force_bend))


def zone_reached(
    solver: ContactSolver,
    taken: Callable[[ContactProblem, float], float],
    load: Callable[[float], tuple[float, Control, float]],
) -> ContactCandidate | None:
    """The state in a step or part of a jump with contact as short as its zone; ``None`` if it leaps past.

    ``load`` gives length of the step, control and value at a share of it, ``taken`` the energy per area.
    """
    zone = solver.setup.geometry.zone or 0.0

    def excess(share: float) -> float:
        held = solver.held(*load(share), zone)
        problem, s = held.problem, held.edge.s
        solver.counters.closure_evaluations += 1
        return max(problem.closure(s) / taken(problem, s), 0.0) - 1.0

    if not excess(0.0) < 0.0 <= excess(1.0):
        return None
    share = float(brentq(excess, 0.0, 1.0, xtol=_SHARE_TOLERANCE))
    return solver.held(*load(share), zone)


def edge_jump(solver: ContactSolver, candidate: ContactCandidate) -> ContactCandidate:
    """Follow an edge that leaves the range of the shortest step to where it rests again, or is lost."""
    law = solver.setup.law
    receded = candidate.edge.motion is not EdgeMotion.ADVANCING and candidate.edge.s <= law.lowest
    return candidate if receded else solver.extended(candidate)
