"""Steps of prescribed distance, towards and at limit points, where the time step is no measure.

If the edge would travel too far, its travel is prescribed and the time is the unknown: loss of contact and
snaps are approached in distance, where nothing is singular. A step with a limit point on its way ends there.
Where not even a short step is stable the edge is unstable.
"""

from __future__ import annotations

import math
from dataclasses import replace

from contact_scene import Event, Segment
from validation.reference.tracking.instantaneous import is_over, unstable_edge
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.limit_point_search import LimitPointSearch, Point, expected_limit_point
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.rounding import rounded_length
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_error import REJECTED_ABOVE
from validation.reference.tracking.step_history import FORCE, RADIUS
from validation.reference.tracking.step_outcome import NO_STABLE_CONTACT, FrontCandidate, StepOutcome
from validation.reference.tracking.trial import Trial

AT_LIMIT_POINT = 1e-4
"""Travel, in largest travels, below which a limit point counts as reached if the step is not stable."""
PLACE_SHARE = 0.01
"""Accuracy to which a limit point is located, in deviations of the radius allowed in a step."""
STABILITY_PROBE = 1e-2
"""Distance beyond the end of a step, in its travel, at which the edge must still be driven on."""


def prescribed_travel(
    problem: FrontProblem,
    state: FrontState,
    trial: Trial,
    radius: float,
    longest: float,
    allowed: float,
) -> StepOutcome:
    """Step of an edge that would pass ``radius`` within ``longest``: find the time at which it does.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    trial : Trial
        Trial step from it.
    radius : float
        Radius at the end of the step.
    longest : float
        Longest duration of the step.
    allowed : float
        Deviations by which rows may leave a straight line.

    Returns
    -------
    StepOutcome
    """
    a0 = state.surface.radius
    arrivals = state.history.time_over_radius()
    if not problem.rated:
        trial = replace(trial, arrivals=arrivals)
    if radius == a0:
        return StepOutcome(longest, rejected=True, below_zone=a0 <= problem.condition.smallest_radius)
    extremum = state.history.distance_to_extremum(FORCE, RADIUS) / (radius - a0)
    if trial.segment.control != "force" and 0.1 < extremum < 1.0 and radius > problem.scene.bare_plane_tip:
        radius = a0 + rounded_length(extremum) * (radius - a0)
    h = trial.duration_to_radius(radius, longest, arrivals.value_after(radius - a0))
    probe = radius + STABILITY_PROBE * (radius - a0)
    if h is not None and h > 0.0:
        least = max(problem.condition.smallest_radius, problem.scene.bare_plane_tip)
        onwards = trial.residual(h, probe) if probe > least else 0.0
        if onwards * (radius - a0) >= 0.0:
            return _passing(problem, state, trial, radius, h, longest, allowed)
    if not problem.rated:
        onto = _onto_limit_point(problem, state, trial, radius if h is None else probe, longest, allowed)
        if onto is not None:
            return onto
    if abs(radius - a0) > AT_LIMIT_POINT * problem.longest_travel(a0):
        return StepOutcome(longest, rejected=True, travel=0.5 * abs(radius - a0))
    return _at_limit_point(problem, state, trial, radius, longest)


def _passing(
    problem: FrontProblem,
    state: FrontState,
    trial: Trial,
    radius: float,
    h: float,
    longest: float,
    allowed: float,
) -> StepOutcome:
    """The edge is at ``radius`` after ``h`` and moves on: accepted if the step is straight enough."""
    end = problem.candidate(state.time + h, trial.surface_at(h, radius))
    deviation = _deviation(problem, state, trial, end)
    travel = _next_travel(problem, state, radius, deviation)
    if deviation > REJECTED_ABOVE and radius > problem.scene.bare_plane_tip:
        return StepOutcome(longest, rejected=True, travel=travel)
    lost = NO_STABLE_CONTACT if radius == problem.scene.bare_plane_tip else ""
    below_zone = 0.0 < radius == problem.condition.smallest_radius
    travelled = radius - state.surface.radius
    points = [(travelled, h), *_points(state)]
    ahead = expected_limit_point(points, travelled, math.copysign(math.inf, travelled))
    if ahead is not None:
        end = _over_radius(problem, state, trial, end, abs(ahead[0] - travelled), allowed)
    return StepOutcome(1.5 * h, (end,), travel=travel, detachment=lost, below_zone=below_zone)


def _deviation(problem: FrontProblem, state: FrontState, trial: Trial, end: FrontCandidate) -> float:
    """Error of a step of prescribed distance, in allowed deviations."""
    estimator = problem.step_error(state, trial.segment, end)
    deviation = max(
        estimator.along_edge(end.row), estimator.of_load(end.row, problem.load_rate(state, trial.segment))
    )
    if problem.rated:  # nothing limits the speed but the time in which it changes
        deviation = max(deviation, estimator.in_time(end.row))
    return deviation


def _next_travel(problem: FrontProblem, state: FrontState, radius: float, deviation: float) -> float:
    """Largest travel of the next step, after one to ``radius`` of that deviation."""
    change = min(2.0, 0.95 / math.sqrt(max(deviation, 1e-6)))
    longest_travel = problem.longest_travel(state.surface.radius)
    travel = rounded_length(max(change, 0.2) * abs(radius - state.surface.radius), longest_travel)
    return min(longest_travel, travel)


