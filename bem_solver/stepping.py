"""The loop: trial steps, accepted or not. What is accepted, ``state_committer`` makes the state.

Where the edge goes beyond its travel limit even at constant load, with that limit reduced sixty-fourfold, the
contact is unstable: recorded as an event, followed by the next stable contact at the same load or, without
one, by detachment.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from bem_solver.half_space_state import HalfSpaceState
from bem_solver.instantaneous_events import LARGEST_TRAVEL_SHARE, without_contact
from bem_solver.limit_point import near_limit_point, to_limit_point
from bem_solver.loading_intervals import LoadingInterval
from bem_solver.problem import Problem
from bem_solver.profiles import surface_profile
from bem_solver.run_state import GradedState, RejectedStep, StepSettings, StepStart
from bem_solver.state_committer import GradedStateCommitter
from bem_solver.step import TrialStep
from bem_solver.step_acceptance import edge_leaps, zone_fills_contact
from bem_solver.step_control import SHARE_OF_WAY, shrunk
from bem_solver.step_error import load_error
from bem_solver.step_limits import limited_step
from bem_solver.step_result import FailedStep, StepFailure
from bem_solver.step_trials import StepTrials
from bem_solver.trigger import to_level
from contact_scene import Outcome, OutcomeKind, RunMonitor
from contact_scene.loading import passed
from contact_scene.run_control import LoadingCursor, budget_outcome, interruption

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

    def follow(self, interval: LoadingInterval, report: Callable[[float], None]) -> Outcome | None:
        """Take the run through an interval; an outcome if it ends there."""
        state = self.state
        start = StepStart(self.problem, self.settings, state, interval)
        committer = GradedStateCommitter(start, report)
        committer.begin_interval()
        while state.parameter < interval.length:
            time = state.contact.time
            outcome = (
                interruption(self.monitor, time)
                or budget_outcome(self.problem.counters, self.max_steps, time)
                or self._advance(committer)
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

    def _advance(self, committer: GradedStateCommitter) -> Outcome | None:
        """One trial step and what follows from it; an outcome if the run ends with it."""
        start = committer.start
        state, problem, interval = start.state, start.problem, start.interval
        if state.contact.edge == 0.0:
            return committer.take(without_contact(start))
        state.accepted.least = start.smallest_travel
        if not state.sought_limit_point and near_limit_point(start):
            return self._to_limit_point(committer)
        state.step, step = limited_step(start)
        if step < math.ulp(state.parameter):
            if math.isfinite(state.accepted.way_to_limit_point()):  # no time resolves the rest of it
                receding = state.accepted.rates(0.0)[0] < 0.0
                return committer.move_unstably(receding)
            reason = "the step fell below rounding"
            return Outcome(OutcomeKind.STEP_UNDERFLOW, reason, state.contact.time)
        trial_step = TrialStep(problem, self.settings, state, interval, step)
        result = trial_step.result()
        if isinstance(result, FailedStep):
            problem.counters.rejected_steps += 1
            return self._after_failure(result, step, committer)
        result = trial_step.checked_in_the_middle(result)
        travel = abs(result.trial.motion.new_edge - state.contact.edge)
        taken = result.parameter - state.parameter
        if zone_fills_contact(start, result, taken):
            problem.counters.rejected_steps += 1
            state.step = 0.25 * taken
            return None
        of_load = load_error(start, result.trial, taken) if result.error > 1.0 else 0.0
        leaps = result.error > 1.0 and edge_leaps(start, RejectedStep(taken, travel, of_load))
        at_once = leaps or taken <= _SLIGHTLY_LONGER * start.shortest_step
        if result.error > 1.0 and not at_once:
            problem.counters.rejected_steps += 1
            at_jump = trial_step.to_speed_jump(result)
            if at_jump is not None and at_jump.parameter == state.parameter:
                committer.speed_jumps()
                at_jump = None
            if at_jump is None or at_jump.error > 1.0:
                state.rejected.append(RejectedStep(taken, travel, of_load))
                state.step = shrunk(taken, result.error, 2 if len(state.accepted.rows) > 1 else 1)
                return None
            result = at_jump
        if interval.trigger is None or interval.jump:
            return committer.accept(result, leaps)
        located = to_level(trial_step, interval.trigger, result)
        outcome = committer.accept(located.candidate, leaps)
        if located.reached:
            self.cursor.level_reached()
        return outcome

    def _to_limit_point(self, committer: GradedStateCommitter) -> Outcome | None:
        """A step that ends on the limit point ahead, and the unstable motion from there, if there is one."""
        start, state = committer.start, committer.start.state
        state.sought_limit_point = True
        step = state.accepted.step_to_limit_point()
        candidate = to_limit_point(StepTrials(self.problem, self.settings, state, start.interval, step))
        if candidate is None:
            return None
        receding = candidate.trial.motion.new_edge < state.contact.edge
        outcome = committer.accept(candidate, False)
        return outcome or committer.move_unstably(receding)

    def _after_failure(
        self, failed: FailedStep, step: float, committer: GradedStateCommitter
    ) -> Outcome | None:
        """Change travel limit or step, or let the edge move unstably; an outcome if the run ends with it."""
        start, state = committer.start, committer.start.state
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
                if smallest < reach and step > 1e-12 * start.interval.length:
                    state.travel_share = closer
                    state.rejected.append(RejectedStep(step, failed.travel))
                    state.step = shrunk(step, math.inf)
                    return None
        return committer.move_unstably(failed.receding)
