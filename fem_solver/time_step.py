"""One time step: trials of shrinking length until one is accepted, or the edge leaves in a jump.

A trial returns a candidate within the travel of the edge, with its error, and changes nothing. Steps are
dyadic divisions of an interval between two stops (``step_control``); one that reaches the level of a trigger
ends there.
"""

from __future__ import annotations

import math
from typing import NoReturn

from scipy.optimize import brentq

from contact_scene import Segment, Trigger
from contact_scene.loading import Control
from fem_solver.accepted_states import AcceptedStates, StepBefore, StepCandidate, TensionPeak
from fem_solver.contact_problem import ContactCandidate
from fem_solver.edge_geometry import EdgeMotion
from fem_solver.events import edge_jump
from fem_solver.recorder import SurfaceState
from fem_solver.step_control import DyadicInterval, deviation_from_tangent, missed_peak

_ZONE_END_SHARE = 1e-4
"""Longest step, in intervals, within which a zone of fixed stress may come to fill its contact: the end."""
_DEVIATION_PER_TOLERANCE = 10.0
"""Deviation of the prescribed value from its tangent over a step, per tolerance, relative to its swing."""
_RADIUS_SCALE = 10.0
"""Allowed error of the radius per that of the force, relative to their sizes: the travel bounds it closer."""
_MISSED_RADIUS = 0.1
"""Distance by which the edge may miss the extrapolation of its path, per allowed error of the force, relative
to the sizes of radius and force. It is less than one: an edge that is too far inside recedes faster from
then on, so that what it misses grows towards the pull-off."""
_ELASTIC_TRAVEL = 4.0
"""Factor on the edge travel per step of an elastic solid, which has no history to resolve."""
_ELASTIC_SHARE = 0.1
"""Edge travel per step of an elastic solid, relative to the contact radius, where that is more."""


class TriedSteps(AcceptedStates):
    """A run that can try a step of any length from the last accepted state."""

    def trial_step(self, segment: Segment, dt: float, end: float) -> StepCandidate:
        """A step with its edge within one step's travel."""
        now = self.state
        contact = self.solver.trial(dt, segment.control, segment.value(end), now.edge, self._reach(now))
        if not contact.in_equilibrium:
            return StepCandidate(contact, {}, math.inf)
        radius = self.solver.radius(contact)
        force = contact.force
        quantities = {
            "force": (force, now.force, self.force_scale(force, contact.singular_force, radius)),
            "radius": (radius, now.radius, _RADIUS_SCALE * self.setup.radius_scale(radius)),
        }
        if segment.control != "penetration":
            scale = self.recorder.depth_scale()
            quantities["penetration"] = contact.penetration, now.penetration, scale
        slopes = {name: (new - old) / dt for name, (new, old, _) in quantities.items()}
        scales = {name: scale for name, (_, _, scale) in quantities.items()}
        error = max(self.estimator.error(slopes, scales, dt), self._path_error(contact, radius))
        return StepCandidate(contact, slopes, error)

    def _path_error(self, contact: ContactCandidate, radius: float) -> float:
        """Error of the edge's path over a step, relative to the allowed one.

        The force does not show it where it follows the loading whatever the edge does, as on a soft spring.
        The missed distance is of the third order in the step; errors are of the second.
        """
        if radius <= 0.0:
            return 0.0
        allowed = _MISSED_RADIUS * self.estimator.tolerance * self.setup.radius_scale(radius)
        return (self.solver.missed_by_extrapolation(contact) / allowed) ** (2.0 / 3.0)

    def _travel(self) -> float:
        """Edge travel allowed in the present step.

        Without a history each state is an equilibrium by itself, and the edge may pass many zones in a step;
        the shortest step alone keeps to the travel of the others: what lies farther is reached in a jump.
        """
        travel, interval = self.setup.travel, self.interval
        if self.setup.has_history or interval is None or interval.shortest:
            return travel
        return max(_ELASTIC_TRAVEL * travel, _ELASTIC_SHARE * self.state.radius)

    def _reach(self, now: SurfaceState) -> tuple[float, float]:
        """Edge positions within one step's travel, at least one node either way."""
        geometry, travel = self.setup.geometry, self._travel()
        low, high = geometry.position(now.radius - travel), geometry.position(now.radius + travel)
        return min(low, now.edge - 1.0), max(high, now.edge + 1.0)

    def _deviation(self, segment: Segment, interval: DyadicInterval, span: float) -> float:
        """Deviation of the prescribed value from its tangent over a step, relative to the allowed one."""
        if segment.linear or span == 0.0:
            return 0.0
        largest = deviation_from_tangent(segment, interval.time, interval.next_time)
        return largest / (_DEVIATION_PER_TOLERANCE * self.estimator.tolerance * span)

    def _zone_fills_contact(self, contact: ContactCandidate) -> bool:
        """Whether a zone of fixed stress fills its contact, which is followed no farther."""
        if self.setup.geometry.stress is None or not contact.in_equilibrium:
            return False
        return contact.problem.zone(contact.edge.s) >= self.solver.radius(contact)


_LENGTH_TOLERANCE = 1e-14
"""Accuracy of the length of the step, relative to it: close to rounding."""


class _NoEquilibrium(Exception):
    """A shorter step does not end in equilibrium."""


def step_to_level(
    run: TriedSteps, segment: Segment, trigger: Trigger, dt: float, contact: ContactCandidate
) -> ContactCandidate | None:
    """The state at the level; ``None`` if the step does not pass it, or passes it in a jump of the edge."""
    now = run.state
    before = trigger.excess(now.penetration, now.force, now.radius)

    def excess_of(candidate: ContactCandidate) -> float:
        if not candidate.in_equilibrium:
            raise _NoEquilibrium
        return trigger.excess(candidate.penetration, candidate.force, run.solver.radius(candidate))

    def excess(length: float) -> float:
        if length == 0.0:
            return before
        return excess_of(run.trial_step(segment, length, run.time + length).contact)

    try:
        if before * excess_of(contact) > 0.0:
            return None
        length = float(brentq(excess, 0.0, dt, xtol=_LENGTH_TOLERANCE * dt, rtol=1e-15))
        return run.trial_step(segment, length, run.time + length).contact
    except _NoEquilibrium:
        return None


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
        """The first trial step that is accepted, not committed, and its error; the interval has its size."""
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
            long = interval.dt > _ZONE_END_SHARE * (interval.end - interval.start) and not interval.shortest
            if long and self._zone_fills_contact(contact):
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
        self.setup.history.take_back(before.history)
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
        if not landed.in_equilibrium or self._below_zone(landed) or self._zone_fills_contact(landed):
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
