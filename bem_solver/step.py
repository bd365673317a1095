"""A trial step on graded annuli: a candidate for the next state, or why there is none.

Nothing is committed here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, auto
from functools import cached_property

from scipy.optimize import brentq

from bem_solver.bent_path import EarlierRow
from bem_solver.edge_energy import drive
from bem_solver.outer_fall import OuterFall
from bem_solver.root_search import RootSearchResult, rising_root
from bem_solver.run_state import StepStart
from bem_solver.step_control import shrunk
from bem_solver.step_error import SHARE_OF_ZONE, error_at_limit, step_error
from bem_solver.trial import EDGE_ACCURACY, TrialContact, evaluate

_RESIDUAL_ACCURACY = 1e-2
"""Accuracy of the closure, in step tolerances of the work of adhesion: far below the step error."""
_TRAVEL_ITERATIONS = 3
"""Corrections of a step by the travel to be expected in it: the expected travel is nearly in proportion."""
_BESIDE_EXTREMUM = 0.125
"""Distance of the rows on both sides of the largest tension, in steps: what lies between them exceeds the row
by a sixty-fourth of what it would with the whole step."""


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
    """A trial step without candidate; ``travel`` is how far the edge would have moved."""

    failure: StepFailure
    receding: bool
    travel: float = 0.0


@dataclass(frozen=True)
class Candidate:
    """A trial that satisfies the closure, the parameter it was reached at, and its error in tolerances.

    ``slope`` is the derivative of the residual with the edge; zero if unknown. ``sets_out``: a pinned edge
    moves from there on.
    """

    parameter: float
    trial: TrialContact
    error: float
    slope: float = 0.0
    sets_out: bool = False


def limited_step(start: StepStart) -> tuple[float, float]:
    """Step size to start from next time, and the step to try.

    Within the travel limit, with no more than a slight departure of the prescribed quantity from its chord,
    and without leaving a sliver before the end of the interval.
    """
    state, interval, settings = start.state, start.interval, start.settings
    limit = 0.9 * state.travel_share * start.problem.longest_travel(state.contact.edge) / settings.divisions
    limited, parameter = state.step, state.parameter
    limited = _step_within(start, limited, limit)
    left = interval.length - parameter
    limited = min(limited, left)
    while (departure := interval.departure_from_chord(parameter, limited) / settings.tolerance) > 1.0:
        limited = shrunk(limited, departure)
    if limited >= left * (1.0 - 1e-9):
        step = left
    else:
        step = min(limited, 0.5 * left) if 2.0 * limited > left else limited
    step = min(step, _until_largest_tension(start, limited))
    return limited, max(step, min(start.shortest_step, left))


def _step_within(start: StepStart, step: float, limit: float) -> float:
    """The step, or a shorter one in which the edge is expected to travel no farther than ``limit``."""
    accepted, edge = start.state.accepted, start.state.contact.edge
    if start.problem.work == 0.0:  # no limit point ahead
        speed = abs(accepted.rates(step)[0])
        return limit / speed if speed * step > limit else step
    step = min(step, accepted.step_of_travel(limit, start.smallest_travel))
    for _ in range(_TRAVEL_ITERATIONS):
        linear = abs(accepted.rates(step)[0]) * step
        travel = max(linear, abs(accepted.edge_after(step) - edge))
        if travel > limit:
            step *= limit / travel
    return step


def _until_largest_tension(start: StepStart, step: float) -> float:
    """The longest step that leaves rows close before, at and close after the largest tension of the run."""
    state, force = start.state, start.state.contact.surface.force
    if start.interval.control == "force" or force >= 0.0:
        return math.inf
    near = _BESIDE_EXTREMUM * step
    distance = state.accepted.until_load_turns()
    if -force < state.largest_tension or not -1.5 * near < distance < step + near:
        return math.inf
    return distance - near if distance > 1.5 * near else near


@dataclass(frozen=True)
class TrialStep(StepStart):
    """A step of length ``step`` from the committed state along a loading interval.

    Where the edge would go further than its travel limit, or inside the process zone, the shorter step that
    takes it just there is sought instead.
    """

    step: float

    @property
    def end(self) -> float:
        """Parameter at the end; that of the interval exactly."""
        parameter, length = self.state.parameter, self.interval.length
        return length if self.step == length - parameter else parameter + self.step

    def result(self) -> Candidate | FailedStep:
        """The candidate, or why there is none."""
        problem, state, step = self.problem, self.state, self.step
        edge, limit = state.contact.edge, problem.scene.indenter.edge
        length, tolerance = problem.length_at(edge), self.settings.tolerance
        reach = state.travel_share * problem.longest_travel(edge) / self.settings.divisions
        low, high = max(edge - reach, 0.25 * edge, problem.zone), min(edge + reach, limit)
        if edge == limit:
            resting = self._in_full_contact()
            if resting is not None:
                return resting
        if problem.irreversible is not None:
            pinned = self._pinned()
            if isinstance(pinned, Candidate):
                return pinned
            low, high = (low, edge) if pinned > 0.0 else (edge, high)
        root = rising_root(
            lambda radius: self._trial(self.end, radius),
            self._expected_edge(EDGE_ACCURACY * tolerance * length),
            state.slope,
            low,
            high,
            EDGE_ACCURACY * tolerance * length,
            _RESIDUAL_ACCURACY * tolerance * problem.work or math.inf,
        )
        if root.position == "converged" or (root.position == "above" and high == limit):
            return Candidate(self.end, root.trial, step_error(self, root.trial, step), root.slope)
        receding = root.position == "below"
        return self._to_travel_limit(receding, low if receding else high, reach, root)

    def _to_travel_limit(
        self, receding: bool, edge: float, reach: float, root: RootSearchResult[TrialContact]
    ) -> Candidate | FailedStep:
        """The shorter step that takes the edge to its travel limit ``edge``, if it is stable there."""
        start, beyond = self.state.parameter, root.trial
        accuracy = _RESIDUAL_ACCURACY * self.settings.tolerance
        known = {1.0: beyond, 0.0: self._trial(start, edge)}

        def residual(share: float) -> float:
            if share not in known:
                known[share] = self._trial(start + share * self.step, edge)
            return known[share].residual

        if (residual(0.0) > 0.0) == (beyond.residual > 0.0):
            return FailedStep(StepFailure.BEYOND_TRAVEL_LIMIT, receding)
        share = brentq(residual, 0.0, 1.0, xtol=1e-300, rtol=accuracy)
        parameter = start + share * self.step
        if share * self.step < self.shortest_step:  # within rounding of the time it goes at least so far
            parameter = min(start + self.shortest_step, self.interval.length)
            return Candidate(parameter, self._trial(parameter, edge), 0.0)
        if parameter <= start:
            return FailedStep(StepFailure.UNRESOLVED, receding)
        trial = known[share]
        inward = self._trial(parameter, edge - 0.01 * reach)
        if inward.residual > trial.residual:
            travel = abs(beyond.motion.new_edge - self.state.contact.edge)
            return FailedStep(StepFailure.UNSTABLE, receding, travel)
        return Candidate(parameter, trial, error_at_limit(self, trial, parameter - start), root.slope)

    def _expected_edge(self, accuracy: float) -> float:
        """Edge to start the search from: extrapolated, but the present one if the parabola turns round.

        Behind a receding edge of a stiff glass the residual of covered points is rounding, with false roots.
        """
        accepted, edge = self.state.accepted, self.state.contact.edge
        expected = accepted.edge_after(self.step)
        if (expected - edge) * accepted.rates(0.0)[0] >= 0.0:
            return expected
        return min(max(expected, edge - accuracy), edge + accuracy)

    def _in_full_contact(self) -> Candidate | None:
        """A step of a contact that fills a flat punch, up to where it recedes; ``None`` from there on."""
        start, edge = self.state.parameter, self.state.contact.edge
        trial = self._trial(self.end, edge)
        if trial.residual <= 0.0:
            return Candidate(self.end, trial, step_error(self, trial, self.end - start, self.step))
        if self._trial(start, edge).residual >= -1e-6 * trial.residual:
            return None
        end = brentq(lambda p: self._trial(p, edge).residual, start, self.end, xtol=1e-12 * self.end)
        if end <= start:
            return None
        trial = self._trial(end, edge)
        return Candidate(end, trial, step_error(self, trial, end - start))

    def _pinned(self) -> Candidate | float:
        """A step of an edge at rest, up to where it sets out; if it moves at once, the way it would open."""
        start, edge, jump = self.state.parameter, self.state.contact.edge, self.interval.jump
        adhesion = self.problem.irreversible
        assert adhesion is not None

        def driven(trial: TrialContact) -> float:
            return drive(adhesion, trial.closure, jump)

        trial = self._trial(self.end, edge)
        excess = driven(trial)
        if excess <= 0.0:
            return Candidate(self.end, trial, step_error(self, trial, self.end - start))
        if driven(self._trial(start, edge)) < -_RESIDUAL_ACCURACY * self.settings.tolerance:
            end = brentq(
                lambda p: driven(self._trial(p, edge)), start, self.end, xtol=1e-14 * self.end, rtol=1e-14
            )
            if end > start:
                trial = self._trial(end, edge)
                return Candidate(end, trial, step_error(self, trial, end - start), sets_out=True)
        return trial.closure - adhesion.work

    def _trial(self, parameter: float, edge: float) -> TrialContact:
        interval, contact = self.interval, self.state.contact
        duration = 0.0 if interval.jump else interval.time(parameter) - contact.time
        prescribed = interval.prescribed(parameter)
        earlier = self._earlier(duration)
        return evaluate(self.problem, contact, duration, edge, interval.control, prescribed, earlier)

    def _earlier(self, duration: float) -> EarlierRow | None:
        """The row before the last, where the step takes the edge far enough for a parabola.

        Over less the path is straight: the condition at the end of the step is then one on the place of the
        edge, and a parabola through earlier rows carries their errors on.
        """
        rows, interval, edge = self.state.accepted.rows, self.interval, self.state.contact.edge
        if interval.jump or len(rows) < 2 or not self.problem.curves:
            return None
        (last, before), (_, now) = ((one[0], one[1]) for one in rows[-2:])
        travel = abs(now - before) / (rows[-1][0] - last) * duration
        if travel < SHARE_OF_ZONE * self.problem.length_at(edge):
            return None
        (before, edge, load), (now, _, _) = rows[-2:]
        penetration = load if interval.control == "force" else interval.prescribed(before)
        if interval.control == "stage":
            penetration -= self.problem.scene.loading.compliance * load
        return EarlierRow(now - before, edge, penetration, self._fall)

    @cached_property
    def _fall(self) -> OuterFall:
        """Fall of the load outside the edge at the start."""
        return OuterFall.outside(self.state.contact.surface, self.problem.zone)
