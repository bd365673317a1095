"""The loop over load steps: it asks for trial steps and is the only place where one is accepted.

A trial (``contact_solver``, ``events``) returns a candidate and changes nothing. Stops and kinks of the
loading are stepped onto exactly; between them the steps are dyadic (``step_control``). Penetration is
positive downwards, force positive in compression.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from contact_scene import (
    Counters,
    KeptState,
    Loading,
    LoadingCursor,
    Outcome,
    OutcomeKind,
    RunMonitor,
    Segment,
)
from contact_scene.run_control import (
    Stop,
    below_zone_outcome,
    budget_outcome,
    interruption,
    stops_within,
)
from contact_scene.segment import Control
from fem_solver.contact_solver import ContactCandidate, ContactSolver
from fem_solver.curved_loads import deviation_from_tangent, swing
from fem_solver.edge import NO_CONTACT, AdhesiveEdge, EdgeMotion, EdgePosition
from fem_solver.events import LoadJump, edge_jump, zone_reached
from fem_solver.following.contact_solver import FollowingContactSolver
from fem_solver.following.setup import FollowingSetup
from fem_solver.irreversible_edge import IrreversibleEdge, energy_spent
from fem_solver.recorder import SOLVER, SurfaceRecorder, SurfaceState
from fem_solver.release import EdgeOrigin
from fem_solver.run_state import NodeReleaseState, StepBefore, StepCandidate, TensionPeak
from fem_solver.setup import Setup
from fem_solver.step_control import DyadicInterval, SlopeErrorEstimator, missed_peak
from fem_solver.trigger import step_to_level

Array = NDArray[np.float64]

_REJECT = 2.0
"""A step is rejected if its estimated error exceeds this multiple of the allowed one."""
_SHORTEST = 1e-6
"""Shortest step, relative to the shortest relaxation time or the interval: below it the edge is unstable."""
_MISSED_TENSION = 0.1
"""Tension that rows may miss of its largest value, relative to the allowed error of the force."""
_FIRST = 1.0 / 64.0
"""First step, relative to the interval; twice that relative to the shortest relaxation time."""
_ZONE_END_SHARE = 1e-4
"""Longest step, in intervals, within which a zone of fixed stress may come to fill its contact: the end."""
_EVENT_TRAVEL = 4.0
"""An edge jump is recorded as an event if it exceeds this multiple of the edge travel allowed per step."""
_DEVIATION_PER_TOLERANCE = 10.0
"""Deviation of the prescribed value from its tangent over a step, per tolerance, relative to its swing."""
_RADIUS_SCALE = 10.0
"""Allowed error of the radius per that of the force, relative to their sizes: the travel bounds it closer."""
_ELASTIC_TRAVEL = 4.0
"""Factor on the edge travel per step of an elastic solid, which has no history to resolve."""
_ELASTIC_SHARE = 0.1
"""Edge travel per step of an elastic solid, relative to the contact radius, where that is more."""
ELASTIC_TOLERANCE = 0.04
"""Allowed error of the rows of an elastic solid per that of others: steps are few, and of its work a small
difference, the hysteresis of the jumps, is what counts."""


class _RunEnded(Exception):
    """The run ends before its loading does."""

    def __init__(self, outcome: Outcome) -> None:
        super().__init__(outcome.reason)
        self.outcome = outcome


@dataclass
class NodeReleaseRun:
    """A run from its start state through its loading.

    Parameters
    ----------
    setup : Setup or FollowingSetup
    recorder : SurfaceRecorder
    estimator : SlopeErrorEstimator
    force_scale : callable(float) -> float
        Force to which errors of the force are relative, at a contact radius.
    max_steps : int
        Budget of trial steps.
    requested : frozenset of float
        Times stepped onto beside kinks and ends of load steps.
    on_stop : callable(float)
        Called at the start and at every stop.
    on_commit : callable(float, ndarray)
        Called after every accepted step with its length and nodal forces.
    on_take_back : callable()
        Called after the last step has been taken back.
    monitor : RunMonitor or None
    progress : callable(float) or None
    """

    setup: Setup | FollowingSetup
    recorder: SurfaceRecorder
    estimator: SlopeErrorEstimator
    force_scale: Callable[[float], float]
    max_steps: int
    requested: frozenset[float]
    on_stop: Callable[[float], None]
    on_commit: Callable[[float, Array], None]
    on_take_back: Callable[[], None]
    monitor: RunMonitor | None = None
    progress: Callable[[float], None] | None = None
    cursor: LoadingCursor = field(default_factory=LoadingCursor)
    counters: Counters = field(default_factory=Counters)
    time: float = 0.0
    interval: DyadicInterval | None = None
    step: float | None = None
    before: StepBefore | None = None

    def __post_init__(self) -> None:
        self.solver: ContactSolver
        if isinstance(self.setup, FollowingSetup):
            following = FollowingContactSolver(self.setup, self.counters)
            self.solver = following  # type: ignore[assignment] # another class with the same methods
        else:
            self.solver = ContactSolver(self.setup, self.counters, self._edge_origin)

    @property
    def state(self) -> SurfaceState:
        """The last accepted state."""
        return self.recorder.last

    def _continuous_rates(self) -> dict[str, float]:
        """Rates that do not jump at a kink of the loading: that of an edge whose energy follows its speed."""
        law = self.setup.law
        if not isinstance(law, IrreversibleEdge) or law.adhesion.rate is None:
            return {}
        return {"radius": self.state.rate}

    def _edge_origin(self) -> EdgeOrigin | None:
        """Edge of the last accepted state; the step to it counts unless rates jump there."""
        last = self.recorder.content.last
        if last is None:
            return None
        smooth = "radius" in self.estimator.slopes
        return EdgeOrigin(last.edge, last.radius, last.rate, last.duration if smooth else 0.0)

    def snapshot(self) -> KeptState:
        """Serialisable state; it shares what the run will change."""
        content = NodeReleaseState(
            self.time,
            self.interval,
            self.step,
            self.estimator.slopes,
            self.recorder.content,
            self.setup.history.snapshot(),
            self.before,
        )
        return KeptState(SOLVER, self.cursor, self.counters, content)

    def restore(self, kept: KeptState) -> None:
        """Continue from a state of the same scene, mesh and options."""
        content: NodeReleaseState = kept.content
        self.cursor = kept.cursor
        self.counters = self.solver.counters = kept.counters
        self.time, self.interval, self.step = content.time, content.interval, content.step
        self.estimator.slopes = content.slopes
        self.recorder.content, self.before = content.recorded, content.before
        self.setup.history.restore(content.history)  # type: ignore[arg-type]

    def start(self, loading: Loading) -> Outcome | None:
        """Accept the start state; an outcome if there is none."""
        relaxed = loading.start == "relaxed"
        candidate = self.solver.start(loading.start_control, loading.penetration, relaxed)
        try:
            if candidate.edge.motion is EdgeMotion.RECEDING:
                reason = f"no stable contact at penetration {loading.penetration:.6g}"
                self._end(OutcomeKind.NO_EQUILIBRIUM, reason)
            if not candidate.in_equilibrium:
                self._contact_lost(candidate)
            self._commit(candidate)
        except _RunEnded as ended:
            return ended.outcome
        self.on_stop(self.time)
        return None

    def carry_out(self, loading: Loading) -> Outcome:
        """The loading, from where the run stands in it."""
        try:
            while not self.cursor.done(loading):
                state = self.state
                segment = self.cursor.segment(loading, self.time, state.penetration, state.force)
                self._carry_out_step(loading, segment)
                self.cursor.step_done()
        except _RunEnded as ended:
            return ended.outcome
        return Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", self.time)

    def _carry_out_step(self, loading: Loading, segment: Segment) -> None:
        """One load step: its jump, if any, then the intervals between its stops."""
        cursor = self.cursor
        if not cursor.jump_done:
            self._triggered(segment)
            self._load_jump(segment)
            cursor.jump_done, self.step = True, None
        if self._triggered(segment):
            return
        self._check_clock(segment)
        span = swing(segment)
        stops = stops_within(segment, self.requested)
        while cursor.stops_reached < len(stops):
            reached = cursor.stops_reached
            start = stops[reached - 1].time if reached else segment.start
            if stops[reached].time > start:
                self._carry_out_interval(loading, segment, start, stops[reached], span)
            if self._triggered(segment):
                self.estimator.reset()
                self.interval = self.step = self.before = None
                return
            cursor.stop_reached()
        if segment.trigger is not None:
            raise _RunEnded(segment.trigger.not_reached(self.time))

    def _triggered(self, segment: Segment) -> bool:
        """Whether the accepted state has reached the level that ends the load step."""
        state = self.state
        return self.cursor.triggered(segment, state.penetration, state.force, state.radius)

    def _carry_out_interval(
        self, loading: Loading, segment: Segment, start: float, stop: Stop, span: float
    ) -> None:
        """From one stop to the next; ``span`` is the swing of the prescribed value over the load step."""
        if self.interval is None:
            self.interval, self.before = self._new_interval(start, stop.time), None
        while not self.interval.done:
            outcome = interruption(self.monitor, self.snapshot, self.time)
            if outcome is not None:
                raise _RunEnded(outcome)
            self._advance(segment, self.interval, span)
            if self.progress is not None:
                self.progress(self.cursor.share(loading, segment, self.time))
            if self._triggered(segment):
                return
        self.on_stop(stop.time)
        if stop.kink:
            self.estimator.reset(self._continuous_rates())
        self.step = None if stop.kink else self.interval.dt
        self.interval = None

    def _new_interval(self, start: float, end: float) -> DyadicInterval:
        interval, length, relaxation = DyadicInterval(start, end), end - start, self.setup.shortest_time
        first = self.step or min(_FIRST * length, 2.0 * _FIRST * relaxation)
        interval.limit(first, _SHORTEST * min(relaxation, length))
        return interval

    def _advance(self, segment: Segment, interval: DyadicInterval, span: float) -> None:
        """One accepted step, after as many trials as it takes."""
        while True:
            deviation = self._deviation(segment, interval, span)
            if deviation > _REJECT and not interval.shortest:
                interval.halve()
                continue
            self._check_budget()
            candidate = self.trial_step(segment, interval.dt, interval.next_time)
            error = max(deviation, candidate.error)
            if self._overshoots_its_zone(candidate.contact, interval):
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
                break
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
            contact, slopes, error = self._edge_jump(contact), {}, 0.0
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

    def _overshoots_its_zone(self, contact: ContactCandidate, interval: DyadicInterval) -> bool:
        """Whether a zone of fixed stress comes to fill its contact within a step that is not yet short."""
        if self.setup.geometry.stress is None or not contact.in_equilibrium or interval.shortest:
            return False
        fills = contact.problem.zone(contact.edge.s) >= self.solver.radius(contact)
        return fills and interval.dt > _ZONE_END_SHARE * (interval.end - interval.start)

    def _reject(self, interval: DyadicInterval) -> None:
        self.counters.rejected_steps += 1
        interval.halve()

    def _tension_peak(self, candidate: StepCandidate) -> TensionPeak | None:
        """The turn of the tension at the last row, if it is the largest so far."""
        tension = -self.state.force
        rise, fall = -self.estimator.slopes.get("force", 0.0), candidate.slopes.get("force", math.inf)
        allowed = _MISSED_TENSION * self.estimator.tolerance * self.force_scale(self.state.radius)
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

    def trial_step(self, segment: Segment, dt: float, end: float) -> StepCandidate:
        """A step of length ``dt`` that ends at the time ``end``, its edge within one step's travel."""
        now = self.state
        contact = self.solver.trial(dt, segment.control, segment.value(end), now.edge, self._reach(now))
        if not contact.in_equilibrium:
            return StepCandidate(contact, {}, math.inf)
        radius = self.solver.radius(contact)
        quantities = {
            "force": (contact.force, now.force, self.force_scale(radius)),
            "penetration": (contact.penetration, now.penetration, self.recorder.depth_scale()),
            "radius": (radius, now.radius, _RADIUS_SCALE * radius),
        }
        if segment.control == "penetration":
            del quantities["penetration"]
        slopes = {name: (new - old) / dt for name, (new, old, _) in quantities.items()}
        scales = {name: scale for name, (_, _, scale) in quantities.items()}
        return StepCandidate(contact, slopes, self.estimator.error(slopes, scales, dt))

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

    def _load_jump(self, segment: Segment) -> None:
        """The load jump, if any, with which a load step begins."""
        state, target = self.state, segment.value(segment.start)
        before = segment.present(state.penetration, state.force)
        if abs(target - before) <= 1e-12 * max(abs(before), abs(target)):
            self.estimator.reset(self._continuous_rates())
            return
        self.estimator.reset()
        jump = LoadJump(segment.control, before, target)
        while not jump.complete:
            self._check_budget()
            candidate = jump.trial(self.solver, self.state, self.estimator.tolerance)
            if candidate is None:
                self.counters.rejected_steps += 1
                jump.halve()
                continue
            if not candidate.in_equilibrium:
                self._contact_lost(candidate)
            if self._below_zone(candidate):
                self._end_in_jump(jump)
            self._commit(candidate)
            jump.advance()

    def _edge_jump(self, candidate: ContactCandidate) -> ContactCandidate:
        """The state after an edge jump; it is an event if the edge jumps far."""
        landed = edge_jump(self.solver, candidate)
        if not landed.in_equilibrium or self._below_zone(landed):
            self._contact_lost(landed)
        if abs(self.solver.radius(landed) - self.state.radius) > _EVENT_TRAVEL * self.setup.travel:
            advancing = candidate.edge.motion is EdgeMotion.ADVANCING
            self.recorder.event("snap-in" if advancing else "pull-off")
        return landed

    def _check_clock(self, segment: Segment) -> None:
        """End where a load step is so short that its times are not told apart at the time when it begins."""
        length = segment.end - segment.start
        moves = segment.value(segment.end) != segment.value(segment.start)
        if moves and 0.0 < self.estimator.tolerance * length < math.ulp(segment.end):
            reason = f"a load step of {length:.6g} cannot be resolved after a time of {segment.start:.6g}"
            self._end(OutcomeKind.STEP_UNDERFLOW, reason)

    def _check_budget(self) -> None:
        outcome = budget_outcome(self.counters, self.max_steps, self.time)
        if outcome is not None:
            raise _RunEnded(outcome)

    def _contact_lost(self, candidate: ContactCandidate) -> NoReturn:
        """No equilibrium: the contact outgrows the mesh, or is lost."""
        geometry = self.setup.geometry
        if candidate.edge.motion is EdgeMotion.ADVANCING:
            reached = geometry.radius(candidate.edge.s)
            reason = f"the contact grows beyond the radius {reached:.6g} the mesh is made for"
            self._end(OutcomeKind.OUT_OF_RANGE, reason)
        self._pulled_off()

    def _pulled_off(self) -> NoReturn:
        self.recorder.event("pull-off")
        reason = f"contact lost at penetration {self.state.penetration:.6g}"
        if self.setup.compliance > 0.0:  # the spring takes the indenter to where the stage is
            stage = self.state.penetration + self.setup.compliance * self.state.force
            free = EdgePosition(EdgeMotion.RESTING, NO_CONTACT)
            self._commit(self.solver.held(0.0, "stage", stage, free), contact=False)
        self._end(OutcomeKind.DETACHED, reason)

    def _below_zone(self, candidate: ContactCandidate) -> bool:
        zone = self.setup.geometry.zone
        return zone is not None and self.solver.radius(candidate) < zone

    def _end_in_step(self, segment: Segment, dt: float) -> NoReturn:
        """The contact becomes shorter than its process zone within a step."""
        start = self.time

        def load(share: float) -> tuple[float, Control, float]:
            return share * dt, segment.control, segment.value(start + share * dt)

        self._end_at_zone(load)

    def _end_in_jump(self, jump: LoadJump) -> NoReturn:
        """The contact becomes shorter than its process zone within a part of a load jump."""

        def load(share: float) -> tuple[float, Control, float]:
            return 0.0, jump.control, jump.value(jump.done + share * jump.part)

        self._end_at_zone(load)

    def _end_at_zone(self, load: Callable[[float], tuple[float, Control, float]]) -> NoReturn:
        """End with the row at which the contact is as short as its process zone (see ``zone_reached``)."""
        law = self.setup.law
        assert isinstance(law, AdhesiveEdge)
        reached = zone_reached(self.solver, law.taken, load)
        if reached is None:
            self._pulled_off()
        self.time += reached.dt
        self._commit(reached)
        forces = [row[2] for row in self.recorder.content.rows]
        raise _RunEnded(below_zone_outcome(forces, self.time))

    def _end(self, kind: OutcomeKind, reason: str) -> NoReturn:
        raise _RunEnded(Outcome(kind, reason, self.time))

    def _commit(self, candidate: ContactCandidate, contact: bool = True) -> None:
        """Accept a state, in contact or free: history, row, counters."""
        forces = candidate.problem.forces(candidate.edge.s)
        penetration, force, radius = candidate.penetration, candidate.force, self.solver.radius(candidate)
        if not (np.isfinite(forces).all() and all(map(math.isfinite, (penetration, force, radius)))):
            self._end(OutcomeKind.NOT_FINITE, "a force or a radius is not finite")
        least = self.setup.resolved_from
        if contact and radius < least:
            reason = f"the contact shrinks below the radius {least:.6g} the mesh is made for"
            self._end(OutcomeKind.OUT_OF_RANGE, reason)
        history = self.setup.history
        received = self.solver.accept(candidate, forces)
        self.on_commit(candidate.dt, forces)
        displacement = history.displacement
        gap = self.setup.height - penetration + displacement
        self.counters.steps += self.recorder.content.last is not None
        self.recorder.add(
            SurfaceState(
                time=self.time,
                penetration=penetration,
                force=force,
                radius=radius,
                edge=candidate.edge.s,
                forces=forces,
                displacement=displacement,
                stored=history.stored_energy,
                interface=-0.5 * float(forces @ gap),
                branch_dissipation=history.state.dissipated,
                zone=candidate.problem.zone(candidate.edge.s),
                received=received,
                **self._interface(candidate, radius),
            )
        )
        if self.setup.geometry.stress is not None and self.state.zone >= radius:
            forces_so_far = [row[2] for row in self.recorder.content.rows]
            raise _RunEnded(below_zone_outcome(forces_so_far, self.time))

    def _interface(self, candidate: ContactCandidate, radius: float) -> dict[str, float]:
        """Closure, energy spent and rate of the edge, where they do not follow from the contact radius."""
        law, last = self.setup.law, self.recorder.content.last
        if not isinstance(law, IrreversibleEdge):
            return {}
        closure = candidate.problem.closure(candidate.edge.s)
        if last is None:
            return {"closure": closure}
        dt = candidate.dt
        spent = energy_spent(law.adhesion, (last.radius, radius), (last.closure, closure))
        rate = (radius - last.radius) / dt if dt > 0.0 else 0.0
        return {"closure": closure, "spent": last.spent + spent, "rate": rate, "duration": dt}
