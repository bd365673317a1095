"""What a run on graded annuli consists of between two trial steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from bem_solver.energy import Energies
from bem_solver.half_space_state import HalfSpaceState
from bem_solver.loading_intervals import LoadingInterval
from bem_solver.problem import Problem
from bem_solver.recorder import TraceRecorder
from bem_solver.step_control import AcceptedSteps

_SMALLEST_TRAVEL_SHARES = 1.0 / 64.0, 1.0 / 16.0
"""Shares of the travel limit: an edge that passes even this at constant load moves unstably."""
_ROUNDING_AT_FOLD = 3e-5
"""Contact radius, relative, to which a limit point is told from rounding: there the edge moves by the root of
what the load does, of which up to 1e-9 is lost in the sums over annuli and states."""
_ROUNDINGS_OF_TIME = 4.0
"""Shortest step of an edge that moves in time, in roundings of it: within them nothing can be told apart."""


@dataclass(frozen=True)
class StepSettings:
    """What bounds the steps of a run.

    ``tolerance`` is the step tolerance, ``divisions`` the number of steps in which the edge may travel the
    length it is resolved on, ``scale`` the order of magnitude of the largest contact radius.
    """

    tolerance: float
    divisions: int
    scale: float


class RejectedStep(NamedTuple):
    """A step from the committed state that was rejected: its length, and how far the edge went in it.

    ``load_error`` is that of the load alone, in tolerances; infinite where the step had no candidate.
    """

    step: float
    travel: float
    load_error: float = math.inf


@dataclass
class GradedState:
    """State of a run on graded annuli.

    ``contact`` and ``energies`` are the committed state, ``record`` the rows, events and profiles so far. In
    the present loading interval the run has reached ``parameter``, with the ``accepted`` states
    from which rates are extrapolated; from there steps were ``rejected``. ``step`` is the step to try next
    before it is limited, ``travel_share`` the share of the travel limit of the edge in force, ``slope`` the
    derivative of the residual with the edge expected in the next step (0: unknown), ``last_slope`` that in
    the last accepted one. ``sought_limit_point``: from here no step ends on one.
    """

    contact: HalfSpaceState
    energies: Energies
    record: TraceRecorder
    largest_force: float
    largest_edge: float
    largest_tension: float = 0.0
    parameter: float = 0.0
    rejected: list[RejectedStep] = field(default_factory=list)
    accepted: AcceptedSteps = field(default_factory=AcceptedSteps)
    step: float = 0.0
    travel_share: float = 1.0
    slope: float = 0.0
    last_slope: float = 0.0
    sought_limit_point: bool = False

    def follow_slope(self, slope: float) -> None:
        """Take the slope of an accepted step (0: unknown), and expect the next to change in proportion."""
        if slope > 0.0:
            change = slope / self.last_slope if self.last_slope > 0.0 else 1.0
            self.slope, self.last_slope = slope * min(max(change, 0.5), 2.0), slope

    def interval_done(self) -> None:
        """Ready for the next loading interval."""
        self.parameter, self.rejected = 0.0, []


@dataclass(frozen=True)
class StepStart:
    """Where a step starts: problem, settings, committed state, and the interval of the loading it lies in."""

    problem: Problem
    settings: StepSettings
    state: GradedState
    interval: LoadingInterval

    @property
    def shortest_step(self) -> float:
        """Step below which times are lost in rounding, where the edge moves in time; else 0.

        Where branches or the work of adhesion follow its speed it never moves at once, however short they
        are, or however fast a contact collapses.
        """
        if not (self.problem.curves or self.problem.rated) or self.interval.jump:
            return 0.0
        return _ROUNDINGS_OF_TIME * math.ulp(self.interval.time(self.interval.length))

    def reach(self, advancing: bool) -> float:
        """Travel limit of the edge in one step."""
        longest = self.problem.longest_travel(self.state.contact.edge, advancing)
        return self.state.travel_share * longest / self.settings.divisions

    def coarseness(self, travel: float) -> float:
        """Part of the usual coarsening of the history that a step of some travel may cause.

        An unstable edge, as far beyond the limit point as the stable one is before it, has the same residual:
        what stands between them falls with the square of the way that is left, and so must what nodes taken
        out change of it.
        """
        left = max(self.state.accepted.way_to_limit_point() - travel, self.smallest_travel)
        full = self.problem.longest_travel(self.state.contact.edge, advancing=False) / self.settings.divisions
        return min(1.0, (left / full) ** 2)

    @property
    def smallest_travel(self) -> float:
        """Travel at constant load from which on an edge moves unstably; limit points are located to it.

        Where steps pass over zones it may be many of them: with short ones a share of one is below rounding.
        """
        edge, divisions = self.state.contact.edge, self.settings.divisions
        limit = longest = self.problem.length_at(edge) / divisions
        if self.problem.over_zones(edge):
            longest = self.problem.longest_travel(edge, advancing=False) / divisions
        least, most = _SMALLEST_TRAVEL_SHARES
        return min(max(_ROUNDING_AT_FOLD * edge, least * limit), most * longest)
