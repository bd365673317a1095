"""``solve(scene, options) -> Trace``: the paper's boundary-element solver, and its loop over trial steps.

Trial steps are accepted or not; what is accepted becomes the state of a run. Where the edge goes beyond its
travel limit even at constant load, with that limit reduced sixty-fourfold, the contact is unstable: recorded
as an event, followed by the next stable contact at the same load or, without one, by detachment.

Penetration and surface displacement positive downwards, force and pressure positive in compression, radii
from the axis; units of the scene.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from bem_solver.control import (
    SHARE_OF_WAY,
    SLIVER,
    AcceptedRow,
    GradedState,
    StepStart,
    free_load,
    grown,
    limited_step,
    short_of_largest_tension,
    shrunk,
)
from bem_solver.creep import surface_material
from bem_solver.equilibrium import (
    EdgeJump,
    FreeMotion,
    contact_lost,
    lift_off,
    released,
    unstable_motion,
    without_contact,
)
from bem_solver.options import Options
from bem_solver.paper_scheme import refusal_of_uniform, solve_uniform
from bem_solver.problem import Problem
from bem_solver.recorder import GradedRecord, surface_profile, trace_without_start
from bem_solver.size_estimates import discretised
from bem_solver.state import start_state, updated_state
from bem_solver.step import Candidate, FailedStep, TrialStep, near_limit_point, to_level, to_limit_point
from bem_solver.surface_points import HalfSpaceState
from bem_solver.trial import TrialContact
from contact_scene import Counters, Outcome, OutcomeKind, RunMonitor, Scene, Trace
from contact_scene.loading import passed
from contact_scene.machine import on_machine
from contact_scene.run_control import (
    LoadingCursor,
    LoadingInterval,
    below_zone_outcome,
    budget_outcome,
    follow_loading,
    interruption,
    outcome_of_loss,
    outgrown_outcome,
    single_threaded,
)

_SLIGHTLY_LONGER = 1.5
"""Step, in shortest ones, up to which it is as short as can be: it is rounded to multiples of a quarter."""


@dataclass
class GradedRun:
    """A run on graded annuli: what stays, and the state that changes."""

    problem: Problem
    max_steps: int
    cursor: LoadingCursor
    state: GradedState
    monitor: RunMonitor | None = None
    start: StepStart = field(init=False)
    report: Callable[[float], None] = field(init=False)

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
        self.start, self.report = StepStart(self.problem, state, interval), report
        self._begin_interval()
        while state.parameter < interval.length:
            time = state.contact.time
            outcome = (
                interruption(self.monitor, time)
                or budget_outcome(self.problem.counters, self.max_steps, time)
                or outgrown_outcome(self.problem.scene.body, state.contact.edge, time)
                or self._advance()
            )
            if outcome is not None:
                return outcome
            if self._triggered(interval, state.contact):
                break
        state.parameter = 0.0
        if interval.jump:
            state.step = 0.0  # it was a share of the jump, not a time
        return None

    def _triggered(self, interval: LoadingInterval, contact: HalfSpaceState) -> bool:
        """Whether the committed state has reached the level that ends the load step; a load jump is whole."""
        if interval.trigger is None or interval.jump or self.cursor.trigger_side is None:
            return False
        excess = interval.trigger.excess(contact.penetration, contact.surface.force, contact.edge)
        return passed(self.cursor.trigger_side, excess)

    def _advance(self) -> Outcome | None:
        """One trial step and what follows from it; an outcome if the run ends with it."""
        start = self.start
        state, problem, interval = start.state, start.problem, start.interval
        if state.contact.edge == 0.0:
            return self._take(without_contact(start))
        state.accepted.least = start.smallest_travel
        if not state.sought_limit_point and near_limit_point(start):
            return self._to_limit_point()
        state.step, step = limited_step(start)
        trial_step = TrialStep(problem, state, interval, step)
        result = trial_step.result()
        if isinstance(result, FailedStep):
            problem.counters.rejected_steps += 1
            return self._after_failure(result, step)
        taken = result.parameter - state.parameter
        at_once = taken <= _SLIGHTLY_LONGER * start.shortest_step
        leaps = result.error > 1.0 and at_once
        trial, rejected = result.trial, result.error > 1.0 and not leaps
        problem.counters.rejected_steps += rejected
        over, travel = problem.over_zones(trial.motion.edge), abs(trial.motion.new_edge - trial.motion.edge)
        if rejected or (over and travel < trial.zone and not leaps):
            at_jump = trial_step.to_speed_jump(result)
            if at_jump is not None and at_jump.parameter > state.parameter and at_jump.error <= 1.0:
                result = at_jump
            elif rejected:
                if at_jump is not None and at_jump.parameter == state.parameter:
                    self._speed_jumps()
                state.step = shrunk(taken, result.error, 2 if len(state.accepted.rows) > 1 else 1)
                return None
        if not at_once and (before := short_of_largest_tension(start, result.trial, result.parameter)) > 0.0:
            problem.counters.rejected_steps += 1
            state.step = before
            return None
        if interval.trigger is None or interval.jump:
            return self._accept(result, leaps)
        result, reached = to_level(trial_step, interval.trigger, result)
        outcome = self._accept(result, leaps)
        if reached:
            self.cursor.level_reached()
        return outcome

    def _to_limit_point(self) -> Outcome | None:
        """A step that ends on the limit point ahead, and the unstable motion from there, if there is one."""
        start, state = self.start, self.state
        state.sought_limit_point = True
        step = state.accepted.step_to_limit_point()
        candidate = to_limit_point(TrialStep(self.problem, state, start.interval, step))
        if candidate is None:
            return None
        receding = candidate.trial.motion.new_edge < state.contact.edge
        outcome = self._accept(candidate, False)
        return outcome or self._move_unstably(receding)

    def _after_failure(self, failed: FailedStep, step: float) -> Outcome | None:
        """Change travel limit or step, or let the edge move unstably; an outcome if the run ends with it."""
        start, state = self.start, self.state
        smallest, reach = start.smallest_travel, start.reach(not failed.receding)
        at_limit_point = min(state.accepted.way_to_limit_point(), failed.way) < smallest
        unresolved = failed.unstable and step <= start.shortest_step
        if at_limit_point or reach <= smallest or unresolved:
            return self._move_unstably(failed.receding)
        state.travel_share *= min(0.5, SHARE_OF_WAY * failed.way / reach)
        if failed.unstable:
            state.step = shrunk(step, math.inf)
        return None

    def _begin_interval(self) -> None:
        """First step and rates of an interval."""
        problem, state, interval = self.problem, self.state, self.start.interval
        if interval.after_kink:
            state.record.kink()
            state.contact = replace(state.contact, last_step=None)
            # no rate is known, and what has jumped relaxes from the start
            longest = min(0.05 * interval.length, problem.chain.relaxation.min(initial=math.inf))
            state.step = min(state.step or 0.01 * interval.length, longest)
            state.accepted.start(self._accepted_row(0.0))
        else:
            state.accepted.continue_in_next_interval()
        if interval.jump:
            state.step = 0.1

    def _accept(self, candidate: Candidate, leaps: bool) -> Outcome | None:
        """Commit a candidate; an outcome if the contact ends with it."""
        start = self.start
        problem, state, record = start.problem, start.state, start.state.record
        state.sought_limit_point = False
        taken = candidate.parameter - state.parameter
        order = 3 if problem.curves else 2  # of a parabola, or of a straight line
        cut_short = candidate.error <= 1.0 and taken < (1.0 - SLIVER) * state.step  # by a stop, say
        state.step = max(grown(taken, candidate.error, order), cut_short * state.step)
        if (slope := candidate.slope) > 0.0:  # the next is expected to change in proportion
            change = slope / (state.last_slope or slope)
            state.slope, state.last_slope = slope * min(max(change, 0.5), 2.0), slope
        state.parameter = candidate.parameter
        self._commit(candidate.trial, state.parameter)
        edge = state.contact.edge
        remember = state.accepted.start if leaps else state.accepted.add
        remember(self._accepted_row(state.parameter))
        if candidate.speed_jumps and candidate.trial.motion.edge == edge:  # at rest until now: rates hold
            record.kink()
        elif candidate.speed_jumps:
            self._speed_jumps()
        state.travel_share = min(1.0, 2.0 * state.travel_share)
        if edge <= max(problem.zone, candidate.trial.zone):
            return below_zone_outcome(record.forces, state.contact.time)
        return self._lift_off() if contact_lost(start) else None

    def _speed_jumps(self) -> None:
        """Slopes jump at the committed state: those from before it tell nothing about what comes."""
        state = self.state
        state.record.kink()
        state.accepted.start(self._accepted_row(state.parameter))

    def _move_unstably(self, receding: bool) -> Outcome | None:
        """Let the edge move unstably; an outcome if the run ends with it."""
        start, state = self.start, self.state
        event = unstable_motion(start, receding)
        if isinstance(event, Outcome) and receding and start.problem.scene.ends_in_a_point:
            return self._lift_off()
        if isinstance(event, Outcome) or event.event:
            state.record.event("pull-off" if receding else "snap-in")
        lost = isinstance(event, Outcome) and event.kind is OutcomeKind.DETACHED
        if lost and start.interval.control == "stage":
            state.contact = released(start)
            state.record.row(state.contact)
        return self._take(event)

    def _take(self, event: FreeMotion | EdgeJump | Outcome) -> Outcome | None:
        """Commit what an instantaneous event leads to; an outcome if the run ends with it."""
        state = self.state
        if isinstance(event, Outcome):
            return event
        state.parameter = event.parameter
        if isinstance(event, FreeMotion):
            state.contact = event.contact
            state.record.row(state.contact)
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
        state = self.state
        state.contact = lift_off(self.start)
        state.record.row(state.contact)
        state.record.event("pull-off")
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", state.contact.time)

    def _accepted_row(self, parameter: float) -> AcceptedRow:
        """What the committed state adds to the accepted ones of its interval."""
        contact = self.state.contact
        surface, load = contact.surface, free_load(self.start.interval, contact.penetration, contact.surface)
        ahead = surface.load_ahead(self.problem.ahead)
        return AcceptedRow(parameter, contact.edge, load, surface.edge_load, ahead)

    def _commit(self, trial: TrialContact, parameter: float) -> None:
        """Make the trial the state."""
        start, state, surface = self.start, self.state, trial.surface
        if not (math.isfinite(surface.force) and math.isfinite(trial.motion.new_penetration)):
            raise FloatingPointError("force or penetration is not finite")
        state.contact = updated_state(start, trial, parameter)
        state.largest_force = max(state.largest_force, abs(surface.force))
        state.largest_tension = max(state.largest_tension, -surface.force)
        state.largest_edge = max(state.largest_edge, surface.edge)
        start.problem.counters.steps += 1
        state.record.row(state.contact)
        self.report(state.contact.time)


@single_threaded()
def solve(
    scene: Scene,
    options: Options | None = None,
    progress: Callable[[float], None] | None = None,
    monitor: RunMonitor | None = None,
) -> Trace:
    """Solve a scene with the boundary-element method of the paper.

    Parameters
    ----------
    scene : Scene
    options : Options, optional
    progress : callable, optional
        Called with the share of the run that is done, 0 to 1.
    monitor : RunMonitor, optional
        Asked between two steps whether the run is to continue.

    Returns
    -------
    Trace
        ``outcome`` says how the run ended; a run that could not finish keeps what it computed.

    Raises
    ------
    UnsupportedScene
        Where uniform annuli would be too many, or the body is a layer.
    SceneError
        If the process zone does not fit into the contact at the start.
    """
    options = options or Options()
    scene = replace(scene, material=surface_material(scene.material))
    unsupported = refusal_of_uniform(scene) if options.annuli == "uniform" else None
    if unsupported is not None:
        raise unsupported
    began = clock.perf_counter()
    run = solve_uniform if options.annuli == "uniform" else _solve_graded
    with np.errstate(all="ignore"):  # non-finite numbers are looked for where state is committed
        trace = run(scene, options, progress, monitor)
    outcome = outcome_of_loss(trace.outcome, scene.is_adhesive, trace.penetration, trace.contact_radius)
    return replace(trace, outcome=outcome, wall_seconds=clock.perf_counter() - began)


def _solve_graded(
    scene: Scene, options: Options, progress: Callable[[float], None] | None, monitor: RunMonitor | None
) -> Trace:
    counters, cursor, run = Counters(factorisations=1), LoadingCursor(), None
    try:
        problem = discretised(scene, options, counters)
        contact = start_state(problem)
        if contact is None:
            return on_machine(trace_without_start(scene.loading.without_start, counters), scene.machine)
        record = GradedRecord()
        record.row(contact)
        state = GradedState(contact, record, abs(contact.surface.force), contact.edge)
        run = GradedRun(problem, options.max_steps, cursor, state, monitor)
        outcome = follow_loading(
            run, scene.loading, cursor, options.stop_times, options.profile_times, progress
        )
    except ArithmeticError as error:
        kind, reason = OutcomeKind.NOT_FINITE, str(error)
        if not isinstance(error, FloatingPointError):
            kind = OutcomeKind.OUT_OF_RANGE
            reason = f"a number is beyond the range of floating point ({error})"
        if run is None:
            return on_machine(trace_without_start(reason, counters), scene.machine)
        outcome = Outcome(kind, reason, run.state.contact.time)
    return on_machine(run.state.record.trace(run.problem, outcome), scene.machine)
