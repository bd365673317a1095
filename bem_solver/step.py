"""A trial step on graded annuli: a candidate for the next state, or why there is none.

Nothing is committed here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum, auto
from functools import cache, cached_property
from typing import NamedTuple

from scipy.optimize import brentq

from bem_solver.bent_path import EarlierRow
from bem_solver.edge_energy import closure_of_departure
from bem_solver.kinks import speed_jump_between
from bem_solver.outer_fall import OuterFall
from bem_solver.root_search import RootSearchResult, rising_root
from bem_solver.run_state import StepStart
from bem_solver.step_control import AcceptedRow
from bem_solver.step_error import error_at_limit, least_bent_travel, step_error
from bem_solver.trial import EDGE_ACCURACY, TrialContact, evaluate

_RESIDUAL_ACCURACY = 1e-2
"""Accuracy of the closure, in step tolerances of the work of adhesion: far below the step error."""
_SHARE_OF_STEP = 0.4
"""Least time between the rows of a parabola, in the step it is to tell of: steps double at most."""
_HALVINGS = 1100
"""Trials that find any share of a step: halvings from one down to the smallest number."""


class StepFailure(Enum):
    """Why a trial step has no candidate."""

    BEYOND_TRAVEL_LIMIT = auto()
    """Even at the load of the start, the edge goes beyond its travel limit."""
    UNRESOLVED = auto()
    """The edge passes its travel limit after a time below the rounding of the parameter."""
    UNSTABLE = auto()
    """The edge at the travel limit is in equilibrium, but not a stable one."""


@dataclass(frozen=True)
class FailedStep:
    """A trial step without candidate; ``travel`` is how far the edge would have moved.

    ``way`` is the distance of the edge from where it will run away, as far as the trials tell.
    """

    failure: StepFailure
    receding: bool
    way: float = math.inf
    travel: float = 0.0


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


class _StepEnd(NamedTuple):
    """End of a trial step but for the edge, as :func:`~bem_solver.trial.evaluate` takes it."""

    duration: float
    value: float
    earlier: EarlierRow | None
    within: tuple[float, float] | None


@dataclass(frozen=True)
class TrialStep(StepStart):
    """A step of length ``step`` from the committed state along a loading interval.

    Where the edge would go further than its travel limit, or inside the process zone, the shorter step that
    takes it just there is sought instead. An edge turns only if the residual asks for it where it stands:
    just beyond the place where it would turn the annuli do not resolve what it covers, and where the residual
    hardly rises with the edge, as before a limit point, that makes a false root.
    """

    step: float
    _ends: dict[float, _StepEnd] = field(init=False, compare=False, default_factory=dict)

    @property
    def end(self) -> float:
        """Parameter at the end; that of the interval exactly."""
        parameter, length = self.state.parameter, self.interval.length
        return length if self.step == length - parameter else parameter + self.step

    @property
    def accuracy(self) -> float:
        """Accuracy of the edge."""
        return EDGE_ACCURACY * self.settings.tolerance * self.problem.length_at(self.state.contact.edge)

    def result(self) -> Candidate | FailedStep:
        """The candidate, or why there is none."""
        problem, state = self.problem, self.state
        edge, limit = state.contact.edge, problem.scene.indenter.edge
        low = max(edge - self.reach(advancing=False), 0.25 * edge, problem.zone)
        if problem.plane_tip < edge:
            low = max(low, problem.plane_tip)
        high = min(edge + self.reach(advancing=True), limit)
        if edge == limit:
            resting = self._in_full_contact()
            if resting is not None:
                return resting
        if problem.irreversible is not None:
            pinned = self._pinned()
            if isinstance(pinned, Candidate):
                return pinned
            low, high = (low, edge) if pinned > 0.0 else (edge, high)
        at_end = cache(lambda at: self.trial(self.end, at))
        expected = self._expected_edge()
        if expected == edge and self._hardly_turns(at_end(edge).residual):
            return self._ending(at_end(edge))
        root = self._root(at_end, expected, low, high)
        if (root.x - edge) * state.contact.history.direction < 0.0:
            excess = at_end(edge).residual
            if self._hardly_turns(excess):
                return self._ending(at_end(edge))
            if (root.x - edge) * excess > 0.0:
                low, high = (low, edge) if excess > 0.0 else (edge, high)
                root = self._root(at_end, edge, low, high)
        if root.position == "converged" and 0.0 < root.x - edge <= self.accuracy:
            return self._ending(at_end(edge), root.slope)
        if root.position == "converged" or (root.position == "above" and high == limit):
            return self._ending(root.trial, root.slope)
        receding = root.position == "below"
        return self._to_travel_limit(receding, low if receding else high, root)

    def _ending(self, trial: TrialContact, slope: float = 0.0) -> Candidate:
        """The candidate of the whole step."""
        return Candidate(self.end, trial, step_error(self, trial, self.step, slope), slope)

    def to_speed_jump(self, candidate: Candidate) -> Candidate | None:
        """A shorter step than a candidate's, to the first radius on its way at which its speed may jump.

        Of no length if that is where it starts; ``None`` if there is no such radius.
        """
        contact, problem = self.state.contact, self.problem
        edge, new_edge, zone = contact.edge, candidate.trial.motion.new_edge, candidate.trial.zone
        if problem.work == 0.0:
            return None
        radius = speed_jump_between(contact.history.past_kinks, zone, edge, new_edge, self.accuracy)
        if radius is None:
            return None
        if abs(radius - edge) <= self.accuracy:
            return replace(candidate, parameter=self.state.parameter, error=0.0, speed_jumps=True)
        step = replace(self, step=candidate.parameter - self.state.parameter)
        beyond = step.trial(candidate.parameter, radius)
        root = RootSearchResult("converged", radius, beyond, 0.0)
        result = step._to_travel_limit(new_edge < edge, radius, root)
        return replace(result, speed_jumps=True) if isinstance(result, Candidate) else None

    def _root(
        self, at_end: Callable[[float], TrialContact], guess: float, low: float, high: float
    ) -> RootSearchResult[TrialContact]:
        """Search for the edge at the end of the step."""
        slope, accuracy, residual = self.state.slope, self.accuracy, self._residual_accuracy
        return rising_root(at_end, guess, slope, low, high, accuracy, residual)

    @property
    def _residual_accuracy(self) -> float:
        """Accuracy of the closure."""
        return _RESIDUAL_ACCURACY * self.settings.tolerance * self.problem.work or math.inf

    def _hardly_turns(self, excess: float) -> bool:
        """Whether the residual where the edge stands asks it to turn, but for no more than it is known.

        A glass that is stiffer by far than the rubber hardly lets it: the residual falls at once, and its
        next root is false.
        """
        known = min(self.state.slope * self.accuracy, self._residual_accuracy)
        return 0.0 < excess * self.state.contact.history.direction <= known

    def _to_travel_limit(
        self, receding: bool, edge: float, root: RootSearchResult[TrialContact]
    ) -> Candidate | FailedStep:
        """The shorter step that takes the edge to its travel limit ``edge``, if it is stable there."""
        start, beyond = self.state.parameter, root.trial
        accuracy = _RESIDUAL_ACCURACY * self.settings.tolerance
        known = {1.0: beyond, 0.0: self.trial(start, edge)}

        def residual(share: float) -> float:
            if share not in known:
                known[share] = self.trial(start + share * self.step, edge)
            return known[share].residual

        shortest = min(self.shortest_step / self.step, 1.0)
        if (residual(shortest) > 0.0) == (beyond.residual > 0.0):
            if (residual(0.0) > 0.0) == (beyond.residual > 0.0):
                way = self._way_to_limit_point(edge, residual(0.0))
                return FailedStep(StepFailure.BEYOND_TRAVEL_LIMIT, receding, way)
            # within rounding of the time it goes at least so far
            parameter = min(start + self.shortest_step, self.interval.length)
            return Candidate(parameter, self.trial(parameter, edge), 0.0)
        share = brentq(residual, shortest, 1.0, xtol=1e-300, rtol=accuracy, maxiter=_HALVINGS)
        parameter = start + share * self.step
        if parameter <= start:
            return FailedStep(StepFailure.UNRESOLVED, receding)
        trial = known[share]
        inward = self.trial(parameter, edge - 0.01 * self.reach(not receding))
        if inward.residual > trial.residual:
            travel = abs(beyond.motion.new_edge - self.state.contact.edge)
            way = self._way_to_limit_point(edge, residual(0.0))
            return FailedStep(StepFailure.UNSTABLE, receding, way, travel)
        error = error_at_limit(
            self, trial, parameter - start, lambda: self.trial(parameter, self.state.contact.edge)
        )
        return Candidate(parameter, trial, error, root.slope)

    def _way_to_limit_point(self, far: float, residual: float) -> float:
        """Distance of the edge from where it will run away; zero if it is within the smallest travel.

        At the load of the start the residual vanishes at the stable edge and, on the other side of the limit
        point and nearly as far from it, at an unstable one: by the parabola through the stable edge, a place
        near to it, and ``far`` with its ``residual``, half the distance between them.
        """
        edge = self.state.contact.edge
        reach, near = abs(far - edge), 2.0 * self.smallest_travel
        if reach <= near:
            return math.inf
        sign = math.copysign(1.0, far - edge)
        drop = sign * self.trial(self.state.parameter, edge + sign * near).residual / near
        if drop <= 0.0:
            return 0.0
        bend = (drop - sign * residual / reach) / (reach - near)
        return 0.5 * (near + drop / bend) if bend > 0.0 else math.inf

    def _expected_edge(self) -> float:
        """Edge to start the search from: extrapolated, but the present one if the parabola turns round.

        Behind a receding edge of a stiff glass the residual of covered points is rounding, with false roots.
        Nor is it known within the outermost annulus: an edge expected nearer than its accuracy is sought
        where it stands, or at rest it would find them.
        """
        accepted, edge = self.state.accepted, self.state.contact.edge
        expected = accepted.edge_after(self.step)
        if abs(expected - edge) >= least_bent_travel(self, edge):
            expected = accepted.expected_edge(self.step)
        goes_on = (expected - edge) * accepted.rates(0.0)[0] > 0.0
        return expected if goes_on and abs(expected - edge) >= self.accuracy else edge

    def _in_full_contact(self) -> Candidate | None:
        """A step of a contact that fills a flat punch, up to where it recedes; ``None`` from there on."""
        start, edge = self.state.parameter, self.state.contact.edge
        trial = self.trial(self.end, edge)
        if trial.residual <= 0.0:
            return Candidate(self.end, trial, step_error(self, trial, self.end - start, rate_step=self.step))
        known = _RESIDUAL_ACCURACY * self.settings.tolerance * self.problem.work
        if self.trial(start, edge).residual >= -max(1e-6 * trial.residual, known):
            return None
        end = brentq(lambda p: self.trial(p, edge).residual, start, self.end, xtol=1e-12 * self.end)
        if end <= start:
            return None
        trial = self.trial(end, edge)
        return Candidate(end, trial, step_error(self, trial, end - start))

    def _pinned(self) -> Candidate | float:
        """A step of an edge at rest, up to where it sets out; if it moves at once, the way it would open.

        An edge that turns within the step sets out there, too. One that goes on as it came has not stopped:
        where it is known to its accuracy only, so is its closure.
        """
        start, edge, jump = self.state.parameter, self.state.contact.edge, self.interval.jump
        adhesion, last = self.problem.irreversible, self.state.contact.last_step
        assert adhesion is not None
        trial = self.trial(self.end, edge)
        departure = closure_of_departure(adhesion, trial.closure, jump)
        if departure is None:
            return Candidate(self.end, trial, step_error(self, trial, self.end - start))
        way = math.copysign(1.0, departure - trial.closure)

        def driven(at: TrialContact) -> float:
            return way * (1.0 - at.closure / departure)

        goes_on = last is not None and way * (edge - last.edge) > 0.0
        if not goes_on and driven(self.trial(start, edge)) < -_RESIDUAL_ACCURACY * self.settings.tolerance:
            end = brentq(
                lambda p: driven(self.trial(p, edge)), start, self.end, xtol=1e-14 * self.end, rtol=1e-14
            )
            if end > start:
                trial = self.trial(end, edge)
                return Candidate(end, trial, step_error(self, trial, end - start), speed_jumps=True)
        return trial.closure - adhesion.work

    def trial(self, parameter: float, edge: float) -> TrialContact:
        if parameter not in self._ends:
            self._ends[parameter] = self._end(parameter)
        end, control = self._ends[parameter], self.interval.control
        return evaluate(
            self.problem, self.state.contact, end.duration, edge, control, end.value, end.earlier, end.within
        )

    def _end(self, parameter: float) -> _StepEnd:
        """What trials that end at a parameter have in common."""
        interval = self.interval
        duration = 0.0 if interval.jump else interval.time(parameter) - self.state.contact.time
        within = None
        if interval.control == "penetration" and duration > 0.0:
            share = self.problem.chain.share_to_meet(duration)
            start = self.state.parameter
            within = share * duration, interval.prescribed(start + share * (parameter - start))
        return _StepEnd(duration, interval.prescribed(parameter), self._earlier(duration), within)

    def _earlier(self, duration: float) -> EarlierRow | None:
        """The row before the last, with its edge where the step takes the edge far enough for a curved path.

        Over less its path is straight: the condition at the end of the step is then one on the place of the
        edge, and a parabola through earlier rows carries their errors on. Not so a penetration that creeps
        and is sought at the end of the step, and the load ahead of the edge: they always are parabolas.
        """
        rows, edge = self.state.accepted.rows, self.state.contact.edge
        if duration == 0.0 or len(rows) < 2 or not self.problem.viscoelastic:
            return None
        before, last = rows[-2:]
        travel = abs(last.edge - before.edge) / (last.parameter - before.parameter) * duration
        if not self.problem.curves or travel < least_bent_travel(self, edge):
            return self._as_earlier(self.state.accepted.earlier(_SHARE_OF_STEP * duration))
        further = None
        if len(rows) > 2 and last.edge < before.edge < rows[-3].edge:
            further = last.parameter - rows[-3].parameter, rows[-3].edge
        curved = self._as_earlier(before)
        return replace(
            curved,
            load=before.edge_load,
            ahead=0.0,
            fall=self._fall,
            further=further,
            of_travel=self.state.accepted.time_is_smoother,
        )

    def _as_earlier(self, row: AcceptedRow) -> EarlierRow:
        """An accepted row as the earlier one of a parabola."""
        interval, time = self.interval, self.state.accepted.rows[-1].parameter - row.parameter
        penetration = row.load if interval.control == "force" else interval.prescribed(row.parameter)
        if interval.control == "stage":
            penetration -= self.problem.scene.loading.compliance * row.load
        if not self.problem.curves:
            return EarlierRow(time, penetration)
        return EarlierRow(time, penetration, row.edge, row.load_ahead, self.problem.ahead)

    @cached_property
    def _fall(self) -> OuterFall:
        """Fall of the load outside the edge at the start."""
        return OuterFall.outside(self.state.contact.surface, self.problem.nearest)
