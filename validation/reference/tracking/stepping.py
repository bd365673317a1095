"""The loop: take the state from stop to stop of the loading, commit the steps that are accepted."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from contact_scene import Event, Outcome, OutcomeKind, RunMonitor, Segment, Trigger
from contact_scene.loading import passed
from contact_scene.run_control import (
    LoadingCursor,
    below_zone_outcome,
    budget_outcome,
    interruption,
    stops_within,
)
from validation.reference.tracking.instantaneous import force_without_contact
from validation.reference.tracking.load_jump import load_jump
from validation.reference.tracking.located import limit_point_uncertainty
from validation.reference.tracking.options import Options
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.recorder import FORCE_OF_ROW, Recorder
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.state_committer import StateCommitter
from validation.reference.tracking.step import RowTolerances, trial_step
from validation.reference.tracking.step_outcome import StepOutcome
from validation.reference.tracking.step_to_level import excess_of, step_to_level
from validation.reference.tracking.zone_end import fills_its_zone, to_the_end_of_the_zone

NAME = "reference"
MOST_REJECTED = 400
"""Steps rejected one after the other before the run ends with an underflow of the step."""


def beyond_floating_point(error: ArithmeticError, time: float) -> Outcome:
    """The outcome of a run in which a number overflows or loses its meaning."""
    reason = f"a number is beyond the range of floating point ({error})"
    return Outcome(OutcomeKind.OUT_OF_RANGE, reason, time)


@dataclass
class FrontStepper:
    """A run in progress.

    Attributes
    ----------
    problem : FrontProblem
    options : Options
    row_tolerances : RowTolerances
        How straight the rows of the trace have to be.
    state : FrontState
    cursor : LoadingCursor
        Position in the loading.
    progress : callable(fraction), optional
    monitor : RunMonitor, optional
    outcome : Outcome or None
        ``None`` while the run goes on.
    """

    problem: FrontProblem
    options: Options
    row_tolerances: RowTolerances
    state: FrontState
    cursor: LoadingCursor = field(default_factory=LoadingCursor)
    progress: Callable[[float], None] | None = None
    monitor: RunMonitor | None = None
    outcome: Outcome | None = None

    @property
    def committer(self) -> StateCommitter:
        """What commits to the state."""
        return StateCommitter(self.problem, self.state, self.options.profile_times)

    @property
    def recorder(self) -> Recorder:
        """Recorder of the rows of the state."""
        return self.committer.recorder

    def run(self) -> Outcome:
        """Carry out all load steps."""
        try:
            return self._load_steps()
        except ArithmeticError as error:
            return beyond_floating_point(error, self.state.time)

    def _load_steps(self) -> Outcome:
        state, cursor, loading = self.state, self.cursor, self.problem.scene.loading
        self.committer.add_row()
        self.committer.add_profile(0.0)
        while not cursor.done(loading):
            self._load_step(cursor.segment(loading, state.time, state.surface.penetration, state.force))
            if self.outcome is not None:
                return self.outcome
            cursor.step_done()
        return Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", state.time)

    def _load_step(self, segment: Segment) -> None:
        state = self.state
        coarsest = self.problem.fineness.deviation * (segment.end - segment.start)
        if 0.0 < coarsest < math.ulp(segment.end):
            reason = (
                f"time steps of {coarsest:.2g}, the longest of this resolution in a load step of length "
                f"{segment.end - segment.start:.3g}, are lost in the rounding of the time {segment.end:.3g}"
            )
            self._end(OutcomeKind.OUT_OF_RANGE, reason)
            return
        if segment.control == "force" and state.surface.radius == 0.0:
            loaded = self._without_contact(segment)
            if loaded is None:
                self._end(OutcomeKind.DETACHED, "pulled without contact")
                return
            segment = loaded
        self._triggered(segment)
        self._begin(segment)
        if self.outcome is not None or self._triggered(segment):
            return
        stops = stops_within(segment, {*self.options.stop_times, *self.options.profile_times})
        for stop in stops:
            while state.time < stop.time:
                self._step(segment, stop.time)
                if self.outcome is not None:
                    return
                if self._triggered(segment):
                    self.committer.add_extremum(segment, 1)
                    return
            self.committer.add_profile(stop.time)
            if stop.kink:
                self.committer.add_extremum(segment, 1)
                self.committer.kink()
        if segment.trigger is not None:
            self.outcome = segment.trigger.not_reached(state.time)

    def _triggered(self, segment: Segment) -> bool:
        """Whether the state has reached the level that ends the load step."""
        surface = self.state.surface
        return self.cursor.triggered(segment, surface.penetration, self.state.force, surface.radius)

    def _without_contact(self, segment: Segment) -> Segment | None:
        """Load on an indenter that touches nothing, lowered until it touches; ``None`` if it is pulled."""
        state = self.state
        loaded = force_without_contact(segment, state.surface)
        if loaded is None:
            return None
        segment, surface = loaded
        if surface.penetration != state.surface.penetration:
            self.committer.commit(self.problem.candidate(state.time, surface))
        if segment.control == "force":
            self.committer.touch_of_plane_tip(segment)
        return segment

    def _begin(self, segment: Segment) -> None:
        """The load jump, if any, with which a load step begins."""
        state = self.state
        self.committer.kink()
        if segment.value(segment.start) != segment.present(state.surface.penetration, state.force):
            self._apply(load_jump(self.problem, state, segment), segment)
        elif segment.rate(segment.start) > 0.0:
            self.committer.touch_of_plane_tip(segment)

    def _step(self, segment: Segment, stop: float) -> None:
        """One trial step, applied if it is accepted."""
        state = self.state
        self.outcome = interruption(self.monitor, state.time) or budget_outcome(
            state.counters, self.options.max_steps, state.time
        )
        if self.outcome is not None:
            return
        if state.counters.rejected_steps - state.rejected_before >= MOST_REJECTED:
            self._end(OutcomeKind.STEP_UNDERFLOW, f"no step of {MOST_REJECTED} could be taken")
            return
        outcome = trial_step(self.problem, state, segment, stop, self.row_tolerances)
        reached = False
        if segment.trigger is not None and self._passes(segment.trigger, outcome):
            outcome, reached = step_to_level(
                segment.trigger,
                state,
                outcome,
                lambda end: trial_step(self.problem, state, segment, end, self.row_tolerances),
            )
        shortened = to_the_end_of_the_zone(self.problem, state, outcome, segment)
        self._apply(shortened, segment)
        if reached and shortened is outcome:
            self.cursor.level_reached()
        if self.progress is not None:
            self.progress(self.cursor.share(self.problem.scene.loading, segment, state.time))

    def _passes(self, trigger: Trigger, outcome: StepOutcome) -> bool:
        """Whether a step that takes time would pass the level of a trigger."""
        if not outcome.candidates or outcome.candidates[-1].time <= self.state.time:
            return False
        return passed(self.cursor.trigger_side or 0.0, excess_of(trigger, outcome.candidates[-1]))

    def _apply(self, outcome: StepOutcome, segment: Segment) -> None:
        """Commit what a trial step returned."""
        state = self.state
        if outcome.rejected:
            state.counters.rejected_steps += 1
        first = len(state.recorded.rows)
        for surface in outcome.equilibria:
            self.recorder.add(state.time, surface, surface.force(self.problem.body))
        for candidate in outcome.candidates:
            self.committer.commit(candidate, segment)
        if outcome.reversible:
            self.recorder.reversible(first, outcome.unstable_row)
        state.proposal, state.unstable = outcome.proposal, outcome.unstable
        state.steepening = state.steepening if outcome.steepening is None else outcome.steepening
        state.travel = state.travel if outcome.travel is None else outcome.travel
        state.steepness = state.steepness if outcome.steepness is None else outcome.steepness
        if outcome.event is not None:
            state.events.append(outcome.event)
        if outcome.first_contact:
            self.committer.touch_of_plane_tip(segment)
        if outcome.kink:
            self.committer.add_extremum(segment, 1)
            self.committer.kink()
        if outcome.zone_from_turn:
            self.committer.zone_from_turn()
        if outcome.detachment:
            self._lose_contact(outcome.detachment, segment)
        elif outcome.below_zone or fills_its_zone(self.problem, self.state.surface):
            self.outcome = below_zone_outcome([row[FORCE_OF_ROW] for row in state.recorded.rows], state.time)

    def _lose_contact(self, reason: str, segment: Segment) -> None:
        """Contact ends here; the last row is the free surface, unless a force takes the indenter further."""
        state, surface = self.state, self.state.surface
        last = (0.0, 0.0) if self.problem.scene.ends_in_a_point else (state.force, surface.radius)
        off = limit_point_uncertainty(self.problem, state)
        state.events.append(Event("pull-off", state.time, surface.penetration, *last, off))
        self._end(OutcomeKind.DETACHED, reason)
        if surface.radius > 0.0 and segment.control != "force":
            stage = surface.penetration + self.problem.scene.loading.compliance * state.force
            free = surface.after_detachment(self.problem.body)
            state.surface, state.force = replace(free, penetration=stage), 0.0
            self.recorder.add(state.time, state.surface, state.force)

    def _end(self, kind: OutcomeKind, reason: str) -> None:
        self.outcome = Outcome(kind, reason, self.state.time)
