"""The loop: trial steps, accepted or not; only here is state committed.

Where the edge goes beyond its travel limit even at constant load, with that limit reduced sixty-fourfold, the
contact is unstable: recorded as an event, followed by the next stable contact at the same load or, without
one, by detachment.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from bem_solver.half_space_state import HalfSpaceState
from bem_solver.instantaneous_events import (
    LARGEST_TRAVEL_SHARE,
    EdgeJump,
    FreeMotion,
    contact_lost,
    lift_off,
    released,
    unstable_motion,
    without_contact,
)
from bem_solver.limit_point import near_limit_point, to_limit_point
from bem_solver.loading_intervals import LoadingInterval
from bem_solver.problem import Problem
from bem_solver.profiles import surface_profile
from bem_solver.run_state import GradedState, RejectedStep, StepSettings, StepStart
from bem_solver.state_update import updated_state
from bem_solver.step import TrialStep
from bem_solver.step_control import SHARE_OF_WAY, AcceptedRow, grown, shrunk
from bem_solver.step_error import free_load, load_error
from bem_solver.step_limits import limited_step
from bem_solver.step_result import Candidate, FailedStep, StepFailure
from bem_solver.step_trials import StepTrials
from bem_solver.trial import EDGE_ACCURACY, TrialContact
from bem_solver.trigger import to_level
from contact_scene import Outcome, OutcomeKind, RunMonitor
from contact_scene.run_control import (
    KeptState,
    LoadingCursor,
    below_zone_outcome,
    budget_outcome,
    interruption,
)
from contact_scene.trigger import passed

SOLVER = "bem"
_ZONE_END_SHARE = 1e-4
"""Longest step, in intervals, within which a zone of fixed stress may come to fill its contact: the end."""

_SLIVER = 1e-9
"""Part of a step by which it may differ from the one wanted by rounding."""
_AS_FAR = 0.99
"""Travel, in that of a longer step in which nothing relaxes either, from which on an edge leaps: equal ones
differ by rounding."""
_SLIGHTLY_LONGER = 1.5
"""Step, in shortest ones, up to which it is as short as can be: it is rounded to multiples of a quarter."""


@dataclass
class GradedRun:
    """A run on graded annuli: what stays, and the state that changes."""

    problem: Problem
    settings: StepSettings
    max_steps: int
    cursor: LoadingCursor
    state: GradedState
    monitor: RunMonitor | None = None

    def reached(self) -> tuple[float, float, float]:
        """Time, penetration and force of the committed state."""
        contact = self.state.contact
        return contact.time, contact.penetration, contact.surface.force

    def reached_radius(self) -> float:
        """Contact radius of the committed state."""
        return self.state.contact.edge

    def record_profile(self) -> None:
        """Record the surface in the committed state."""
        self.state.record.profile(surface_profile(self.problem, self.state.contact))

    def kept(self) -> KeptState:
        """The state to continue from."""
        return KeptState(SOLVER, self.cursor, self.problem.counters, self.state)

    def follow(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """Take the run through an interval, from where it stands in it; an outcome if it ends there."""
        state = self.state
        if not state.begun:
            self._begin(interval)
        while state.parameter < interval.length:
            time = state.contact.time
            outcome = (
                interruption(self.monitor, self.kept, time)
                or budget_outcome(self.problem.counters, self.max_steps, time)
                or self._advance(interval, report)
            )
            if outcome is not None:
                return outcome
            if self._triggered(interval, state.contact):
                break
        state.interval_done()
        if interval.jump:
            state.step = 0.0  # it was a share of the jump, not a time
        return None

    def _triggered(self, interval: LoadingInterval, contact: HalfSpaceState) -> bool:
        """Whether the committed state has reached the level that ends the load step; a load jump is whole."""
        if interval.trigger is None or interval.jump or self.cursor.trigger_side is None:
            return False
        excess = interval.trigger.excess(contact.penetration, contact.surface.force, contact.edge)
        return passed(self.cursor.trigger_side, excess)

    def _begin(self, interval: LoadingInterval) -> None:
        """First step and rates of an interval."""
        state = self.state
        if interval.after_kink:
            state.record.kink()
            state.contact = replace(state.contact, last_step=None)
            short, first = 0.05 * interval.length, 0.01 * interval.length
            if self.problem.viscoelastic and not interval.jump:  # what has jumped relaxes from the start
                first = min(first, float(self.problem.chain.retardation.min()))
            state.step = min(state.step, short) if state.step > 0.0 else first
            state.accepted.start(self._accepted_row(0.0, interval))
        else:
            state.accepted.continue_in_next_interval()
        if interval.jump:
            state.step = 0.1
        state.begun = True

    def _advance(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """One trial step and what follows from it; an outcome if the run ends with it."""
        state, problem = self.state, self.problem
        start = StepStart(problem, self.settings, state, interval)
        if state.contact.edge == 0.0:
            return self._after_event(without_contact(start), interval, report)
        state.accepted.least = start.smallest_travel
        if not state.sought_limit_point and near_limit_point(start):
            return self._to_limit_point(start, report)
        state.step, step = limited_step(start)
        if step < math.ulp(state.parameter):
            if math.isfinite(state.accepted.way_to_limit_point()):  # no time resolves the rest of it
                receding = state.accepted.rates(0.0)[0] < 0.0
                return self._after_limit_point(start, receding, report)
            reason = "the step fell below rounding"
            return Outcome(OutcomeKind.STEP_UNDERFLOW, reason, state.contact.time)
        trial_step = TrialStep(problem, self.settings, state, interval, step)
        result = trial_step.result()
        if isinstance(result, FailedStep):
            problem.counters.rejected_steps += 1
            return self._after_failure(result, step, start, report)
        travel = abs(result.trial.motion.new_edge - state.contact.edge)
        taken = result.parameter - state.parameter
        if self._overshoots_its_zone(result, taken, interval):
            problem.counters.rejected_steps += 1
            state.step = 0.25 * taken
            return None
        of_load = load_error(start, result.trial, taken) if result.error > 1.0 else 0.0
        leaps = result.error > 1.0 and self._leaps(RejectedStep(taken, travel, of_load), interval)
        at_once = leaps or taken <= _SLIGHTLY_LONGER * start.shortest_step
        if result.error > 1.0 and not at_once:
            problem.counters.rejected_steps += 1
            at_jump = trial_step.to_speed_jump(result)
            if at_jump is not None and at_jump.parameter == state.parameter:
                self._speed_jumps(interval)
                at_jump = None
            if at_jump is None or at_jump.error > 1.0:
                state.rejected.append(RejectedStep(taken, travel, of_load))
                state.step = shrunk(taken, result.error, 2 if len(state.accepted.rows) > 1 else 1)
                return None
            result = at_jump
        if interval.trigger is None or interval.jump:
            return self._accept(result, start, report, leaps)
        located = to_level(trial_step, interval.trigger, result)
        outcome = self._accept(located.candidate, start, report, leaps)
        if located.reached:
            self.cursor.level_reached()
        return outcome

    def _to_limit_point(self, start: StepStart, report: Callable[[float], None]) -> Outcome | None:
        """A step that ends on the limit point ahead, and the unstable motion from there, if there is one."""
        state, interval = self.state, start.interval
        state.sought_limit_point = True
        step = state.accepted.step_to_limit_point()
        candidate = to_limit_point(StepTrials(self.problem, self.settings, state, interval, step))
        if candidate is None:
            return None
        receding = candidate.trial.motion.new_edge < state.contact.edge
        outcome = self._accept(candidate, start, report, False)
        return outcome or self._after_limit_point(start, receding, report)

    def _overshoots_its_zone(self, candidate: Candidate, taken: float, interval: LoadingInterval) -> bool:
        """Whether a zone of fixed stress comes to fill its contact within a step that is not yet short."""
        adhesion = self.problem.scene.adhesion
        if adhesion is None or adhesion.stress is None or self.problem.work == 0.0:
            return False
        fills = candidate.trial.zone >= candidate.trial.motion.new_edge
        return fills and taken > _ZONE_END_SHARE * interval.length

    def _leaps(self, now: RejectedStep, interval: LoadingInterval) -> bool:
        """Whether the edge passes an annulus at once: shorter steps do not shorten its travel.

        Nor, where the load misses its line, do they mend that, though nothing relaxes in them. An edge whose
        load has just turned goes nearly as far in a tenth of the time, and does not leap.
        """
        length = self.problem.length_at(self.state.contact.edge)
        if now.travel <= 10.0 * EDGE_ACCURACY * self.settings.tolerance * length:
            return False
        shortest = math.inf if interval.jump else self.problem.chain.relaxation.min(initial=math.inf)
        as_far = [
            before
            for before in self.state.rejected
            if (now.step < 0.01 * before.step and now.travel > 0.7 * before.travel)
            or (now.step < 0.5 * before.step <= 0.5 * shortest and now.travel > _AS_FAR * before.travel)
        ]
        if now.load_error <= 1.0:
            return bool(as_far)
        return any(
            now.step < 0.25 * before.step <= 0.25 * shortest and now.load_error > 0.7 * before.load_error
            for before in as_far
        )

    def _accept(
        self, candidate: Candidate, start: StepStart, report: Callable[[float], None], leaps: bool
    ) -> Outcome | None:
        """Commit a candidate; an outcome if the contact ends with it.

        Where its edge ``leaps``, passing an annulus at once, its speed says nothing of the next step.
        """
        state, record, interval = self.state, self.state.record, start.interval
        state.rejected, state.sought_limit_point = [], False
        taken = candidate.parameter - state.parameter
        order = 3 if self.problem.curves else 2  # of a parabola, or of a straight line
        state.step = max(grown(taken, candidate.error, order), self._shortened(taken, candidate.error))
        state.follow_slope(candidate.slope)
        state.parameter = candidate.parameter
        coarseness = start.coarseness(abs(candidate.trial.motion.new_edge - state.contact.edge))
        self._commit(candidate.trial, interval.time(state.parameter), report, coarseness)
        edge = state.contact.edge
        remember = state.accepted.start if leaps else state.accepted.add
        remember(self._accepted_row(state.parameter, interval))
        if candidate.speed_jumps and candidate.trial.motion.edge == edge:  # at rest until now: rates hold
            record.kink()
        elif candidate.speed_jumps:
            self._speed_jumps(interval)
        state.travel_share = min(1.0, 2.0 * state.travel_share)
        if edge <= max(self.problem.zone, candidate.trial.zone):
            return below_zone_outcome(record.forces, state.contact.time)
        return self._lift_off(start) if contact_lost(start) else None

    def _lift_off(self, start: StepStart) -> Outcome:
        """The end of a contact without adhesion."""
        state = self.state
        state.contact, state.energies = lift_off(start)
        state.record.event("pull-off", state.contact)
        state.record.row(self.problem.chain, state.contact, state.energies)
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", state.contact.time)

    def _accepted_row(self, parameter: float, interval: LoadingInterval) -> AcceptedRow:
        """What the committed state adds to the accepted ones of its interval."""
        contact = self.state.contact
        surface, load = contact.surface, free_load(interval, contact)
        ahead = surface.load_ahead(self.problem.ahead)
        return AcceptedRow(parameter, contact.edge, load, surface.edge_load, ahead)

    def _speed_jumps(self, interval: LoadingInterval) -> None:
        """Slopes jump at the committed state: those from before it tell nothing about what comes."""
        state = self.state
        state.record.kink()
        state.accepted.start(self._accepted_row(state.parameter, interval))

    def _after_failure(
        self, failed: FailedStep, step: float, start: StepStart, report: Callable[[float], None]
    ) -> Outcome | None:
        """Change travel limit or step, or let the edge move unstably; an outcome if the run ends with it."""
        state, interval = self.state, start.interval
        smallest = start.smallest_travel
        at_limit_point = min(state.accepted.way_to_limit_point(), failed.way) < smallest
        reach = start.reach(not failed.receding)
        closer = state.travel_share * min(0.5, SHARE_OF_WAY * failed.way / reach)
        match failed.failure:
            case _ if at_limit_point:
                pass
            case StepFailure.UNRESOLVED:
                state.travel_share *= 4.0
                if state.travel_share <= LARGEST_TRAVEL_SHARE:
                    return None
            case StepFailure.BEYOND_TRAVEL_LIMIT:
                if smallest < reach and state.travel_share <= LARGEST_TRAVEL_SHARE:
                    state.travel_share = closer
                    return None
            case StepFailure.UNSTABLE:
                if smallest < reach and step > 1e-12 * interval.length:
                    state.travel_share = closer
                    state.rejected.append(RejectedStep(step, failed.travel))
                    state.step = shrunk(step, math.inf)
                    return None
        return self._after_limit_point(start, failed.receding, report)

    def _after_limit_point(
        self, start: StepStart, receding: bool, report: Callable[[float], None]
    ) -> Outcome | None:
        """Let the edge move unstably; an outcome if the run ends with it."""
        state = self.state
        event = unstable_motion(start, receding)
        if isinstance(event, Outcome) and receding and self.problem.ends_in_a_point:
            return self._lift_off(start)
        if isinstance(event, Outcome) or event.event:
            state.record.event("pull-off" if receding else "snap-in", state.contact)
        lost = isinstance(event, Outcome) and event.kind is OutcomeKind.DETACHED
        if lost and start.interval.control == "stage":
            state.contact, state.energies = released(start)
            state.record.row(self.problem.chain, state.contact, state.energies)
        return self._after_event(event, start.interval, report)

    def _after_event(
        self,
        event: FreeMotion | EdgeJump | Outcome,
        interval: LoadingInterval,
        report: Callable[[float], None],
    ) -> Outcome | None:
        """Commit what an instantaneous event leads to; an outcome if the run ends with it."""
        state = self.state
        if isinstance(event, Outcome):
            return event
        state.parameter = event.parameter
        if isinstance(event, FreeMotion):
            state.contact = event.contact
            state.record.row(self.problem.chain, state.contact, state.energies)
            return None
        state.sought_limit_point = False
        self._commit(event.trial, interval.time(event.parameter), report)
        state.contact = replace(state.contact, last_step=None)
        state.accepted.start(self._accepted_row(event.parameter, interval))
        state.travel_share, state.step = 1.0, event.next_step
        state.record.kink()
        return None

    def _shortened(self, taken: float, error: float) -> float:
        """The step that a stop or a largest tension has cut short, to go on with; 0 if none has."""
        step = self.state.step
        return step if error <= 1.0 and taken < (1.0 - _SLIVER) * step else 0.0

    def _commit(
        self, trial: TrialContact, time: float, report: Callable[[float], None], coarseness: float = 1.0
    ) -> None:
        """Make the trial the state, its history coarsened by a part of what is usual."""
        state, surface = self.state, trial.surface
        if not (math.isfinite(surface.force) and math.isfinite(trial.motion.new_penetration)):
            raise FloatingPointError("force or penetration is not finite")
        state.contact, state.energies = updated_state(
            self.problem,
            state.contact,
            state.energies,
            trial,
            time,
            self.settings.divisions,
            self.settings.tolerance,
            coarseness,
        )
        state.largest_force = max(state.largest_force, abs(surface.force))
        state.largest_tension = max(state.largest_tension, -surface.force)
        state.largest_edge = max(state.largest_edge, surface.edge)
        self.problem.counters.steps += 1
        state.record.row(self.problem.chain, state.contact, state.energies)
        report(time)