def _onto_limit_point(
    problem: FrontProblem,
    state: FrontState,
    trial: Trial,
    far: float,
    longest: float,
    allowed: float,
) -> StepOutcome | None:
    """Step onto a limit point before ``far``; ``None`` without such a point.

    Rejected if its place is too far from that which the rows before show.
    """
    a0, points = state.surface.radius, _points(state)
    expected = expected_limit_point(points, 0.0, 2.0 * (far - a0))
    nearest = AT_LIMIT_POINT * problem.longest_travel(a0)
    close = PLACE_SHARE * problem.fineness.deviation * state.largest_radius
    found = LimitPointSearch(trial, points, far - a0, longest).find(nearest, close)
    if found is None:
        return None
    distance, h = found
    if expected is None:
        return StepOutcome(longest, rejected=True, travel=0.5 * abs(distance))
    end = problem.candidate(state.time + h, trial.surface_at(h, a0 + distance))
    place = problem.step_error(state, trial.segment, end).of_place(expected[0] - distance)
    deviation = max(_deviation(problem, state, trial, end), place)
    if deviation > REJECTED_ABOVE:
        travel = _next_travel(problem, state, a0 + distance, deviation)
        return StepOutcome(longest, rejected=True, travel=min(0.5 * abs(distance), travel))
    end = _over_radius(problem, state, trial, end, 0.0, allowed)
    return StepOutcome(candidates=(end,), unstable=math.copysign(1.0, distance))


def _points(state: FrontState) -> list[Point]:
    """Distance and duration to the last rows, the present one first."""
    rows = state.history.time_over_radius()
    return list(zip(rows.times, rows.values, strict=True))


def _over_radius(
    problem: FrontProblem,
    state: FrontState,
    trial: Trial,
    end: FrontCandidate,
    left: float,
    allowed: float,
) -> FrontCandidate:
    """A candidate with interpolated rows over the radius, ``left`` before a limit point."""
    estimator = problem.step_error(state, trial.segment, end)
    intervals = estimator.intervals_before_limit_point(end.row, left, allowed)
    return replace(end, intervals=intervals, to_limit_point=left)


def leave_limit_point(problem: FrontProblem, state: FrontState, segment: Segment) -> StepOutcome:
    """The unstable motion from a limit point that the last step ended at.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    segment : Segment
        Load step.

    Returns
    -------
    StepOutcome
    """
    end = unstable_edge(problem, state, problem.trial(state, segment), state.unstable > 0.0)
    travel = problem.longest_travel(state.surface.radius)
    if end is None:
        return StepOutcome(travel=travel, detachment=NO_STABLE_CONTACT)
    return StepOutcome(candidates=(end,), travel=travel, event=_jump_event(problem, state, end))


def _at_limit_point(
    problem: FrontProblem, state: FrontState, trial: Trial, radius: float, longest: float
) -> StepOutcome:
    """No step towards ``radius`` is stable, however short: the edge is unstable."""
    a0 = state.surface.radius
    outward = _runs_outward(problem, state, trial, radius)
    end = unstable_edge(problem, state, trial, outward)
    travel = problem.longest_travel(a0)
    if end is None:
        return StepOutcome(longest, rejected=True, travel=travel, detachment=NO_STABLE_CONTACT)
    if end.surface.radius == a0:  # the edge is stable for now, but not for so long
        tick = 4.0 * math.ulp(state.time)
        if longest > tick:
            return StepOutcome(max(0.25 * longest, tick), (end,), True, travel)
        late = problem.candidate(state.time + longest, trial.surface_at(longest, a0))
        return StepOutcome(longest, (end, late), True, travel)
    return StepOutcome(longest, (end,), True, travel, event=_jump_event(problem, state, end))


def _jump_event(problem: FrontProblem, state: FrontState, end: FrontCandidate) -> Event | None:
    """The event that an unstable motion of the edge is, if it is longer than a step."""
    a0, radius = state.surface.radius, end.surface.radius
    if abs(radius - a0) <= problem.longest_travel(a0) or not isinstance(problem.condition, Griffith):
        return None
    kind = "snap-in" if radius > a0 else "pull-off"
    return Event(kind, state.time, state.surface.penetration, state.force, a0)


def _runs_outward(problem: FrontProblem, state: FrontState, trial: Trial, radius: float) -> bool:
    """Whether an unstable edge runs outward: towards ``radius``, or on in its last direction.

    The latter if both directions are open: the edge is slightly beyond a limit point, where a step back may
    be noise.
    """
    a0 = state.surface.radius
    opposite = 2.0 * a0 - radius
    smallest = problem.condition.smallest_radius
    if state.last_displacement != 0.0 and smallest < opposite < problem.edge_radius:
        residual, tolerance = trial.residual(0.0, opposite), problem.condition.tolerance
        if (residual < -tolerance) if opposite > a0 else (residual > tolerance):
            return state.last_displacement > 0.0
    return radius > a0


def approach_zero_radius(
    problem: FrontProblem, state: FrontState, segment: Segment, longest: float, allowed: float
) -> StepOutcome:
    """Without adhesion the contact shrinks to a point, or to a plane tip, as the force goes to zero.

    Parameters
    ----------
    problem, state : FrontProblem, FrontState
        Present state.
    segment : Segment
        Load under force control.
    longest : float
        Duration within which the force becomes zero.
    allowed : float
        Deviations by which rows may leave a straight line.

    Returns
    -------
    StepOutcome
    """
    ends = [segment.value(state.time), segment.value(state.time + longest)]
    h = longest * ends[0] / (ends[0] - ends[1])
    trial = problem.trial(state, segment)
    a0, least = state.surface.radius, problem.scene.bare_plane_tip
    if a0 - state.travel > least:
        outcome = prescribed_travel(problem, state, trial, a0 - state.travel, h, allowed)
        latest = state.time + h - 4.0 * math.ulp(state.time)  # then the force is zero, but for rounding
        if not any(one.time >= latest or is_over(problem, state, one) for one in outcome.candidates):
            return outcome
    end = problem.candidate(state.time + h, trial.surface_at(h, min(a0, least)))
    return StepOutcome(h, (end,), detachment=NO_STABLE_CONTACT)
