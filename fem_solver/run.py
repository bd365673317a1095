"""The loop over load steps, their jumps and the intervals between their stops.

Stops and kinks of the loading are stepped onto exactly; between them the steps are dyadic (``time_step``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from scipy.optimize import brentq

from contact_scene import Loading, Outcome, OutcomeKind, Segment
from contact_scene.loading import Control
from contact_scene.run_control import Stop, interruption, stops_within
from fem_solver.contact_problem import ContactCandidate
from fem_solver.edge_path import EdgeMotion
from fem_solver.edge_search import EdgeNotFound, EdgeSearch
from fem_solver.moduli import bend_through
from fem_solver.recorder import SurfaceState
from fem_solver.step_control import DyadicInterval, swing
from fem_solver.time_step import MISSED, RunEnded, SteppedStates

Search = Callable[[float, Control, float], EdgeSearch]

_SHORTEST = 1e-8
"""Shortest step, relative to the shortest relaxation time or the interval: below it the edge is unstable. Its
radius goes with the root of the time to a limit point."""
_LONGEST = 0.125
"""Longest step of a load step that does work on a relaxing solid, relative to the load step: in one much
shorter than all relaxation, force over penetration is straight but for what a cycle loses. The first step,
which nothing is known of, is its square of the interval, or of twice the shortest relaxation time."""
_SHORTEST_PART = 2.0**-10
"""Least part of a load jump where the response is curved, relative to it; its square is the least before
contact counts as lost."""


class NodeReleaseRun(SteppedStates):
    """A run from its start state through its loading."""

    def start(self, loading: Loading) -> Outcome | None:
        """Accept the start state; an outcome if there is none."""
        dt = math.inf if loading.start == "relaxed" else 0.0
        try:
            candidate = self.search(dt, loading.start_control, loading.penetration).start()
            if candidate.edge.motion is EdgeMotion.RECEDING:
                self._end(OutcomeKind.NO_EQUILIBRIUM, loading.without_start)
            if not candidate.in_equilibrium:
                self._contact_lost(candidate)
            self._commit(candidate)
        except RunEnded as ended:
            return ended.outcome
        except EdgeNotFound as failure:
            return Outcome(OutcomeKind.STEP_UNDERFLOW, str(failure), self.time)
        self._on_stop()
        return None

    def carry_out(self, loading: Loading) -> Outcome:
        """The loading, load step after load step."""
        try:
            while not self.cursor.done(loading):
                state = self.state
                segment = self.cursor.segment(loading, self.time, state.penetration, state.force)
                self._carry_out_step(loading, segment)
                self.cursor.step_done()
        except RunEnded as ended:
            return ended.outcome
        except EdgeNotFound as failure:
            return Outcome(OutcomeKind.STEP_UNDERFLOW, str(failure), self.time)
        return Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", self.time)

    def _carry_out_step(self, loading: Loading, segment: Segment) -> None:
        """One load step: its jump, if any, then the intervals between its stops."""
        self._triggered(segment)
        self._lower(segment)
        self._load_jump(segment)
        self.step = None
        if self._triggered(segment):
            return
        self._check_clock(segment)
        span = swing(segment)
        start = segment.start
        for stop in stops_within(segment, self.options.requested_times):
            if stop.time > start:
                self._carry_out_interval(loading, segment, start, stop, span)
            if self._triggered(segment):
                self.slopes_jump()
                self.interval = self.step = self.before = None
                return
            start = stop.time
        if segment.trigger is not None:
            raise RunEnded(segment.trigger.not_reached(self.time))

    def _triggered(self, segment: Segment) -> bool:
        """Whether the accepted state has reached the level that ends the load step."""
        state = self.state
        return self.cursor.triggered(segment, state.penetration, state.force, state.radius)

    def _carry_out_interval(
        self, loading: Loading, segment: Segment, start: float, stop: Stop, span: float
    ) -> None:
        """From one stop to the next; ``span`` is the swing of the prescribed value over the load step.

        Where an indenter comes to touch on its way, or an edge sets off, in parts.
        """
        while start < stop.time:
            if self._touches(segment, stop.time):
                self._touch(segment.control, segment.value(self.time))
            end = self._first_touch(segment, start, stop.time)
            self.interval = interval = self._new_interval(start, end, self._longest(segment))
            self.before = None
            while not interval.done:
                outcome = interruption(self.monitor, self.time)
                if outcome is not None:
                    raise RunEnded(outcome)
                self._advance(segment, interval, span)
                if self.progress is not None:
                    self.progress(self.cursor.share(loading, segment, self.time))
                if self._triggered(segment):
                    return
            self.interval, start = None, interval.end
            if start < stop.time:
                self.step = None
        self._on_stop()
        if stop.kink:
            self.slopes_jump()
        self.step = None if stop.kink else interval.dt

    @property
    def _hovers(self) -> bool:
        """Whether an indenter without adhesion is not in contact."""
        return self.setup.adhesion is None and self.state.radius == 0.0

    def _touches(self, segment: Segment, stop: float) -> bool:
        """Whether an indenter without contact or adhesion touches now, and is pressed on."""
        way = segment.value(stop)
        return self._hovers and way > 0.0 and math.isclose(way - segment.value(self.time), way)

    def _lower(self, segment: Segment) -> None:
        """Lower an indenter without contact or adhesion that a force presses, until it touches."""
        if not self._hovers or segment.control != "force":
            return
        touching = self.search(0.0, "force", 0.0).held(0.0)
        pressed = segment.value(segment.start) > 0.0 or segment.rate(segment.start) > 0.0
        if pressed and touching.penetration != self.state.penetration:
            self._commit(touching, contact=False)
            self._touch("force", 0.0)

    def _touch(self, control: Control, value: float) -> None:
        """Where a plane tip touches, all of it is in contact; others begin from a point."""
        whole = self.search(0.0, control, value).plane_contact()
        if whole is not None:
            self.slopes_jump()
            self._commit(whole)

    def _first_touch(self, segment: Segment, start: float, stop: float) -> float:
        """The time at which an indenter without adhesion touches on its way down to a stop, else the stop."""
        if (
            not self._hovers
            or self._touches(segment, stop)
            or not segment.value(start) < 0.0 < segment.value(stop)
        ):
            return stop
        length = stop - start
        return start + length * float(brentq(lambda share: segment.value(start + share * length), 0.0, 1.0))

    def _longest(self, segment: Segment) -> float:
        """Longest step within a load step; none where no work is done, or nothing lost."""
        moves = segment.value(segment.end) != segment.value(segment.start)
        return _LONGEST * (segment.end - segment.start) if moves and self.setup.has_history else math.inf

    def _new_interval(self, start: float, end: float, longest: float) -> DyadicInterval:
        """The interval between two stops, with the first of its steps."""
        length, relaxation = end - start, self.setup.shortest_time
        interval = DyadicInterval(start, end, ceiling=longest)
        first = self.step or _LONGEST**2 * min(length, 2.0 * relaxation)
        interval.limit(first, _SHORTEST * min(relaxation, length))
        return interval

    def _load_jump(self, segment: Segment) -> None:
        """The load jump, if any, with which a load step begins."""
        state, target = self.state, segment.value(segment.start)
        before = segment.present(state.penetration, state.force)
        self.slopes_jump()
        if math.isclose(target, before):
            return
        tolerance = MISSED * self.setup.tolerance
        jump = LoadJump(segment.control, before, target, state)
        while not jump.complete:
            self._check_budget()
            candidate = jump.trial(self.search, self.state, tolerance)
            if candidate is None:
                self.counters.rejected_steps += 1
                jump.halve()
                continue
            if not candidate.in_equilibrium:
                self._contact_lost(candidate)
            if self._below_zone(candidate):
                self._end_at_zone(
                    lambda share: self.search(0.0, jump.control, jump.value(jump.done + share * jump.part))
                )
            self._commit(candidate, bent=jump.bent)
            jump.advance()

    def _check_clock(self, segment: Segment) -> None:
        """End where a load step is so short that its times are not told apart at the time when it begins."""
        length = segment.end - segment.start
        moves = segment.value(segment.end) != segment.value(segment.start)
        if moves and 0.0 < self.setup.tolerance * length < math.ulp(segment.end):
            reason = f"a load step of {length:.6g} cannot be resolved after a time of {segment.start:.6g}"
            self._end(OutcomeKind.STEP_UNDERFLOW, reason)


@dataclass
class LoadJump:
    """A load that changes instantaneously, taken in parts over which the response is nearly linear.

    The work is then that of an edge that moves with the load, and contact is lost where the edge has no
    equilibrium, not where the jump began.

    The half-space answers with its glassy modulus. ``first`` and ``last`` are values of the controlled
    quantity, ``begin`` is the state before the jump, ``done`` and ``part`` are the shares of the jump that
    are accepted, and of the next part; ``bent`` is the work in the last part beyond its trapezoid, along
    parabolas through its middle.
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

    def trial(self, search: Search, state: SurfaceState, tolerance: float) -> ContactCandidate | None:
        """The next part; ``None`` if it has to be shorter, without equilibrium where contact is lost."""
        self.part = min(self.part, 1.0 - self.done)
        end = self._at(search, self.done + self.part)
        if not end.in_equilibrium:
            return None if self.part > _SHORTEST_PART**2 else end
        middle = self._at(search, self.done + 0.5 * self.part)
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

    def _at(self, search: Search, share: float) -> ContactCandidate:
        return search(0.0, self.control, self.value(share)).trial(0.0, math.inf)


def _work_of_bend(first: SurfaceState, middle: ContactCandidate, last: ContactCandidate) -> float:
    """``int F dD`` beyond the trapezoid, along parabolas through three states."""
    depth_bend = bend_through(first.penetration, middle.penetration, last.penetration)
    force_bend = bend_through(first.force, middle.force, last.force)
    depth_rise, force_rise = last.penetration - first.penetration, last.force - first.force
    return (depth_bend * force_rise - force_bend * depth_rise) / 6.0
