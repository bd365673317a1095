"""What an accepted step leaves: the present state, its rows, extrema and kinks, and surfaces asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact_scene import Segment
from validation.reference.tracking.coarsening import coarsened
from validation.reference.tracking.instantaneous import contact_of_plane_tip
from validation.reference.tracking.limit_points import AT_LIMIT_POINT
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.profiles import surface_profile
from validation.reference.tracking.recorder import Recorder
from validation.reference.tracking.root import bracketed
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_history import FORCE, RADIUS, TIME
from validation.reference.tracking.step_outcome import FrontCandidate

COARSEN_EVERY = 12
"""Committed steps between two coarsenings of the nodes."""
COARSEN_EVERY_LONG = 2
"""The same where steps pass over process zones and leave many nodes."""
COARSENING_SQUARED = 10.0
"""Error allowed in coarsening, in squares of the deviation allowed in a step: of fourth order, as a step. By
default a ten-thousandth of a deviation: what is dropped is missed by every later step."""
COARSENING_SQUARED_LONG = 100.0
"""The same where steps pass over process zones, whose nodes are close to each other at the edge alone."""
COARSENING_SHARE = 0.1
"""Error allowed in coarsening, in deviations allowed in a step, at most."""
EXTREMUM_HEIGHT = 1e-13
"""Height of an extremum of the force over its rows, in largest forces, below which it is round-off."""
BESIDE_EXTREMUM = 1.0 / 32.0
"""Distance of the rows on either side of an extremum of the force, in steps: they show where it may lie."""


@dataclass(frozen=True)
class StateCommitter:
    """Commits candidates to the state of a run and records them.

    Attributes
    ----------
    problem : FrontProblem
    state : FrontState
        Changed by every commit.
    profile_times : tuple of float
        Times at which the surface is asked for.
    """

    problem: FrontProblem
    state: FrontState
    profile_times: tuple[float, ...] = ()

    @property
    def recorder(self) -> Recorder:
        """Recorder of the rows of the state."""
        return Recorder(
            self.problem.body, self.problem.work_of_adhesion, self.problem.irreversible, self.state.recorded
        )

    def commit(self, candidate: FrontCandidate, segment: Segment | None = None) -> None:
        """Make a candidate the present state; its interpolated rows are left to the recorder."""
        state, surface = self.state, candidate.surface
        state.counters.steps += 1
        state.rejected_before = state.counters.rejected_steps
        state.counters.history_updates += len(surface.inside) + len(surface.outside)
        long = self.problem.over_zones(surface.radius)
        if state.counters.steps % (COARSEN_EVERY_LONG if long else COARSEN_EVERY) == 0:
            allowed = self.problem.fineness.deviation
            squared = COARSENING_SQUARED_LONG if long else COARSENING_SQUARED
            surface = coarsened(surface, allowed * min(squared * allowed, COARSENING_SHARE))
        before = state.time
        state.time, state.surface, state.force = float(candidate.time), surface, float(candidate.force)
        radius = state.history.rows[-1][RADIUS] if state.history.rows else surface.radius
        self.add_row()
        if candidate.to_limit_point is not None:
            self.recorder.over_radius()
        if segment is None or candidate.intervals == 0:
            return
        if candidate.to_limit_point is None:
            self._interpolate(segment, before, candidate.intervals)
        else:
            self._interpolate_over_radius(segment, radius, candidate.intervals, candidate.to_limit_point)

    def _interpolate(self, segment: Segment, before: float, intervals: int) -> None:
        """Rows that divide the last step into intervals, and rows at an extremum of the force before it."""
        now = self.state.time
        for part in range(1, intervals):
            at = before + (now - before) * part / intervals
            self.recorder.interpolate(at, self._prescribed_depth(segment, at), 1)
        if segment.control != "force":
            self._add_turning_point(segment, before)
        self.add_extremum(segment, 2)

    def _interpolate_over_radius(self, segment: Segment, before: float, intervals: int, left: float) -> None:
        """Rows that divide the last step evenly in the root of the distance to a limit point."""
        radius, now = self.state.surface.radius, self.state.time
        first, last = math.sqrt(abs(radius - before) + left), math.sqrt(left)
        times = self.state.history.time_over_radius()
        if left == 0.0:
            times = times.over_square()
        for part in range(1, intervals):
            distance = (first + (last - first) * part / intervals) ** 2 - left
            distance = math.copysign(distance, before - radius)
            at = now + times.value_after(distance) * (distance**2 if left == 0.0 else 1.0)
            self.recorder.interpolate(at, self._prescribed_depth(segment, at), 1, radius + distance)

    def _add_turning_point(self, segment: Segment, before: float) -> None:
        """A row in the last step where the prescribed penetration, or stage, turns."""
        now = self.state.time
        first, last = segment.rate(before), segment.rate(now)
        if first * last < 0.0:
            at = bracketed(segment.rate, before, first, now, last, 0.0, 2.0 * math.ulp(now))
            self.recorder.interpolate(at, self._prescribed_depth(segment, at), 1)

    def add_extremum(self, segment: Segment, back: int) -> None:
        """Rows at and beside an extremum of the force in the ``back``-th step from the last."""
        if segment.control == "force":
            return
        state = self.state
        extremum = state.history.extremum_within(FORCE, back, EXTREMUM_HEIGHT * state.largest_force)
        if extremum is None:
            return
        at, length = extremum
        state.extrema.append(at)
        ends = [state.history.rows[-back - 1][TIME], state.history.rows[-back][TIME]]
        for time in (at - BESIDE_EXTREMUM * length, at, at + BESIDE_EXTREMUM * length):
            if ends[0] < time < ends[1]:
                self.recorder.interpolate(time, self._prescribed_depth(segment, time), back)

    @staticmethod
    def _prescribed_depth(segment: Segment, time: float) -> float | None:
        """Penetration where it is prescribed."""
        return segment.value(time) if segment.control == "penetration" else None

    def touch_of_plane_tip(self, segment: Segment) -> None:
        """Contact that begins with a plane tip at once, if it does."""
        candidate = contact_of_plane_tip(self.problem, self.state, segment)
        if candidate is not None:
            self.commit(candidate)

    def kink(self) -> None:
        """Rates jump at the present row."""
        self.state.surface = self.state.surface.with_edge_nodes_doubled()
        self.state.history.kink()
        self.state.proposal = None
        self.recorder.kink()

    def add_row(self) -> None:
        """The present state as a row, and the largest values so far."""
        state, surface = self.state, self.state.surface
        if abs(surface.radius - state.displaced_to) > AT_LIMIT_POINT * self.problem.largest_travel:
            state.last_displacement = surface.radius - state.displaced_to
            state.displaced_to = surface.radius
        self._follow_direction()
        state.largest_force = max(state.largest_force, abs(state.force))
        state.largest_radius = max(state.largest_radius, surface.radius)
        state.largest_depth = max(state.largest_depth, abs(surface.penetration))
        self.recorder.add(state.time, surface, state.force)
        state.history.add((float(state.time), surface.radius, float(state.force), float(surface.penetration)))

    def _follow_direction(self) -> None:
        """Direction of the edge in the step to the present state, and where it last turned."""
        state = self.state
        if not state.history.rows:
            return
        before = state.history.rows[-1]
        moved = state.surface.radius - before[RADIUS]
        direction = math.copysign(1.0, moved) if moved != 0.0 and state.time > before[TIME] else 0.0
        if direction != state.direction:
            turned = direction != 0.0 and state.direction != 0.0
            state.turn, state.zones_from_turn = (before[RADIUS] if turned else None), 0
        state.direction = direction

    def zone_from_turn(self) -> None:
        """The edge has come to be one more zone from its turn."""
        self.state.zones_from_turn += 1
        if self.state.zones_from_turn == 1:
            self.state.history.rates_follow_root()
            self.state.proposal = None
            self.recorder.kink()

    def add_profile(self, time: float) -> None:
        """The surface at a time at which it is asked for."""
        if time in self.profile_times:
            state, problem = self.state, self.problem
            state.profiles.append(
                surface_profile(state.time, state.surface, state.force, problem.body, problem.scene.indenter)
            )
