"""What a step ends at, seen ahead on the predictor, and what follows from having got there.

- the end of the leg;
- a turn of the edge; the start of one that has rested;
- a fold: the load parameter has a maximum over the radius. It is approached from this side and landed on
  when its place no longer changes; there the contact jumps to another radius, or is lost;
- the smallest contact that is followed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.numerics import bracketed
from validation.reference.path.tracker import FIRST_STEP, SMALL_PART, Correction, Ending, Fixed, Plan, Tracker
from validation.reference.path.trial import Arrival, Trial

Array = NDArray[np.float64]

MOVING = 3e-3
"""Share of the radius in the direction of the path from which on a step ends at a radius."""
AFTER_TURN = 0.1
"""First step after a turn, in the step before."""
AHEAD = 1.5
"""How far beyond a step, in its way, a turn or fold is looked for."""
SAME_FOLD = 0.1
"""Change of the place of a fold foreseen, in tolerances, below which it is landed on."""
REPEATED = 1e-8
"""Residual that the row of one step may leave in the next, whose closure has other breaks."""
TOWARDS_FOLD = 0.75
"""Share of the way to a fold that a step goes until the place of the fold is known."""
FILLED = 1.0 - 1e-5
"""Zone of fixed stress, in the contact radius, at which the contact ends."""
LARGEST_JUMP = 1e4
"""Radius up to which a stable contact is looked for, in that at which one runs away."""
SAME = 1.0 - 1e-6
"""Ratio of two drives that are the same."""


def to_level(tracker: Tracker, planned: Plan, correction: Correction) -> Correction:
    """The step cut where the path comes to the level, or its zone fills the contact."""
    level = tracker.level if tracker.leg.timed else None

    def excess(trial: Trial, arrival: Arrival) -> tuple[float, Ending]:
        found = [(-math.inf, Ending.NONE)]
        if level is not None:
            force = trial.force_at(arrival)
            found.append((level(arrival.depth, force, trial.radius), Ending.LEVEL))
        if trial.cohesive:
            zone = trial.zone_at_stress(arrival.motion)
            found.append((zone / trial.radius - FILLED, Ending.LEAST))
        return max(found)

    if excess(correction.trial, correction.arrival)[0] < 0.0:
        return correction

    def along(u: float) -> float:
        return excess(*correction.trial.part(u, correction.arrival))[0]

    at = bracketed(along, 1e-9, 1.0, 1e-13) if along(1e-9) < 0.0 < along(1.0) else 1.0
    part, end = correction.trial.part(at, correction.arrival)
    planned.event = excess(part, end)[1]
    return replace(correction, trial=part, arrival=end, s=at * correction.s)


def departure(pull: Callable[[float], float], end: float, narrow: float) -> float:
    """The least rise at which a resting edge sets off: by halves, as the pull is zero before."""
    low, high = 0.0, end
    while high - low > max(narrow, 2.0 * math.ulp(high)):
        middle = 0.5 * (low + high)
        if pull(middle) == 0.0:
            low = middle
        else:
            high = middle
    return high


def plan(tracker: Tracker) -> Plan:
    """The next step, shortened to the first event on its way."""
    coefficients = tracker.rows.predictor(tracker.T, tracker.L, tracker.depth, tracker.tangent)
    orders = np.arange(len(coefficients))
    end = (tracker.leg.end - tracker.state.parameter) / tracker.T
    m = tracker.rows.order

    def place(h: float) -> Array:
        return h**orders @ coefficients

    def slope(h: float) -> Array:
        return h ** orders[:-1] @ (orders[1:, None] * coefficients[1:])

    def made(h: float, event: Ending = Ending.NONE, fixed: Fixed | None = None) -> Plan:
        there, tangent = place(h), slope(h)
        tangent = tangent / np.hypot(*tangent[:2])
        if fixed is None:
            moves = abs(tangent[1]) > MOVING and abs(there[1]) * tracker.L > tracker.still
            fixed = Fixed.RADIUS if moves else Fixed.LOAD
        return Plan(h, there, tangent, fixed, event)

    h, first = tracker.h, slope(0.0)
    resting = tracker.law.rests(tracker.state.radius) and not tracker.moving
    last = place(h)
    if last[0] >= end - 1e-9 * h:
        if m > 1 and last[0] > end > 0.0:
            h = bracketed(lambda x: place(x)[0] - end, 0.0, h)
        planned = made(h, Ending.END, Fixed.REST if resting else Fixed.LOAD)
        planned.z[0] = end
    elif resting:
        return made(h, fixed=Fixed.REST)
    elif m > 1 and 1.3 * last[0] > end:
        planned = made(0.6 * h)
    else:
        planned = made(h)
    if resting:
        return planned
    if m > 2:
        planned = _turn_or_fold(tracker, planned, made, place, slope, first)
    bound = _bound(tracker, planned.z[1] * tracker.L)
    if bound is not None:
        kind, travel = bound
        h, along = planned.h, lambda x: place(x)[1] * tracker.L - travel
        if along(0.0) * along(h) < 0.0:
            h = bracketed(along, 0.0, h)
        planned = made(h, kind, Fixed.RADIUS)
        planned.z[1] = travel / tracker.L
    return planned


def _turn_or_fold(
    tracker: Tracker,
    planned: Plan,
    made: Callable[..., Plan],
    place: Callable[[float], Array],
    slope: Callable[[float], Array],
    first: Array,
) -> Plan:
    h = planned.h
    ahead = slope(AHEAD * h)
    if abs(first[1]) > 1e-5 and first[1] * ahead[1] < 0.0:
        at = bracketed(lambda x: slope(x)[1], 0.0, AHEAD * h)
        if at > h:
            return made(0.6 * at)
        if place(at)[0] > 0.0:
            return made(at, Ending.TURN, Fixed.LOAD)
    if planned.fixed is Fixed.RADIUS and first[0] > 0.0 > ahead[0] and (tracker.law.folds or first[1] > 0.0):
        at = bracketed(lambda x: slope(x)[0], 0.0, AHEAD * h)
        vertex, before = float(place(at)[1]) * tracker.L, tracker.vertex
        tracker.vertex = vertex
        seen = REPEATED / abs(tracker.slopes.get(Fixed.RADIUS, math.inf))
        unseen = (8.0 * math.ulp(tracker.state.parameter) + seen) / tracker.T
        if abs(vertex - before) < SAME_FOLD * tracker.tolerance * tracker.L or place(at)[0] < unseen:
            return made(at, Ending.FOLD, Fixed.RADIUS)
        return made(min(h, TOWARDS_FOLD * at), Ending.TOWARDS if TOWARDS_FOLD * at < h else Ending.NONE)
    return planned


def _bound(tracker: Tracker, travel: float) -> tuple[Ending, float] | None:
    """The smallest or the largest radius, if a step goes beyond, and how far away it is."""
    radius, least, rim = tracker.state.radius, tracker.least_radius, tracker.law.rim
    if travel < 0.0 and radius + travel < least:
        return Ending.LEAST, least - radius
    if travel > 0.0 and radius + travel > rim * (1.0 + 1e-12):
        return Ending.RIM, rim - radius
    return None


def finish(tracker: Tracker, planned: Plan, correction: Correction) -> None:
    """Take a step, and what its event asks for next."""
    accept(tracker, correction)
    h = planned.h
    if tracker.state.parameter >= tracker.leg.end * (1.0 - 1e-14) and planned.event is not Ending.LEVEL:
        planned.event = Ending.END  # an event that rounds onto it
    match planned.event:
        case Ending.TURN:
            tracker.turn_at(AFTER_TURN * h)
        case Ending.DEPARTURE:
            if tracker.state.radius == 0.0:
                tracker.touch()
                return
            pulled = tracker.law.pulls(correction.trial, correction.arrival, not tracker.leg.timed)
            tracker.direction = -1.0 if pulled >= 0.0 else 1.0
            if tracker.direction < 0.0 and tracker.state.radius <= tracker.least_radius:
                planned.event = Ending.LEAST
                return
            way = np.array([0.0, tracker.direction])
            if tracker.law.rated and tracker.direction > 0.0:  # its drive may be lost in rounding
                tracker.restart()
            else:
                tracker.restart(way, FIRST_STEP * tracker.least_scale / tracker.L)
            tracker.moving = True
            if runs_away(tracker):
                planned.event = Ending.FOLD
        case Ending.RIM:
            tracker.restart()
        case Ending.TOWARDS:
            tracker.h = h
        case _:
            pass


def accept(tracker: Tracker, correction: Correction) -> None:
    """Commit a step."""
    state = correction.trial.state_after(correction.arrival)
    tracker.accepted(correction.trial, correction.arrival, state, correction.s)
    rise, travel = correction.arrival.rise, correction.trial.travel
    tracker.rows.append(correction.s, rise, travel, state.depth, state.force)
    tracker.state = state
    tracker.lasted, tracker.travelled = tracker.lasted + rise, tracker.travelled + travel
    tracker.vertex -= travel
    tracker.depth = max(tracker.depth, SMALL_PART * abs(state.depth))
    tracker.zone = correction.trial.zone
    tracker.steps += 1
    if correction.trial.direction:
        tracker.moving, tracker.direction = True, correction.trial.direction


def runs_away(tracker: Tracker, known: float = 0.0) -> bool:
    """Whether an edge that sets off, or has come to a kink, is driven the more the farther it gets.

    ``known``: how well its place is.
    """
    state = tracker.state
    values = []
    for share in (0.01, 0.02):
        travel = tracker.direction * max(share * (tracker.law.zone or state.radius), 100.0 * share * known)
        trial = tracker.trial(travel, share, 1)
        values.append(tracker.residual(trial, 0.0)[0] * tracker.direction)
    return values[0] < 0.0 and values[1] < SAME * values[0]


def unstable(tracker: Tracker) -> bool:
    """Whether a contact that another control held runs away under this one, where the load drives it."""
    state = tracker.state
    if state.radius == 0.0 or tracker.law.adhesion is None or tracker.law.rests(state.radius):
        return False
    here = tracker.trial(0.0, tracker.h, 1)
    start, soon = (tracker.residual(here, rise)[0] for rise in (0.0, tracker.h * tracker.T))
    tracker.direction = 1.0 if soon < start else -1.0
    return runs_away(tracker)


def lost(tracker: Tracker, at_fold: bool) -> bool:
    """Whether there is no other stable edge at the same load; if there is, the contact goes there."""
    tracker.restart()
    state, zone = tracker.state, tracker.law.zone
    a, way = state.radius, tracker.direction
    least = tracker.least_radius
    ends = {}

    def residual(travel: float) -> float:
        trial = tracker.trial(travel, abs(travel) / tracker.L, 1)
        value, arrival = tracker.residual(trial, 0.0)
        ends[travel] = trial, arrival
        filled = trial.cohesive and trial.zone > FILLED * trial.radius
        return math.nan if filled else value  # no contact is followed there

    if at_fold:
        first = way * max(0.05 * zone, 1e-3 * a)
    else:  # what a row has left of the residual may drive the edge either way
        sides = way * tracker.still, -way * tracker.still
        first = next((side for side in sides if a + side > least and residual(side) * side < 0.0), sides[0])
        way = math.copysign(1.0, first)
    before = first, residual(first) if a + first > least else math.nan
    if before[1] * way > 0.0:
        if tracker.stuck_at == tracker.steps:
            return True
        tracker.stuck_at = tracker.steps
        return False
    travels = (
        (least - a) * np.linspace(0.0, 1.0, 17)[1:] ** 1.5
        if way < 0.0
        else a * (np.geomspace(1.0, LARGEST_JUMP, 129)[1:] - 1.0)
    )
    for travel in travels[way * (travels - first) > 0.0].tolist():
        value = residual(travel)
        if before[1] * way < 0.0 <= value * way:
            at = bracketed(residual, before[0], travel, 1e-14 * a)
            residual(at)
            trial, arrival = ends[at]
            accept(tracker, Correction(trial, arrival, 0.0, abs(at) / tracker.L))
            tracker.restart()
            return False
        before = travel, value
    return True
