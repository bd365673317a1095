"""The loop: take the state from stop to stop of the loading, commit the steps that are accepted."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from contact_scene import Event, Outcome, OutcomeKind, RunMonitor, Segment, Trigger
from contact_scene.run_control import (
    KeptState,
    LoadingCursor,
    below_zone_outcome,
    budget_outcome,
    interruption,
    stops_within,
)
from contact_scene.trigger import passed
from validation.reference.tracking.coarsening import coarsened
from validation.reference.tracking.instantaneous import (
    flat_first_contact,
    force_without_contact,
    load_jump,
)
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.limit_points import AT_LIMIT_POINT
from validation.reference.tracking.options import Options
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.profiles import surface_profile
from validation.reference.tracking.recorder import FORCE_OF_ROW, Recorder
from validation.reference.tracking.root import bracketed
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step import RowTolerances, trial_step
from validation.reference.tracking.step_history import FORCE, TIME
from validation.reference.tracking.step_outcome import FrontCandidate, StepOutcome
from validation.reference.tracking.step_to_level import excess_of, step_to_level
from validation.reference.tracking.surface import Surface

NAME = "reference"
COARSEN_EVERY = 12
"""Committed steps between two coarsenings of the nodes."""
COARSEN_EVERY_LONG = 2
"""The same where steps pass over process zones and leave many nodes."""
COARSENING_SQUARED = 100.0
"""Error allowed in coarsening, in squares of the deviation allowed in a step: of fourth order, as a step."""
COARSENING_SHARE = 0.1
"""Error allowed in coarsening, in deviations allowed in a step, at most."""
EXTREMUM_HEIGHT = 1e-13
"""Height of an extremum of the force over its rows, in largest forces, below which it is round-off."""
BESIDE_EXTREMUM = 1.0 / 32.0
"""Distance of the rows on either side of an extremum of the force, in steps: they show where it may lie."""
ZONE_END_SHARE = 1e-4
"""Longest step, in load steps, within which a zone of fixed stress may come to fill its contact: the end."""
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
    def recorder(self) -> Recorder:
        """Recorder of the rows of the state."""
        return Recorder(
            self.problem.body, self.problem.work_of_adhesion, self.problem.irreversible, self.state.recorded
        )

    def run(self) -> Outcome:
        """Carry out all load steps, from the present position in the loading."""
        try:
            return self._load_steps()
        except ArithmeticError as error:
            return beyond_floating_point(error, self.state.time)

    def _load_steps(self) -> Outcome:
        state, cursor, loading = self.state, self.cursor, self.problem.scene.loading
        if cursor.at_start:
            self._add_row()
            self._add_profile(0.0)
        while not cursor.done(loading):
            self._load_step(cursor.segment(loading, state.time, state.surface.penetration, state.force))
            if self.outcome is not None:
                return self.outcome
            cursor.step_done()
        return Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", state.time)

    def _load_step(self, segment: Segment) -> None:
        state, cursor = self.state, self.cursor
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
        if not cursor.jump_done:
            self._triggered(segment)
            self._begin(segment)
        if self.outcome is not None or self._triggered(segment):
            return
        stops = stops_within(segment, {*self.options.stop_times, *self.options.profile_times})
        for stop in stops[cursor.stops_reached :]:
            while state.time < stop.time:
                self._step(segment, stop.time)
                if self.outcome is not None:
                    return
                if self._triggered(segment):
                    self._add_extremum(segment, 1)
                    return
            self._add_profile(stop.time)
            if stop.kink:
                self._add_extremum(segment, 1)
                self._kink()
            cursor.stop_reached()
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
            self._commit(self.problem.candidate(state.time, surface))
        if segment.control == "force":
            self._flat_first_contact(segment)
        return segment

    def _begin(self, segment: Segment) -> None:
        """The load jump, if any, with which a load step begins."""
        state = self.state
        self._kink()
        if segment.value(segment.start) != segment.present(state.surface.penetration, state.force):
            self._apply(load_jump(self.problem, state, segment), segment)
        self.cursor.jump_done = True

    def _step(self, segment: Segment, stop: float) -> None:
        """One trial step, applied if it is accepted."""
        state = self.state
        self.outcome = interruption(self.monitor, self._kept, state.time) or budget_outcome(
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
        shortened = self._to_the_end_of_the_zone(outcome, segment)
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

    def _kept(self) -> KeptState:
        return KeptState(NAME, self.cursor, self.state.counters, self.state)

    def _apply(self, outcome: StepOutcome, segment: Segment) -> None:
        """Commit what a trial step returned."""
        state = self.state
        if outcome.rejected:
            state.counters.rejected_steps += 1
        for surface in outcome.equilibria:
            self.recorder.add(state.time, surface, surface.force(self.problem.body))
        for candidate in outcome.candidates:
            self._commit(candidate, segment)
        state.proposal = outcome.proposal
        state.travel = state.travel if outcome.travel is None else outcome.travel
        state.steepness = state.steepness if outcome.steepness is None else outcome.steepness
        if outcome.event is not None:
            state.events.append(outcome.event)
        if outcome.first_contact:
            self._flat_first_contact(segment)
        if outcome.kink:
            self._add_extremum(segment, 1)
            self._kink()
        if outcome.detachment:
            self._lose_contact(outcome.detachment)
        elif outcome.below_zone or self._fills_its_zone(self.state.surface):
            self.outcome = below_zone_outcome([row[FORCE_OF_ROW] for row in state.recorded.rows], state.time)

    def _to_the_end_of_the_zone(self, outcome: StepOutcome, segment: Segment) -> StepOutcome:
        """A shorter step, if a zone of fixed stress would fill the contact somewhere within this one."""
        state = self.state
        if not outcome.candidates or not self._fills_its_zone(outcome.candidates[-1].surface):
            return outcome
        duration = outcome.candidates[-1].time - state.time
        if duration <= ZONE_END_SHARE * (segment.end - segment.start):
            return outcome
        travel = abs(outcome.candidates[-1].surface.radius - state.surface.radius)
        return StepOutcome(0.25 * duration, rejected=True, travel=0.25 * travel or None)

    def _fills_its_zone(self, surface: Surface) -> bool:
        """Whether a zone of fixed stress has grown over the whole contact."""
        condition = self.problem.condition
        if not isinstance(condition, Griffith) or condition.adhesion.stress is None or surface.radius == 0.0:
            return False
        return condition.zone_at(surface, self.problem.body) >= surface.radius

    def _commit(self, candidate: FrontCandidate, segment: Segment | None = None) -> None:
        """Make a candidate the present state; its interpolated rows are left to the recorder."""
        state, surface = self.state, candidate.surface
        state.counters.steps += 1
        state.rejected_before = state.counters.rejected_steps
        state.counters.history_updates += len(surface.inside) + len(surface.outside)
        long = self.problem.over_zones(surface.radius)
        if state.counters.steps % (COARSEN_EVERY_LONG if long else COARSEN_EVERY) == 0:
            allowed = self.problem.fineness.deviation
            surface = coarsened(surface, allowed * min(COARSENING_SQUARED * allowed, COARSENING_SHARE))
        before = state.time
        state.time, state.surface, state.force = float(candidate.time), surface, float(candidate.force)
        self._add_row()
        if segment is not None and candidate.intervals > 0:
            self._interpolate(segment, before, candidate.intervals)

    def _interpolate(self, segment: Segment, before: float, intervals: int) -> None:
        """Rows that divide the last step into intervals, and rows at an extremum of the force before it."""
        now = self.state.time
        for part in range(1, intervals):
            at = before + (now - before) * part / intervals
            self.recorder.interpolate(at, self._prescribed_depth(segment, at), 1)
        if segment.control != "force":
            self._add_turning_point(segment, before)
        self._add_extremum(segment, 2)

    def _add_turning_point(self, segment: Segment, before: float) -> None:
        """A row in the last step where the prescribed penetration, or stage, turns."""
        now = self.state.time
        first, last = segment.rate(before), segment.rate(now)
        if first * last < 0.0:
            at = bracketed(segment.rate, before, first, now, last, 0.0, 2.0 * math.ulp(now))
            self.recorder.interpolate(at, self._prescribed_depth(segment, at), 1)

    def _add_extremum(self, segment: Segment, back: int) -> None:
        """Rows at and beside an extremum of the force in the ``back``-th step from the last."""
        if segment.control == "force":
            return
        state = self.state
        extremum = state.history.extremum_within(FORCE, back, EXTREMUM_HEIGHT * state.largest_force)
        if extremum is None:
            return
        at, length = extremum
        ends = [state.history.rows[-back - 1][TIME], state.history.rows[-back][TIME]]
        for time in (at - BESIDE_EXTREMUM * length, at, at + BESIDE_EXTREMUM * length):
            if ends[0] < time < ends[1]:
                self.recorder.interpolate(time, self._prescribed_depth(segment, time), back)

    @staticmethod
    def _prescribed_depth(segment: Segment, time: float) -> float | None:
        """Penetration where it is prescribed."""
        return segment.value(time) if segment.control == "penetration" else None

    def _flat_first_contact(self, segment: Segment) -> None:
        candidate = flat_first_contact(self.problem, self.state, segment)
        if candidate is not None:
            self._commit(candidate)

    def _kink(self) -> None:
        """Rates jump at the present row."""
        self.state.surface = self.state.surface.with_edge_nodes_doubled()
        self.state.history.kink()
        self.state.proposal = None
        self.recorder.kink()

    def _lose_contact(self, reason: str) -> None:
        """Contact ends here; the last row is the free surface."""
        state, surface = self.state, self.state.surface
        state.events.append(Event("pull-off", state.time, surface.penetration, state.force, surface.radius))
        self._end(OutcomeKind.DETACHED, reason)
        if surface.radius > 0.0:
            stage = surface.penetration + self.problem.scene.loading.compliance * state.force
            free = surface.after_detachment(self.problem.body)
            state.surface, state.force = replace(free, penetration=stage), 0.0
            self.recorder.add(state.time, state.surface, state.force)

    def _end(self, kind: OutcomeKind, reason: str) -> None:
        self.outcome = Outcome(kind, reason, self.state.time)

    def _add_row(self) -> None:
        state, surface = self.state, self.state.surface
        if abs(surface.radius - state.displaced_to) > AT_LIMIT_POINT * self.problem.largest_travel:
            state.last_displacement = surface.radius - state.displaced_to
            state.displaced_to = surface.radius
        state.largest_force = max(state.largest_force, abs(state.force))
        state.largest_radius = max(state.largest_radius, surface.radius)
        state.largest_depth = max(state.largest_depth, abs(surface.penetration))
        self.recorder.add(state.time, surface, state.force)
        state.history.add((float(state.time), surface.radius, float(state.force), float(surface.penetration)))

    def _add_profile(self, time: float) -> None:
        if time in self.options.profile_times:
            state, problem = self.state, self.problem
            state.profiles.append(
                surface_profile(state.time, state.surface, state.force, problem.body, problem.scene.indenter)
            )
