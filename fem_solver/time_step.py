"""One time step: trials of shrinking length until one is accepted, or the edge leaves in a jump.

A trial (``trial_step``, ``events``) returns a candidate and changes nothing. Steps are dyadic divisions of an
interval between two stops (``step_control``).
"""

from __future__ import annotations

import math
from typing import NoReturn

from contact_scene import Segment
from contact_scene.loading import Control
from fem_solver.contact_solver import ContactCandidate
from fem_solver.edge import EdgeMotion
from fem_solver.events import edge_jump
from fem_solver.run_state import StepBefore, StepCandidate, TensionPeak
from fem_solver.step_control import DyadicInterval, missed_peak
from fem_solver.trial_step import TriedSteps
from fem_solver.trigger import step_to_level

_REJECT = 2.0
"""A step is rejected if its estimated error exceeds this multiple of the allowed one."""
_MISSED_TENSION = 0.1
"""Tension that rows may miss of its largest value, relative to the allowed error of the force."""
_EVENT_TRAVEL = 4.0
"""An edge jump is recorded as an event if it exceeds this multiple of the edge travel allowed per step."""


class SteppedStates(TriedSteps):
    """A run that goes from one accepted state to the next within an interval between two stops."""

    def _advance(self, segment: Segment, interval: DyadicInterval, span: float) -> None:
        """One accepted step, after as many trials as it takes."""
        candidate, error = self._accepted_trial(segment, interval, span)
        contact, slopes = candidate.contact, candidate.slopes
        if segment.trigger is not None:
            at_level = step_to_level(self, segment, segment.trigger, interval.dt, contact)
            if at_level is not None:
                self.time += at_level.dt
                self._commit(at_level)
                self.cursor.level_reached()
                return
        radius, travel, jumped = self.state.radius, self._travel(), not contact.in_equilibrium
        if jumped:
            contact, slopes, error = self._edge_jump(contact, segment, interval.dt), {}, 0.0
        elif self._below_zone(contact):
            self._end_in_step(segment, interval.dt)
        before = StepBefore(
            self.time,
            interval.position,
            self.estimator.slopes,
            self.recorder.mark(),
            self.setup.history.state,
        )
        self.time = interval.next_time
        interval.advance()
        self._commit(contact)
        self.before = None if jumped else before
        self.estimator.accept(slopes)
        moved = abs(self.state.radius - radius)
        if error > 1.0 or moved > 0.9 * travel:
            interval.halve()
        elif error < 0.25 and moved < 0.4 * travel:
            interval.double()

    def _accepted_trial(
        self, segment: Segment, interval: DyadicInterval, span: float
    ) -> tuple[StepCandidate, float]:
        """The first trial step that is accepted, not yet committed, and its error; the interval has its size.

        Parameters
        ----------
        segment : Segment
        interval : DyadicInterval
            Is halved for as long as trials are rejected.
        span : float
            Swing of the prescribed value over the load step.

        Returns
        -------
        candidate : StepCandidate
        error : float
            Relative to that allowed; at most what is rejected, unless the step is the shortest.
        """
        while True:
            deviation = self._deviation(segment, interval, span)
            if deviation > _REJECT and not interval.shortest:
                interval.halve()
                continue
            self._check_budget()
            candidate = self.trial_step(segment, interval.dt, interval.next_time)
            error = max(deviation, candidate.error)
            if self._first_step_was_too_long(candidate, interval):
                continue
            contact = candidate.contact
            if self._sets_off_too_far(contact, interval) or self._zone_fills_contact(contact, interval):
                self._reject(interval)
                continue
            if error > _REJECT and not interval.shortest:
                self._reject(interval)
                continue
            peak = self._tension_peak(candidate)
            if peak is not None and peak.rise * interval.dt > peak.allowed and not interval.shortest:
                self._reject(interval)
                continue
            if peak is None or not self._divide_last_step(peak, interval):
                return candidate, error

    def _reject(self, interval: DyadicInterval) -> None:
        self.counters.rejected_steps += 1
        interval.halve()

    def _present_force_scale(self) -> float:
        """Force to which errors are relative in the accepted state."""
        now = self.state
        return self.force_scale(now.force, now.singular_force, now.radius)

    def _tension_peak(self, candidate: StepCandidate) -> TensionPeak | None:
        """The turn of the tension at the last row, if it is the largest so far."""
        tension = -self.state.force
        rise, fall = -self.estimator.slopes.get("force", 0.0), candidate.slopes.get("force", math.inf)
        allowed = _MISSED_TENSION * self.estimator.tolerance * self._present_force_scale()
        turns = rise > 0.0 and fall > 0.0 and tension + allowed > self.recorder.content.largest_tension
        return TensionPeak(rise, fall, allowed) if turns else None

    def _divide_last_step(self, peak: TensionPeak, interval: DyadicInterval) -> bool:
        """Take the last step back if too much of the peak may lie within it; whether it is taken back."""
        before = self.before
        if before is None or not interval.divisible(before.position):
            return False
        earlier = -before.slopes["force"] if "force" in before.slopes else math.inf
        if missed_peak(earlier, peak.rise, peak.fall, self.time - before.time) <= peak.allowed:
            return False
        self._take_back(before, interval)
        return True

    def _first_step_was_too_long(self, candidate: StepCandidate, interval: DyadicInterval) -> bool:
        """Whether the step after a kink, which had no slope before it, misses too much of the force's curve.

        The next step shows that; then it is taken back, to be taken in parts.
        """
        before = self.before
        if before is None or "force" in before.slopes or "force" not in candidate.slopes:
            return False
        if not interval.divisible(before.position):
            return False
        turn = abs(candidate.slopes["force"] - self.estimator.slopes["force"])
        length = self.time - before.time
        missed = turn * length**2 / (length + interval.dt)
        if missed <= _REJECT * self.estimator.tolerance * self._present_force_scale():
            return False
        self._take_back(before, interval)
        return True

    def _take_back(self, before: StepBefore, interval: DyadicInterval) -> None:
        """Return to the begin of the last step, to take it in parts."""
        self.time = before.time
        self.estimator.accept(before.slopes)
        self.recorder.take_back(before.row)
        self.setup.history.take_back(before.history)  # type: ignore[arg-type]
        self.on_take_back()
        self.counters.steps -= 1
        self.counters.rejected_steps += 1
        self.before = None
        interval.take_back(before.position)

    def _edge_jump(self, candidate: ContactCandidate, segment: Segment, dt: float) -> ContactCandidate:
        """The state after an edge jump; it is an event if the edge jumps far.

        Where the energy follows the speed, an edge that a short step takes beyond the zone has passed it.
        """
        landed = edge_jump(self.solver, candidate)
        if not landed.in_equilibrium or self._below_zone(landed):
            if self._has_rate and landed.edge.motion is not EdgeMotion.ADVANCING:
                self._end_in_step(segment, dt)
            self._contact_lost(landed)
        if abs(self.solver.radius(landed) - self.state.radius) > _EVENT_TRAVEL * self.setup.travel:
            advancing = candidate.edge.motion is EdgeMotion.ADVANCING
            self.recorder.event("snap-in" if advancing else "pull-off")
        return landed

    def _end_in_step(self, segment: Segment, dt: float) -> NoReturn:
        """The contact becomes shorter than its process zone within a step."""
        start = self.time

        def load(share: float) -> tuple[float, Control, float]:
            return share * dt, segment.control, segment.value(start + share * dt)

        self._end_at_zone(load)
