"""One trial step: choose its duration, find the edge, estimate the error. Nothing is committed here."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from contact_scene import Segment
from validation.reference.tracking.collapse import collapse_at_once
from validation.reference.tracking.instantaneous import is_over
from validation.reference.tracking.law import NoTension
from validation.reference.tracking.limit_points import (
    approach_zero_radius,
    leave_limit_point,
    prescribed_travel,
)
from validation.reference.tracking.problem import LONG_ZONE, FrontProblem
from validation.reference.tracking.root import bracketed
from validation.reference.tracking.rounding import rounded_length
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_error import REJECTED_ABOVE
from validation.reference.tracking.step_history import FORCE, RADIUS
from validation.reference.tracking.step_outcome import NO_STABLE_CONTACT, FrontCandidate, StepOutcome
from validation.reference.tracking.trial import EdgeSearch, Trial

FLAT_RESIDUAL = 0.2
"""Rise of the edge residual over one process zone below which a limit point may be near."""
FORCE_NOISE = 1e-10
"""Change of the force, in largest forces, that may be rounding: far above it, far below any deviation."""
VANISHING_FORCE = 1e-3
"""Force without adhesion, in allowed deviations of the largest force, from which on contact is lost in one
step: flat profiles keep a radius to the last, and its speed grows beyond what times can resolve."""
LARGEST_GROWTH = 2.0
"""Largest ratio of successive steps, in the variable over which rows are extrapolated."""
FIRST_STEP = 100.0
"""First step after a kink, in allowed deviations times the shortest time: it has no error estimate."""
LEAST_CHANGE = 1e-9
"""Least change of the load in the first step of a new contact, relative to the largest load, however fast a
branch relaxes: the rounding of the load, 1e-16 of the largest, is then 1e-7 of what the step adds."""


@dataclass(frozen=True)
class RowTolerances:
    """Deviations by which rows may leave a straight line, under a linear and under a curved load."""

    linear: float
    curved: float

    def allowed(self, segment: Segment) -> float:
        """Deviation allowed under the load of a segment."""
        return self.linear if segment.linear else self.curved


def trial_step(
    problem: FrontProblem, state: FrontState, segment: Segment, stop: float, rows: RowTolerances
) -> StepOutcome:
    """One step towards ``stop``, of about the proposed duration.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state; only its work counters change.
    segment : Segment
        Load step.
    stop : float
        Time that must not be passed.
    rows : RowTolerances
        How straight the rows of the trace have to be.

    Returns
    -------
    StepOutcome
    """
    a0 = state.surface.radius
    left, tick = stop - state.time, 4.0 * math.ulp(state.time)
    if problem.rated and (passed := collapse_at_once(problem, state, segment)):
        end = problem.candidate(state.time, passed[-1])
        return StepOutcome(candidates=(end,), equilibria=passed[:-1], below_zone=True)
    if state.unstable != 0.0:
        return leave_limit_point(problem, state, segment)
    h = _duration(problem, state, segment, left, tick)
    if isinstance(problem.condition, NoTension) and a0 > 0.0:
        vanishing = _vanishing_contact(problem, state, segment, h, left, rows.allowed(segment))
        if vanishing is not None:
            return vanishing
    guess = state.history.expectation(RADIUS).value_after(h)
    landed = _to_zone_from_turn(problem, state, segment, h, guess, rows)
    if landed is not None:
        return landed
    trial = problem.trial(state, segment, abs(guess - a0))
    reach = state.travel if a0 > 0.0 else state.largest_radius  # the radius of a new contact grows at once
    lowest = max(a0 - state.travel, problem.condition.smallest_radius)
    steepness = max(state.steepness + state.steepening * h, 0.0)
    edge = trial.stable_edge(h, guess, lowest, min(a0 + reach, problem.edge_radius), steepness)
    if edge.radius != a0 and state.history.rate_of_radius() == 0.0:
        departure = trial.departure_time(h)
        if departure is not None and departure > tick:
            end = problem.candidate(state.time + departure, trial.surface_at(departure, a0))
            return StepOutcome(candidates=(end,), first_contact=True, kink=True)
    if edge.radius < a0 <= problem.scene.bare_plane_tip:
        return StepOutcome(detachment=NO_STABLE_CONTACT)
    if not edge.stable:
        return prescribed_travel(problem, state, trial, edge.radius, h, rows.allowed(segment))
    end = problem.candidate(state.time + h, trial.surface_at(h, edge.radius))
    over = is_over(problem, state, end)
    if over and a0 > problem.scene.bare_plane_tip:
        edge = replace(edge, radius=0.0)
        end = problem.candidate(end.time, trial.surface_at(h, 0.0))
    deviation, intervals = _step_error(problem, state, trial, end, edge, rows)
    if deviation > REJECTED_ABOVE:
        if h <= tick:  # a jump within the resolution of time
            return StepOutcome(candidates=(end,), rejected=True, kink=True)
        return StepOutcome(h * max(0.2, 0.9 / math.sqrt(deviation)), rejected=True)
    growth = LARGEST_GROWTH**2 if state.history.before_root else LARGEST_GROWTH  # of the root of the time
    return StepOutcome(
        h * min(growth, 0.95 / max(deviation, 1e-6) ** (1.0 / 3.0)),
        (FrontCandidate(end.time if h < left else stop, end.surface, end.force, intervals),),
        travel=min(problem.longest_travel(edge.radius), 2.0 * state.travel),
        steepness=edge.steepness,
        steepening=(edge.steepness - state.steepness) / h if state.steepness * edge.steepness > 0.0 else 0.0,
        detachment=NO_STABLE_CONTACT if over or edge.radius == 0.0 < a0 else "",
    )


def _to_zone_from_turn(
    problem: FrontProblem, state: FrontState, segment: Segment, h: float, guess: float, rows: RowTolerances
) -> StepOutcome | None:
    """Step that ends one more zone from the turn of the edge; ``None`` if it is not expected within ``h``."""
    place = problem.zone_from_turn(state)
    if place is None or (guess - place) * state.direction <= 0.0:
        return None
    a0, path = state.surface.radius, state.history.expectation(RADIUS)

    def beyond(duration: float) -> float:
        return (path.value_after(duration) - place) * state.direction

    expected = bracketed(beyond, 0.0, (a0 - place) * state.direction, h, beyond(h), 0.0, 1e-6 * h)
    trial = problem.trial(state, segment, abs(place - a0))
    duration = trial.duration_to_radius(place, h, expected)
    if duration is None or not 4.0 * math.ulp(state.time) < duration < h:
        return None
    end = problem.candidate(state.time + duration, trial.surface_at(duration, place))
    edge = EdgeSearch(place, True, state.steepness)
    deviation, intervals = _step_error(problem, state, trial, end, edge, rows)
    if deviation > REJECTED_ABOVE:
        return StepOutcome(duration * max(0.2, 0.9 / math.sqrt(deviation)), rejected=True)
    return StepOutcome(h, (replace(end, intervals=intervals),), zone_from_turn=True)


def _duration(problem: FrontProblem, state: FrontState, segment: Segment, left: float, tick: float) -> float:
    """The proposed duration, limited by the next stop, the travel of the edge and extrema of the rows."""
    slope, proposal = state.history.rate_of_radius(), state.proposal
    if proposal is None:
        proposal = _first_duration(problem, state, segment, left)
    h = left if proposal >= 0.999 * left else max(min(proposal, 0.5 * left), tick)
    if abs(slope) * h > 0.95 * state.travel:
        h = 0.9 * state.travel / abs(slope)
    noise = {RADIUS: problem.fineness.deviation * state.largest_radius}
    if segment.control != "force":
        noise = {FORCE: FORCE_NOISE * state.largest_force, **noise}
    h = state.history.limited_to_extremum(h, noise)
    if tick < h < left:
        h = max(rounded_length(h, segment.end - segment.start), tick)
    return h


def _vanishing_contact(
    problem: FrontProblem, state: FrontState, segment: Segment, h: float, left: float, allowed: float
) -> StepOutcome | None:
    """Step of a contact without adhesion that is about to vanish; ``None`` if it is not."""
    if segment.control == "force":
        if segment.value(state.time + h) <= 0.0:
            return approach_zero_radius(problem, state, segment, h, allowed)
    elif state.history.rate_of_radius() < 0.0 and (
        0.0 < state.surface.radius - problem.scene.bare_plane_tip <= problem.largest_travel
        or state.force <= VANISHING_FORCE * problem.fineness.deviation * state.largest_force
    ):
        trial = problem.trial(state, segment)
        if trial.residual(left, problem.scene.bare_plane_tip) > 0.0:
            return prescribed_travel(problem, state, trial, problem.scene.bare_plane_tip, left, allowed)
    return None


def _step_error(
    problem: FrontProblem,
    state: FrontState,
    trial: Trial,
    end: FrontCandidate,
    edge: EdgeSearch,
    rows: RowTolerances,
) -> tuple[float, int]:
    """Step error in allowed deviations, and the number of intervals for interpolated rows."""
    row = end.row
    estimator = problem.step_error(state, trial.segment, end)
    deviation, smooth = estimator.in_time(row), True
    near_limit = not problem.rated and 0.0 < edge.steepness * problem.condition.zone_length < FLAT_RESIDUAL
    if deviation > 1.0 and near_limit and state.history.continues_monotonically(row, RADIUS):
        along = estimator.along_edge(row)
        deviation, smooth = min(deviation, along), deviation <= along
    return deviation, estimator.intervals(row, rows.allowed(trial.segment)) if smooth else 1


def _first_duration(problem: FrontProblem, state: FrontState, segment: Segment, left: float) -> float:
    """Duration of the first step after a kink: a small part of every time scale."""
    part, share = FIRST_STEP * problem.fineness.deviation, problem.fineness.first_share
    if state.surface.radius == 0.0:  # a new contact grows as a root of the time
        part, share = part**2, share**2
    quick = min(part * problem.shortest_time, share * left)
    scale = segment.present(state.largest_depth, state.largest_force)
    rate = abs(segment.rate(state.time))
    if rate > 0.0 and scale > 0.0:
        quick = min(quick, part * scale / rate)
        if state.surface.radius == 0.0:
            quick = max(quick, min(LEAST_CHANGE * scale / rate, share * left))
    zone = problem.condition.zone_length
    if problem.over_zones(state.surface.radius):  # a small part of the time in which the edge passes a zone
        quick *= zone / (LONG_ZONE * state.surface.radius)
    return max(quick, 4.0 * math.ulp(state.time))
