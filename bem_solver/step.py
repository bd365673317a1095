"""A trial step on graded annuli: a candidate for the next state, or why there is none.

Where the edge would go further than its travel limit, the shorter step that takes it just there is sought
instead. A step may end on a limit point, where the residual over the edge touches zero: a row at which it
merely is zero lies before that, by the root of what the load still lacks, but the place of the extremum is
where the derivative vanishes, and does not suffer from that. Nothing is committed here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache
from typing import NamedTuple

from scipy.optimize import brentq

from bem_solver.control import AcceptedRow, StepStart, least_bent_travel, step_error, until_largest_tension
from bem_solver.equilibrium import RootSearchResult, rising_root
from bem_solver.motion import EarlierRow, OuterFall
from bem_solver.problem import closure_of_departure
from bem_solver.surface import speed_jump_between
from bem_solver.trial import EDGE_ACCURACY, TrialContact, evaluate
from contact_scene import Trigger

_CLOSURE_ACCURACY = 1e-2
"""Accuracy of the closure, in step tolerances of the work of adhesion: far below the step error."""
_SHARE_OF_STEP = 0.4
"""Least time between the rows of a parabola, in the step it is to tell of: steps double at most."""


@dataclass(frozen=True)
class FailedStep:
    """No stable edge within the travel limit, neither at the end of a step nor at the load of its start.

    ``way`` is the distance of the edge from where it will run away, as far as the trials tell; ``unstable``:
    at the limit there is an equilibrium, but not a stable one.
    """

    receding: bool
    way: float
    unstable: bool = False


@dataclass(frozen=True)
class Candidate:
    """A trial that satisfies the closure, the parameter it was reached at, and its error in tolerances.

    ``slope`` is the derivative of the residual with the edge; zero if unknown. ``speed_jumps``: that of the
    edge does there, as where a pinned one sets out.
    """

    parameter: float
    trial: TrialContact
    error: float
    slope: float = 0.0
    speed_jumps: bool = False


_NEAR = 0.1
"""Way to a limit point, in process zones, within which the next step ends on it, if the edge may go so far.
The residual is looked at up to a quarter of it on both sides: over that it is a parabola, but for some
1e-5 of the radius in the place of the extremum; over less, what annuli make of old kinks moves it by more."""
_LEFT = 1e-5
"""Time to it, in the shortest relaxation time, within which the next step ends on it. What creeps in a
hundred times as long moves it by a hundredth of the way."""
_FARTHEST = 4.0
"""Distance of the extremum, in the way that was expected, from which on another one was meant."""
_SECANTS, _ZERO = 8, 1e-11
"""Secants for the instant, and the residual, relative to the work of adhesion, that ends them: less than that
of the unstable edge a smallest travel beyond the limit point."""


class Extremum(NamedTuple):
    """Place ``x`` of the smallest value, of a function that rises on both sides, and that ``value``."""

    x: float
    value: float


def smallest(function: Callable[[float], float], middle: float, stride: float) -> Extremum | None:
    """Smallest value of a function, by the parabola through three equidistant places."""
    before, at, after = (function(middle + n * stride) for n in (-1, 0, 1))
    bend = before - 2.0 * at + after
    if not bend > 0.0:
        return None
    share = 0.5 * (before - after) / bend
    return Extremum(middle + share * stride, at - 0.5 * share**2 * bend)


def near_limit_point(start: StepStart) -> bool:
    """Whether a limit point is so near that the next step may end on it."""
    problem, accepted, interval = start.problem, start.state.accepted, start.interval
    if problem.work == 0.0 or problem.rated or interval.jump or interval.trigger is not None:
        return False
    advancing = accepted.rates(0.0)[0] > 0.0
    reach = problem.longest_travel(start.state.contact.edge, advancing) / start.problem.divisions
    if not 0.0 < accepted.way_to_limit_point() < min(_NEAR * problem.zone, reach):
        return False
    left = accepted.step_to_limit_point()
    if left > _LEFT * problem.chain.relaxation.min(initial=math.inf):
        return False
    return until_largest_tension(start, left) == math.inf


def to_limit_point(step: TrialStep) -> Candidate | None:
    """The step that ends on a limit point ahead."""
    accepted, begin = step.state.accepted, step.state.parameter
    edge, sign = step.state.contact.edge, math.copysign(1.0, accepted.rates(0.0)[0])
    half, trial = 0.5 * _NEAR * step.problem.zone, cache(step.trial)

    def driven(parameter: float, x: float) -> float:
        """How strongly the edge is driven on, negative where it is held, in works of adhesion."""
        return -sign * trial(parameter, x).residual / step.problem.work

    def extremum(parameter: float, way: float, stride: float) -> Extremum | None:
        return smallest(lambda way: driven(parameter, edge + sign * way), way, stride)

    way = max(accepted.way_to_limit_point(), half)  # an edge that turns round there covers what it has left
    expected = extremum(begin, way, half)
    if expected is None or expected.value >= 0.0 or not 0.0 < expected.x < _FARTHEST * way:
        return None
    left, place = accepted.step_to_limit_point(), edge + sign * expected.x
    parameter = _zero(lambda at: driven(at, place), begin, expected.value, left)
    if parameter is None or not begin < parameter <= step.interval.length:
        return None
    there = extremum(parameter, expected.x, min(0.5 * half, expected.x))  # the load has moved it, too
    if there is None:
        return None
    new_edge, more = edge + sign * there.x, (parameter - begin) * there.value / expected.value
    parameter = _zero(lambda at: driven(at, new_edge), parameter, there.value, more)
    if parameter is None or not begin + step.shortest_step <= parameter <= step.interval.length:
        return None
    return Candidate(parameter, trial(parameter, new_edge), 0.0)


def _zero(function: Callable[[float], float], x: float, value: float, stride: float) -> float | None:
    """Zero of a nearly straight function by secants; at ``x`` it has a ``value``, the next is a stride on."""
    for _ in range(_SECANTS):
        new_x = x + stride
        new = function(new_x)
        if abs(new) <= _ZERO:
            return new_x
        if new == value:
            return None
        stride *= new / (value - new)
        x, value = new_x, new
    return None


_HALVINGS = 1100
"""Trials that find any share of a step: halvings from one down to the smallest number."""


def to_travel_limit(
    step: TrialStep, receding: bool, edge: float, root: RootSearchResult
) -> Candidate | FailedStep:
    """The shorter step that takes the edge to its travel limit, if it is stable there."""
    start, beyond = step.state.parameter, root.trial
    known = {1.0: beyond, 0.0: step.trial(start, edge)}

    def residual(share: float) -> float:
        if share not in known:
            known[share] = step.trial(start + share * step.step, edge)
        return known[share].residual

    shortest = min(step.shortest_step / step.step, 1.0)
    if (residual(shortest) > 0.0) == (beyond.residual > 0.0):
        if (residual(0.0) > 0.0) == (beyond.residual > 0.0):
            return FailedStep(receding, _way_to_limit_point(step, edge, residual(0.0)))
        # within rounding of the time it goes at least so far
        parameter = min(start + step.shortest_step, step.interval.length)
        return Candidate(parameter, step.trial(parameter, edge), 0.0)
    share = brentq(residual, shortest, 1.0, xtol=1e-300, rtol=step.closure_accuracy, maxiter=_HALVINGS)
    parameter = start + share * step.step
    trial = known[share]
    inward = step.trial(parameter, edge - 0.01 * step.reach(not receding))
    if inward.residual > trial.residual:
        return FailedStep(receding, _way_to_limit_point(step, edge, residual(0.0)), True)
    error = step_error(step, trial, parameter - start)
    return Candidate(parameter, trial, error, root.slope)


def _way_to_limit_point(step: TrialStep, far: float, residual: float) -> float:
    """Distance of the edge from where it will run away; zero if it is within the smallest travel."""
    edge = step.state.contact.edge
    reach, near = abs(far - edge), 2.0 * step.smallest_travel
    if reach <= near:
        return math.inf
    sign = math.copysign(1.0, far - edge)
    drop = sign * step.trial(step.state.parameter, edge + sign * near).residual / near
    if drop <= 0.0:
        return 0.0
    bend = (drop - sign * residual / reach) / (reach - near)
    return 0.5 * (near + drop / bend) if bend > 0.0 else math.inf


def at_rest(step: TrialStep, driven: Callable[[TrialContact], float], known: float) -> Candidate | None:
    """A step of an edge at rest, up to where it is driven to set out; ``None`` if it is from the start."""
    start, edge = step.state.parameter, step.state.contact.edge
    trial = step.trial(step.end, edge)
    if driven(trial) <= 0.0:
        return step.ending(trial)
    if driven(step.trial(start, edge)) >= -known:
        return None
    end = brentq(lambda p: driven(step.trial(p, edge)), start, step.end, xtol=1e-14 * step.end, rtol=1e-14)
    if end <= start:
        return None
    trial = step.trial(end, edge)
    return Candidate(end, trial, step_error(step, trial, end - start))


def pinned(step: TrialStep) -> Candidate | float:
    """A step of an edge at rest, up to where it sets out; if it moves at once, how strongly it would open."""
    edge, adhesion, last = step.state.contact.edge, step.problem.irreversible, step.state.contact.last_step
    assert adhesion is not None
    trial = step.trial(step.end, edge)
    departure = closure_of_departure(adhesion, trial.closure, step.interval.jump)
    if departure is None:
        return step.ending(trial)
    way = math.copysign(1.0, departure - trial.closure)
    goes_on = last is not None and way * (edge - last[1]) > 0.0
    if not goes_on:
        resting = at_rest(step, lambda at: way * (1.0 - at.closure / departure), step.closure_accuracy)
        if resting is not None:
            return replace(resting, speed_jumps=True)
    return trial.closure - adhesion.work


def to_level(step: TrialStep, trigger: Trigger, candidate: Candidate) -> tuple[Candidate, bool]:
    """The candidate of the step that ends at the level, if this one passes it, and whether it does."""
    contact, begin = step.state.contact, step.state.parameter
    before = trigger.excess(contact.penetration, contact.surface.force, contact.edge)

    def beyond(at: Candidate) -> float:
        motion = at.trial.motion
        return trigger.excess(motion.new_penetration, at.trial.surface.force, motion.new_edge)

    if before * beyond(candidate) > 0.0:
        return candidate, False
    taken = candidate.parameter - begin

    def shorter(length: float) -> Candidate:
        """The candidate of a shorter step; where it has none at its end, the one beyond the level."""
        result = candidate if length == taken else replace(step, step=length).result()
        if isinstance(result, Candidate) and result.parameter >= begin + length:
            return result
        return candidate

    def excess(length: float) -> float:
        return beyond(shorter(length)) if length > 0.0 else before

    return shorter(float(brentq(excess, 0.0, taken, xtol=1e-14 * taken, rtol=1e-15))), True


@dataclass(frozen=True)
class TrialStep(StepStart):
    """A step of length ``step`` from the committed state along a loading interval: its end is sought.

    Where the edge would go further than its travel limit, or inside the process zone, the shorter step that
    takes it just there is sought instead. An edge turns only if the residual asks for it where it stands:
    just beyond the place where it would turn the annuli do not resolve what it covers, and where the residual
    hardly rises with the edge, as before a limit point, that makes a false root.
    """

    step: float
    _trials: dict[float, Callable[[float], TrialContact]] = field(
        init=False, compare=False, default_factory=dict
    )

    @property
    def end(self) -> float:
        """Parameter at the end; that of the interval exactly."""
        parameter, length = self.state.parameter, self.interval.length
        return length if self.step == length - parameter else parameter + self.step

    @property
    def edge_accuracy(self) -> float:
        """Accuracy of the edge."""
        return EDGE_ACCURACY * self.problem.tolerance * self.problem.length_at(self.state.contact.edge)

    @property
    def closure_accuracy(self) -> float:
        """Accuracy of the closure, relative to the work of adhesion."""
        return _CLOSURE_ACCURACY * self.problem.tolerance

    @property
    def residual_accuracy(self) -> float:
        """Accuracy of the residual; without adhesion it has none."""
        return self.closure_accuracy * self.problem.work or math.inf

    def trial(self, parameter: float, edge: float) -> TrialContact:
        """The trial that ends at a parameter within the step, with the edge at ``edge``."""
        if parameter not in self._trials:
            self._trials[parameter] = self._trials_at(parameter)
        return self._trials[parameter](edge)

    def _trials_at(self, parameter: float) -> Callable[[float], TrialContact]:
        """The trials that end at a parameter, which have all but the edge in common."""
        interval, start = self.interval, self.state.parameter
        duration = 0.0 if interval.jump else interval.time(parameter) - self.state.contact.time
        within = None
        if interval.control == "penetration" and duration > 0.0:
            share = self.problem.chain.share_to_meet(duration)
            within = share * duration, interval.prescribed(start + share * (parameter - start))
        given = interval.control, interval.prescribed(parameter), self._earlier(duration), within
        return lambda edge: evaluate(self.problem, self.state.contact, duration, edge, *given)

    def _earlier(self, duration: float) -> EarlierRow | None:
        """The row before the last, with its edge where the step is long enough for a curved path.

        Over less the condition at the end is one on the place of the edge, and its path is straight.
        """
        rows, edge = self.state.accepted.rows, self.state.contact.edge
        if duration == 0.0 or len(rows) < 2 or not self.problem.viscoelastic:
            return None
        before, last = rows[-2:]
        travel = abs(last.edge - before.edge) / (last.parameter - before.parameter) * duration
        if not self.problem.curves or travel < least_bent_travel(self, edge):
            return self._as_earlier(self.state.accepted.earlier(_SHARE_OF_STEP * duration))
        curved, runs_away = self._as_earlier(before), self.state.accepted.runs_away
        fall = OuterFall.outside(self.state.contact.surface, self.problem.nearest)
        return replace(curved, load=before.edge_load, ahead=0.0, fall=fall, runs_away=runs_away)

    def _as_earlier(self, row: AcceptedRow) -> EarlierRow:
        """An accepted row as the earlier one of a parabola."""
        interval, time = self.interval, self.state.accepted.rows[-1].parameter - row.parameter
        penetration = row.load if interval.control == "force" else interval.prescribed(row.parameter)
        if interval.control == "stage":
            penetration -= self.problem.scene.loading.compliance * row.load
        if not self.problem.curves:
            return EarlierRow(time, penetration)
        return EarlierRow(time, penetration, row.edge, row.load_ahead, self.problem.ahead)

    def result(self) -> Candidate | FailedStep:
        """The candidate, or why there is none."""
        problem, state = self.problem, self.state
        edge, limit = state.contact.edge, problem.scene.indenter.edge
        low = max(edge - self.reach(advancing=False), 0.25 * edge, problem.zone)
        if problem.scene.bare_plane_tip < edge:
            low = max(low, problem.scene.bare_plane_tip)
        high = min(edge + self.reach(advancing=True), limit)
        if edge == limit:
            known = max(1e-6 * self.trial(self.end, edge).residual, self.closure_accuracy * problem.work)
            resting = at_rest(self, lambda at: at.residual, known)
            if resting is not None:
                return resting
        if problem.irreversible is not None:
            opening = pinned(self)
            if isinstance(opening, Candidate):
                return opening
            low, high = (low, edge) if opening > 0.0 else (edge, high)
        at_end = cache(lambda at: self.trial(self.end, at))
        expected = self._expected_edge()
        if expected == edge and self._hardly_turns(at_end(edge).residual):
            return self.ending(at_end(edge))
        root = self._root(at_end, expected, low, high)
        if (root.x - edge) * state.contact.history.direction < 0.0:
            excess = at_end(edge).residual
            if self._hardly_turns(excess):
                return self.ending(at_end(edge))
            if (root.x - edge) * excess > 0.0:
                low, high = (low, edge) if excess > 0.0 else (edge, high)
                root = self._root(at_end, edge, low, high)
        if root.position == "converged" and 0.0 < root.x - edge <= self.edge_accuracy:
            return self.ending(at_end(edge), root.slope)
        if root.position == "converged" or (root.position == "above" and high == limit):
            return self.ending(root.trial, root.slope)
        receding = root.position == "below"
        return to_travel_limit(self, receding, low if receding else high, root)

    def ending(self, trial: TrialContact, slope: float = 0.0) -> Candidate:
        """The candidate of the whole step."""
        return Candidate(self.end, trial, step_error(self, trial, self.step, slope), slope)

    def to_speed_jump(self, candidate: Candidate) -> Candidate | None:
        """A shorter step than a candidate's, to the first radius on its way at which its speed may jump."""
        contact, problem = self.state.contact, self.problem
        edge, new_edge, zone = contact.edge, candidate.trial.motion.new_edge, candidate.trial.zone
        if problem.work == 0.0:
            return None
        radius = speed_jump_between(contact.history.past_kinks, zone, edge, new_edge, self.edge_accuracy)
        if radius is None:
            return None
        if abs(radius - edge) <= self.edge_accuracy:
            return replace(candidate, parameter=self.state.parameter, error=0.0, speed_jumps=True)
        step = replace(self, step=candidate.parameter - self.state.parameter)
        beyond = step.trial(candidate.parameter, radius)
        root = RootSearchResult("converged", radius, beyond, 0.0)
        result = to_travel_limit(step, new_edge < edge, radius, root)
        return replace(result, speed_jumps=True) if isinstance(result, Candidate) else None

    def _root(
        self, at_end: Callable[[float], TrialContact], guess: float, low: float, high: float
    ) -> RootSearchResult:
        """Search for the edge at the end of the step."""
        slope, accuracy, residual = self.state.slope, self.edge_accuracy, self.residual_accuracy
        return rising_root(at_end, guess, slope, low, high, accuracy, residual)

    def _hardly_turns(self, excess: float) -> bool:
        """Whether the residual where the edge stands asks it to turn, but for no more than it is known."""
        known = min(self.state.slope * self.edge_accuracy, self.residual_accuracy)
        return 0.0 < excess * self.state.contact.history.direction <= known

    def _expected_edge(self) -> float:
        """Edge to start the search from: extrapolated, but the present one if the parabola turns round."""
        accepted, edge = self.state.accepted, self.state.contact.edge
        expected = accepted.edge_after(self.step)
        if abs(expected - edge) >= least_bent_travel(self, edge):
            expected = accepted.expected_edge(self.step)
        goes_on = (expected - edge) * accepted.rates(0.0)[0] > 0.0
        return expected if goes_on and abs(expected - edge) >= self.edge_accuracy else edge
