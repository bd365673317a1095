"""A run: the load steps of a scene, leg by leg, along the path of the edge.

A load step is a jump, if the load has one, and legs in time between its kinks. A level may end it before.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene import (
    COLUMNS,
    Counters,
    Outcome,
    OutcomeKind,
    RunMonitor,
    Scene,
    Segment,
    SurfaceProfile,
    Trigger,
)
from contact_scene.loading import pieces
from contact_scene.machine import machine_columns
from contact_scene.run_control import (
    MAX_STEPS,
    LoadingCursor,
    below_zone_outcome,
    budget_outcome,
    interruption,
    outcome_of_loss,
    outgrown_outcome,
)
from validation.reference.path.continuation import SAME_FOLD, Continuation, Level
from validation.reference.path.correction import Ending
from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.equilibrium import FARTHER, elastic_start, farthest_reach, indented, scales
from validation.reference.path.numerics import SMALL_PART
from validation.reference.path.path import Leg, jump, timed_legs
from validation.reference.path.profiles import profile
from validation.reference.path.recorder import EXTRA_COLUMNS, Recorder
from validation.reference.path.state import State
from validation.reference.path.trial import Arrival

Array = NDArray[np.float64]
NO_STABLE_CONTACT = "no stable contact is left"


def level(trigger: Trigger | None, state: State) -> Level | None:
    """How far beyond the level that ends a load step, seen from the side on which the step begins."""
    if trigger is None:
        return None
    side = trigger.side(trigger.excess(state.depth, state.force, state.radius))
    return lambda depth, force, radius: -side * trigger.excess(depth, force, radius)


@dataclass
class PathRun:
    """A run of a scene at a tolerance; arguments are those of :class:`Options` and ``solve``."""

    scene: Scene
    tolerance: float
    stop_times: tuple[float, ...] = ()
    profile_times: tuple[float, ...] = ()
    max_steps: int = MAX_STEPS
    progress: Callable[[float], None] | None = None
    monitor: RunMonitor | None = None
    profiles: list[SurfaceProfile] = field(default_factory=list)
    outcome: Outcome | None = None
    begun: bool = False
    _grows: bool = False
    recorder: Recorder = field(init=False)
    tracker: Continuation = field(init=False)

    def run(self) -> tuple[dict[str, Array], Outcome]:
        """All load steps: the columns of the rows, and how it ended.

        Once more where the contact outgrew the functions of its layer: no bound of it is known before.
        """
        outcome, reach = None, 0.0
        while outcome is None:
            self.outcome = self._begin(reach)
            if self.outcome is not None:
                return {name: np.empty(0) for name in (*COLUMNS, *EXTRA_COLUMNS)}, self.outcome
            self.begun = True
            with np.errstate(all="ignore"):  # what overflows belongs to trials beyond a limit point
                outcome = self._load_steps()
            if self._grows and (reach := self.tracker.body.image.reach) < farthest_reach(self.scene):
                outcome, reach = None, FARTHER * reach
        columns = self.recorder.columns()
        machine = self.scene.machine
        if machine is not None and machine.compliance > 0.0:
            columns |= machine_columns(columns, machine, self.recorder.events)
        columns, outcome = _finite_rows(columns, outcome)
        depth, radius = columns["penetration"], columns["contact_radius"]
        return columns, outcome_of_loss(outcome, self.scene.is_adhesive, depth, radius)

    @property
    def counters(self) -> Counters:
        """Work done."""
        if not self.begun:
            return Counters()
        tracker = self.tracker
        return Counters(
            steps=tracker.steps,
            rejected_steps=tracker.rejected,
            closure_evaluations=tracker.evaluations,
            history_updates=tracker.geometries,
        )

    def _begin(self, reach: float) -> Outcome | None:
        """The state at the start and what runs from there; the outcome if there is none."""
        scene, self.profiles, self._grows = self.scene, [], False
        try:
            with np.errstate(over="raise", invalid="raise", divide="raise"):
                body = indented(scene, reach)
                adhesion = scene.adhesion if scene.is_adhesive else None
                state = elastic_start(scene, body)
                if state is None:
                    return Outcome(OutcomeKind.NO_EQUILIBRIUM, scene.loading.without_start, 0.0)
                size = scales(scene, body, state)
        except ArithmeticError as error:
            reason = f"a number is beyond the range of floating point ({error})"
            return Outcome(OutcomeKind.OUT_OF_RANGE, reason, 0.0)
        law = EdgeLaw(adhesion, scene.indenter.edge, scene.bare_plane_tip)
        stops = np.unique([*self.stop_times, *self.profile_times])
        wanted = frozenset(self.profile_times)
        self.recorder = Recorder(body, law, size, self.tolerance, stops, wanted, self._profile)
        small = SMALL_PART * size.radius, SMALL_PART * size.depth
        self.tracker = Continuation(
            body, law, state, self.tolerance, *small, accepted=self._accepted, largest_force=size.force
        )
        self.recorder.begin(state)
        return None

    def _profile(self, state: State) -> None:
        """The surface at a time at which it is asked for."""
        self.profiles.append(profile(self.recorder.body, self.scene.indenter, state))

    def _accepted(self, arrival: Arrival, state: State, s: float) -> None:
        """Record a step; the row before it belongs to its path unless there is a kink between."""
        table = self.tracker.rows.table
        back = table[-2, 0] / s if len(table) > 1 else None
        self.recorder.step(arrival, state, back)

    # load steps ---

    def _load_steps(self) -> Outcome:
        loading, tracker, cursor = self.scene.loading, self.tracker, LoadingCursor()
        while not cursor.done(loading):
            state = tracker.state
            segment = cursor.segment(loading, 0.0, state.depth, state.force)  # in its own time
            if segment.control == "force" and state.radius == 0.0:
                segment = self._set_down(segment)
            if self.outcome is None:
                self._load_step(segment, cursor)
            if self.outcome is not None:
                return self.outcome
            cursor.step_done()
        return Outcome(OutcomeKind.COMPLETED, "all loading steps carried out", tracker.state.time)

    def _set_down(self, segment: Segment) -> Segment:
        """A load on an indenter that touches nothing: it goes down to the surface, or stays without load."""
        state = self.tracker.state
        force, rate = segment.value(segment.start), segment.rate(segment.start)
        if force < 0.0 or (force == 0.0 and rate < 0.0):
            self._end(OutcomeKind.DETACHED, "pulled without contact")
        elif force == rate == 0.0:
            ends, depths = (segment.start, segment.end), (state.depth, state.depth)
            return pieces("penetration", ends, depths, segment.trigger)
        elif state.depth != 0.0:
            self.tracker.state = state.at_depth(0.0)
            self.recorder.put(self.tracker.state)
        return segment

    def _load_step(self, segment: Segment, cursor: LoadingCursor) -> None:
        """One load step: its jump, then its legs in time."""
        tracker, length, origin = self.tracker, segment.end, self.tracker.state.time
        if 0.0 < self.tolerance * length < math.ulp(origin + length):
            reason = (
                f"time steps of {self.tolerance * length:.2g}, in a load step of length {length:.3g}, "
                f"are lost in the rounding of the time {origin + length:.3g}"
            )
            self._end(OutcomeKind.OUT_OF_RANGE, reason)
            return
        state = tracker.state
        if cursor.triggered(segment, state.depth, state.force, state.radius):
            return
        self.recorder.linear = segment.linear
        first = jump(segment, state.depth, state.force)
        if first is not None:
            self._follow(first, segment, cursor)
            state = tracker.state
            if self.outcome is not None or cursor.triggered(segment, state.depth, state.force, state.radius):
                return
        tracker.level = level(segment.trigger, state)
        for leg in timed_legs(segment, self.tolerance, origin):
            if self._follow(leg, segment, cursor) is Ending.LEVEL or self.outcome is not None:
                return
        if segment.trigger is not None:
            self.outcome = segment.trigger.not_reached(tracker.state.time)

    def _follow(self, leg: Leg, segment: Segment, cursor: LoadingCursor) -> Ending:
        """One leg to its end, or to what ends the run before."""
        tracker = self.tracker
        before = tracker.leg
        tracker.begin(leg, SMALL_PART * self._shortest(leg, segment))
        self.recorder.put(tracker.state)
        if leg.free and (before is None or before.control != leg.control) and tracker.unstable():
            self._ends_with(Ending.FOLD, leg)
            if self.outcome is not None:
                return Ending.FOLD
        while True:
            self.recorder.put(tracker.state)
            now = tracker.state.time
            self.outcome = (
                interruption(self.monitor, now)
                or budget_outcome(self.counters, self.max_steps, now)
                or outgrown_outcome(self.scene.body, tracker.state.radius, now)
            )
            kind = Ending.LOST if self.outcome is not None else tracker.step()
            if self.outcome is None:
                self._ends_with(kind, leg)
            if self.progress is not None and leg.timed:
                self.progress(float(cursor.share(self.scene.loading, segment, tracker.state.parameter)))
            if kind is Ending.LEVEL:
                self.recorder.level("trigger")
            if self.outcome is not None or kind in (Ending.END, Ending.LEVEL):
                return kind

    def _shortest(self, leg: Leg, segment: Segment) -> float:
        """Length of a leg, or of the time in which its load changes by the largest of the run, if shorter."""
        if not leg.timed:
            return 1.0
        size, rate = self.recorder.scales, abs(segment.rate(leg.start))
        large = size.force if leg.control == "force" else size.depth + leg.compliance * size.force
        return min(leg.end - leg.start, large / rate if rate else math.inf)

    def _ends_with(self, kind: Ending, leg: Leg) -> None:
        """The end of the run, if what a step came to is one."""
        tracker = self.tracker
        if kind is Ending.LEAST and tracker.law.zone:
            force = self.recorder.columns()["force"]
            self.outcome = below_zone_outcome(force, tracker.state.time)
        elif kind is Ending.LEAST or (kind in (Ending.END, Ending.LOST) and tracker.let_go):
            self._lose_contact(leg)
        elif kind in (Ending.LOST, Ending.FOLD) and tracker.lost(kind is Ending.FOLD):
            self._grows = self.scene.body is not None and tracker.direction > 0.0
            if kind is Ending.FOLD and self._grows:
                now = tracker.state.time
                self.outcome = outgrown_outcome(self.scene.body, math.inf, now)
            elif kind is Ending.FOLD:
                self._lose_contact(leg)
            else:
                reason = "no step, however short, leads to a contact that satisfies the edge condition"
                self._end(OutcomeKind.BREAKDOWN, reason)

    def _lose_contact(self, leg: Leg) -> None:
        """Contact ends here; the last row is the free surface, unless a force takes the indenter off."""
        state = self.tracker.state
        self.recorder.lost(self.scene.ends_in_a_point, SAME_FOLD * self.tolerance * self.tracker.L)
        self._end(OutcomeKind.DETACHED, NO_STABLE_CONTACT)
        held = leg.control != "force"
        if state.radius > 0.0 and (held or self.scene.ends_in_a_point):
            springs_back = self.scene.loading.compliance * state.force if held else 0.0
            self.recorder.free(state, state.depth + springs_back)

    def _end(self, kind: OutcomeKind, reason: str) -> None:
        self.outcome = Outcome(kind, reason, float(self.tracker.state.time))


def _finite_rows(columns: dict[str, Array], outcome: Outcome) -> tuple[dict[str, Array], Outcome]:
    """The rows before the first that is beyond the range of floating point in one of its columns."""
    finite = np.logical_and.reduce([np.isfinite(column) for column in columns.values()])
    if finite.all():
        return columns, outcome
    first = int(np.argmin(finite))
    reason = "energies are beyond the range of floating point"
    failure = Outcome(OutcomeKind.OUT_OF_RANGE, reason, float(columns["time"][first]))
    return {name: column[:first] for name, column in columns.items()}, failure
