"""The loop: trial steps, accepted or not, and how what is accepted becomes the state of a run.

Where the edge goes beyond its travel limit even at constant load, with that limit reduced sixty-fourfold,
the contact is unstable: recorded as an event, followed by the next stable contact at the same load or,
without one, by detachment.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.control import (
    SHARE_OF_WAY,
    AcceptedRow,
    GradedState,
    StepSettings,
    StepStart,
    free_load,
    grown,
    limited_step,
    short_of_largest_tension,
    shrunk,
)
from bem_solver.edge_energy import EdgeStep
from bem_solver.history import (
    NODES_APART,
    NodalVariables,
    SurfaceHistory,
    distinct,
    graded_nodes,
    midpoints_of_wide_intervals,
    nodes_beyond,
    updated_kinks,
)
from bem_solver.instantaneous_events import (
    EdgeJump,
    FreeMotion,
    contact_lost,
    lift_off,
    released,
    unstable_motion,
    without_contact,
)
from bem_solver.problem import Problem
from bem_solver.recorder import surface_profile
from bem_solver.step import (
    Candidate,
    FailedStep,
    StepTrials,
    TrialStep,
    near_limit_point,
    to_level,
    to_limit_point,
)
from bem_solver.surface_points import HalfSpaceState, advanced, points_at, split_at_edge
from bem_solver.trial import EDGE_ACCURACY, TrialContact, surface_pressed
from contact_scene import Outcome, OutcomeKind, RunMonitor
from contact_scene.loading import passed
from contact_scene.run_control import (
    LoadingCursor,
    LoadingInterval,
    below_zone_outcome,
    budget_outcome,
    interruption,
    outgrown_outcome,
)

Array = NDArray[np.float64]

_COARSENING = 0.002
"""Change of an internal variable that a removed node may cause, in step tolerances of the largest one."""
_FADED = 0.01 * _COARSENING
"""The same of a root that no longer counts: the edge that left it has hardly set out when it is as weak as a
removed node."""


def spacing(radius: Array, edge: float, length: float, divisions: int) -> Array:
    """Largest distance between nodes, shape (n,): fine within two lengths of the edge, then growing."""
    beyond = np.maximum(np.abs(radius - edge) - 2.0 * length, 0.0)
    return length / divisions + NODES_APART * beyond


def updated_state(
    start: StepStart, trial: TrialContact, parameter: float, coarseness: float
) -> HalfSpaceState:
    """The state after an accepted trial."""
    problem, motion, surface, chain = start.problem, trial.motion, trial.surface, start.problem.chain
    time, history = start.interval.time(parameter), start.state.contact.history
    contact = HalfSpaceState(time, motion.new_penetration, surface, history, trial.closure)
    if problem.viscoelastic:
        problem.counters.history_updates += 1
        history = _new_history(start, trial, coarseness)
        lags = advanced(chain, trial.points, motion, None) @ chain.rotation.T * chain.lag_scale
        work = chain.compliances * surface.load_work - surface.work_on(lags)
        release = _tip_release(problem, trial)
        contact = replace(contact, history=history, branch_work=work, tip_release=release)
    if problem.irreversible is not None:
        contact = replace(contact, last_step=EdgeStep(motion.duration, motion.edge))
    return contact


def _tip_release(problem: Problem, trial: TrialContact) -> float:
    """Glassy energy release rate of the tip, ``K^2/(2 Einf*)``, the way it has gone.

    An opening tip has it from the pressure. Behind a closing one the stress relaxes within a layer that may
    be thinner than an annulus: it has it from the pressure that free creep misses, whose root is the gap's.
    """
    glassy, surface, motion = problem.chain.glassy, trial.surface, trial.motion
    if motion.new_edge <= motion.edge or problem.work == 0.0:
        return 0.5 * surface.stress_intensity**2 / glassy
    if trial.creep is not None:
        return 0.5 * trial.creep.pressed.stress_intensity**2 * glassy
    pressed = surface_pressed(problem, motion, trial.points, surface.kinks)
    return 0.5 * pressed.stress_intensity**2 * glassy


def _new_history(start: StepStart, trial: TrialContact, coarseness: float) -> SurfaceHistory:
    """The history after an accepted trial, its coarsening as of :func:`updated_state`."""
    problem, state, motion, surface = start.problem, start.state.contact, trial.motion, trial.surface
    divisions, tolerance = start.settings.divisions, start.settings.tolerance
    chain, edge, radii = problem.chain, motion.new_edge, problem.annuli.radii
    length = problem.length_at(edge)
    reach = max(abs(edge - motion.edge), 0.25 * length)
    smallest = 0.5 * edge * problem.annuli.outermost
    last = float(state.history.radius.max(initial=0.0))
    wanted = np.concatenate(([0.0], graded_nodes(radii, edge, reach), nodes_beyond(edge, length, last)))
    kinks, direction, turning, farthest = updated_kinks(
        state.history, motion.edge, edge, 8.0 * smallest, EDGE_ACCURACY * tolerance * length
    )
    if problem.irreversible is not None and motion.duration > 0.0 and edge == motion.edge:
        direction, farthest = 0, edge  # it rests, and may go on from here the way it came
    fixed = (edge, *kinks) if turning is None or turning == edge else (edge, turning, *kinks)
    rest = turning if turning is not None and turning < edge else None
    if rest is not None:
        kinks = tuple(sorted((*kinks, rest)))
    radius = distinct(np.concatenate((state.history.radius, wanted)), fixed, smallest)
    allowed = spacing(radius, edge, length, divisions)
    halves = midpoints_of_wide_intervals(radius, 0.5 * (allowed[1:] + allowed[:-1]))
    radius = np.sort(np.concatenate((radius, halves)))
    load = surface.outside(np.maximum(radius, edge))
    points = points_at(problem, state, radius)
    variables = advanced(chain, points, motion, load)
    if trial.creep is not None:
        outside = radius > edge
        variables[outside] = trial.creep.settled(points[outside], variables[outside], load[outside])
    at_edge = motion.new_penetration - float(problem.scene.indenter.height(edge))
    inner, outer = split_at_edge(chain, radius, variables, load, edge, at_edge, kinks, rest)
    unit = tolerance * float(np.abs(variables).max(initial=0.0))
    parity = problem.counters.steps % 2

    def coarsen(side: NodalVariables) -> NodalVariables:
        side = side.without_faded_kinks(_FADED * unit)
        widest = spacing(side.radius, edge, length, divisions)
        return side.coarsened(coarseness * _COARSENING * unit, widest, parity)

    return SurfaceHistory(coarsen(inner), coarsen(outer), direction, turning, farthest)


_SLIVER = 1e-9
"""Part of a step by which it may differ from the one wanted by rounding."""
_ZONE_END_SHARE = 1e-4
"""Longest step, in intervals, within which a zone of fixed stress may come to fill its contact: the end."""


def zone_fills_contact(start: StepStart, candidate: Candidate, taken: float) -> bool:
    """Whether a zone of fixed stress comes to fill its contact within a step that is not yet short."""
    adhesion = start.problem.scene.adhesion
    if adhesion is None or adhesion.stress is None or start.problem.work == 0.0:
        return False
    fills = candidate.trial.zone >= candidate.trial.motion.new_edge
    return fills and taken > _ZONE_END_SHARE * start.interval.length


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
        self.start, self.report = StepStart(self.problem, self.settings, state, interval), report
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
        if state.accepted.step_to_limit_point() < start.shortest_step:  # no time resolves the rest of it
            return self._move_unstably(state.accepted.rates(0.0)[0] < 0.0)
        trial_step = TrialStep(problem, self.settings, state, interval, step)
        result = trial_step.result()
        if isinstance(result, FailedStep):
            problem.counters.rejected_steps += 1
            return self._after_failure(result, step)
        result = trial_step.checked_in_the_middle(result)
        taken = result.parameter - state.parameter
        if zone_fills_contact(start, result, taken):
            problem.counters.rejected_steps += 1
            state.step = 0.25 * taken
            return None
        at_once = taken <= _SLIGHTLY_LONGER * start.shortest_step
        leaps = result.error > 1.0 and at_once
        if result.error > 1.0 and not leaps:
            problem.counters.rejected_steps += 1
            at_jump = trial_step.to_speed_jump(result)
            if at_jump is not None and at_jump.parameter == state.parameter:
                self._speed_jumps()
                at_jump = None
            if at_jump is None or at_jump.error > 1.0:
                state.step = shrunk(taken, result.error, 2 if len(state.accepted.rows) > 1 else 1)
                return None
            result = at_jump
        if not at_once and (before := short_of_largest_tension(start, result.trial, result.parameter)) > 0.0:
            problem.counters.rejected_steps += 1
            state.step = before
            return None
        if interval.trigger is None or interval.jump:
            return self._accept(result, leaps)
        located = to_level(trial_step, interval.trigger, result)
        outcome = self._accept(located.candidate, leaps)
        if located.reached:
            self.cursor.level_reached()
        return outcome

    def _to_limit_point(self) -> Outcome | None:
        """A step that ends on the limit point ahead, and the unstable motion from there, if there is one."""
        start, state = self.start, self.state
        state.sought_limit_point = True
        step = state.accepted.step_to_limit_point()
        candidate = to_limit_point(StepTrials(self.problem, self.settings, state, start.interval, step))
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
            short, first = 0.05 * interval.length, 0.01 * interval.length
            if problem.viscoelastic and not interval.jump:  # what has jumped relaxes from the start
                first = min(first, float(problem.chain.retardation.min()))
            state.step = min(state.step, short) if state.step > 0.0 else first
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
        cut_short = candidate.error <= 1.0 and taken < (1.0 - _SLIVER) * state.step  # by a stop, say
        state.step = max(grown(taken, candidate.error, order), cut_short * state.step)
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
        surface, load = contact.surface, free_load(self.start.interval, contact)
        ahead = surface.load_ahead(self.problem.ahead)
        return AcceptedRow(parameter, contact.edge, load, surface.edge_load, ahead)

    def _commit(self, trial: TrialContact, parameter: float, coarseness: float = 1.0) -> None:
        """Make the trial the state, its history coarsened by a part of what is usual."""
        start, state, surface = self.start, self.state, trial.surface
        if not (math.isfinite(surface.force) and math.isfinite(trial.motion.new_penetration)):
            raise FloatingPointError("force or penetration is not finite")
        state.contact = updated_state(start, trial, parameter, coarseness)
        state.largest_force = max(state.largest_force, abs(surface.force))
        state.largest_tension = max(state.largest_tension, -surface.force)
        state.largest_edge = max(state.largest_edge, surface.edge)
        start.problem.counters.steps += 1
        state.record.row(state.contact)
        self.report(state.contact.time)
