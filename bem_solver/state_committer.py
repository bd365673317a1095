"""How a trial, or what an instantaneous event leads to, becomes the state of a run: nowhere else does it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from bem_solver.instantaneous_events import (
    EdgeJump,
    FreeMotion,
    contact_lost,
    lift_off,
    released,
    unstable_motion,
)
from bem_solver.run_state import StepStart
from bem_solver.state_update import updated_state
from bem_solver.step_control import AcceptedRow, grown
from bem_solver.step_error import free_load
from bem_solver.step_result import Candidate
from bem_solver.trial import TrialContact
from contact_scene import Outcome, OutcomeKind
from contact_scene.run_control import below_zone_outcome

_SLIVER = 1e-9
"""Part of a step by which it may differ from the one wanted by rounding."""


@dataclass(frozen=True)
class GradedStateCommitter:
    """Changes the state of a run within a loading interval, and records it.

    Parameters
    ----------
    start : StepStart
        With the state that is changed.
    report : callable(float)
        Called with the time of every state that ends a step.
    """

    start: StepStart
    report: Callable[[float], None]

    def begin_interval(self) -> None:
        """First step and rates of an interval."""
        problem, state, interval = self.start.problem, self.start.state, self.start.interval
        if interval.after_kink:
            state.record.kink()
            state.contact = replace(state.contact, last_step=None)
            short, first = 0.05 * interval.length, 0.01 * interval.length
            if problem.viscoelastic and not interval.jump:  # what has jumped relaxes from the start
                first = min(first, float(problem.chain.retardation.min()))
            state.step = min(state.step, short) if state.step > 0.0 else first
            state.accepted.start(self._accepted_row(0.0))
        else:
            state.accepted.continue_in_next_interval()
        if interval.jump:
            state.step = 0.1

    def accept(self, candidate: Candidate, leaps: bool) -> Outcome | None:
        """Commit a candidate; an outcome if the contact ends with it.

        Where its edge ``leaps``, passing an annulus at once, its speed says nothing of the next step.
        """
        start = self.start
        problem, state, record = start.problem, start.state, start.state.record
        state.rejected, state.sought_limit_point = [], False
        taken = candidate.parameter - state.parameter
        order = 3 if problem.curves else 2  # of a parabola, or of a straight line
        state.step = max(grown(taken, candidate.error, order), self._shortened(taken, candidate.error))
        state.follow_slope(candidate.slope)
        state.parameter = candidate.parameter
        coarseness = start.coarseness(abs(candidate.trial.motion.new_edge - state.contact.edge))
        self._commit(candidate.trial, state.parameter, coarseness)
        edge = state.contact.edge
        remember = state.accepted.start if leaps else state.accepted.add
        remember(self._accepted_row(state.parameter))
        if candidate.speed_jumps and candidate.trial.motion.edge == edge:  # at rest until now: rates hold
            record.kink()
        elif candidate.speed_jumps:
            self.speed_jumps()
        state.travel_share = min(1.0, 2.0 * state.travel_share)
        if edge <= max(problem.zone, candidate.trial.zone):
            return below_zone_outcome(record.forces, state.contact.time)
        return self._lift_off() if contact_lost(start) else None

    def speed_jumps(self) -> None:
        """Slopes jump at the committed state: those from before it tell nothing about what comes."""
        state = self.start.state
        state.record.kink()
        state.accepted.start(self._accepted_row(state.parameter))

    def move_unstably(self, receding: bool) -> Outcome | None:
        """Let the edge move unstably; an outcome if the run ends with it."""
        start, state = self.start, self.start.state
        event = unstable_motion(start, receding)
        if isinstance(event, Outcome) and receding and start.problem.scene.ends_in_a_point:
            return self._lift_off()
        if isinstance(event, Outcome) or event.event:
            state.record.event("pull-off" if receding else "snap-in", state.contact)
        lost = isinstance(event, Outcome) and event.kind is OutcomeKind.DETACHED
        if lost and start.interval.control == "stage":
            state.contact, state.energies = released(start)
            state.record.row(start.problem.chain, state.contact, state.energies)
        return self.take(event)

    def take(self, event: FreeMotion | EdgeJump | Outcome) -> Outcome | None:
        """Commit what an instantaneous event leads to; an outcome if the run ends with it."""
        state = self.start.state
        if isinstance(event, Outcome):
            return event
        state.parameter = event.parameter
        if isinstance(event, FreeMotion):
            state.contact = event.contact
            state.record.row(self.start.problem.chain, state.contact, state.energies)
            return None
        state.sought_limit_point = False
        self._commit(event.trial, event.parameter)
        state.contact = replace(state.contact, last_step=None)
        state.accepted.start(self._accepted_row(event.parameter))
        state.travel_share, state.step = 1.0, event.next_step
        state.record.kink()
        return None

    def _lift_off(self) -> Outcome:
        """The end of a contact without adhesion."""
        state = self.start.state
        state.contact, state.energies = lift_off(self.start)
        state.record.event("pull-off", state.contact)
        state.record.row(self.start.problem.chain, state.contact, state.energies)
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", state.contact.time)

    def _accepted_row(self, parameter: float) -> AcceptedRow:
        """What the committed state adds to the accepted ones of its interval."""
        contact = self.start.state.contact
        surface, load = contact.surface, free_load(self.start.interval, contact)
        ahead = surface.load_ahead(self.start.problem.ahead)
        return AcceptedRow(parameter, contact.edge, load, surface.edge_load, ahead)

    def _shortened(self, taken: float, error: float) -> float:
        """The step that a stop or a largest tension has cut short, to go on with; 0 if none has."""
        step = self.start.state.step
        return step if error <= 1.0 and taken < (1.0 - _SLIVER) * step else 0.0

    def _commit(self, trial: TrialContact, parameter: float, coarseness: float = 1.0) -> None:
        """Make the trial the state, its history coarsened by a part of what is usual."""
        start, state, surface = self.start, self.start.state, trial.surface
        if not (math.isfinite(surface.force) and math.isfinite(trial.motion.new_penetration)):
            raise FloatingPointError("force or penetration is not finite")
        state.contact, state.energies = updated_state(start, trial, parameter, coarseness)
        state.largest_force = max(state.largest_force, abs(surface.force))
        state.largest_tension = max(state.largest_tension, -surface.force)
        state.largest_edge = max(state.largest_edge, surface.edge)
        start.problem.counters.steps += 1
        state.record.row(start.problem.chain, state.contact, state.energies)
        self.report(state.contact.time)
