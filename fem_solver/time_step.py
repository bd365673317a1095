"""One time step: trials of shrinking length until one is accepted, or the edge leaves in a jump.

A trial returns a candidate within the travel of the edge, with its error, and changes nothing. Steps are
dyadic divisions of an interval between two stops (``step_control``); one that reaches the level of a trigger
ends there. A state becomes part of the run here, one row each, and may end it. Penetration is positive
downwards, force positive in compression.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NoReturn

from contact_scene import Counters, LoadingCursor, Outcome, OutcomeKind, RunMonitor, Segment, Trigger
from contact_scene.loading import Control
from contact_scene.run_control import below_zone_outcome, budget_outcome, outgrown_outcome
from fem_solver.contact_problem import ContactCandidate
from fem_solver.edge import energy_spent, root_between
from fem_solver.edge_path import EdgeMotion, extrapolated
from fem_solver.edge_search import EdgeSearch
from fem_solver.recorder import SurfaceRecorder, SurfaceState, SurfaceStep, Totals, profile
from fem_solver.setup import Setup
from fem_solver.state import ComponentState
from fem_solver.step_control import (
    DyadicInterval,
    Slopes,
    deviation_from_parabola,
    missed_peak,
)

MISSED = 0.1
"""What rows may miss, per allowed error of the force: of the largest tension, which may lie between two rows,
of the path of the edge, extrapolated, relative to its radius, and of the response to a load jump, which is
straight over a part of it. It is less than one: an edge that is too far inside recedes faster from then on,
so that what it misses grows towards the pull-off; and the chords of a jump all miss on one side."""
_REJECT = 2.0
"""A step is rejected if its estimated error exceeds this multiple of the allowed one."""


class RunEnded(Exception):
    """The run ends before its loading does."""

    def __init__(self, outcome: Outcome) -> None:
        super().__init__(outcome.reason)
        self.outcome = outcome


@dataclass(frozen=True)
class StepCandidate:
    """Result of a trial step; ``error`` is relative to the allowed one, infinite without equilibrium."""

    contact: ContactCandidate
    slopes: dict[str, float]
    error: float


@dataclass(frozen=True)
class StepBefore:
    """What it needs to take the last step back, which lies in the present interval and brought no event.

    Time and position within the interval at its begin, slopes of the step before it, and what stood then.
    """

    time: float
    position: Fraction
    slopes: Slopes
    totals: Totals
    state: ComponentState


@dataclass(frozen=True)
class TensionPeak:
    """Rates at which the tension rises to the last row and falls behind it, and what rows may miss of it."""

    rise: float
    fall: float
    allowed: float


class SteppedStates:
    """A run that goes from one accepted state to the next within an interval between two stops."""

    def __init__(
        self, setup: Setup, monitor: RunMonitor | None, progress: Callable[[float], None] | None
    ) -> None:
        self.setup, self.options, self.monitor, self.progress = setup, setup.options, monitor, progress
        self.recorder = SurfaceRecorder(setup.adhesion, self.options.records)
        self.slopes = Slopes()
        self.cursor, self.counters = LoadingCursor(), Counters()
        self.time = 0.0
        self.rows_at: dict[float, int] = {}
        self.interval: DyadicInterval | None = None
        self.step: float | None = None
        self.before: StepBefore | None = None

    def search(self, dt: float, control: Control, value: float, middle: float | None = None) -> EdgeSearch:
        """For the edge at the end of a step from the accepted state."""
        return EdgeSearch(self.setup, self.counters, dt, control, value, middle)

    def ahead(self, segment: Segment, dt: float, end: float) -> EdgeSearch:
        """The same at a time within a load step."""
        middle = segment.value(end - 0.5 * dt) if segment.control == "penetration" else None
        return self.search(dt, segment.control, segment.value(end), middle)

    @property
    def state(self) -> SurfaceState:
        """The last accepted state."""
        return self.recorder.last

    def force_scale(self, force: float, singular: float, radius: float) -> float:
        """Force to which errors of the force are relative.

        What a relaxing contact bears when it is pulled follows from the steps before, and after a hard press
        it is far less than the largest force of the run. There errors are relative to the larger of the
        present force and its part due to adhesion, that of the flat punch with the same edge singularity.
        Without adhesion, or without a history, the largest force serves. The scale is at least that of a
        small contact without adhesion, which begins in a point, and with adhesion the pull-off force of a
        relaxed punch of the contact radius, ``F = sqrt(8 pi E* a^3 w)`` (Kendall, J. Phys. D 4 (1971)).
        """
        scale, adhesion = self.recorder.totals.largest_force, self.setup.adhesion
        if adhesion is None:
            return max(scale, self.setup.least_force)
        if self.setup.has_history:
            scale = min(max(abs(force), abs(singular)), scale)
        return max(scale, math.sqrt(8.0 * math.pi * self.setup.relaxed_modulus * radius**3 * adhesion.work))

    # Accepting states

    def slopes_jump(self) -> None:
        """Behind a kink or a jump the slopes before it tell nothing."""
        self.slopes = Slopes()
        self.setup.state = replace(self.setup.state, sunk=None)

    def _commit(self, candidate: ContactCandidate, contact: bool = True, bent: float = 0.0) -> None:
        """Accept a state, in contact or free: history, row, counters; ``bent`` as of a surface state."""
        problem, s, setup, last = candidate.problem, candidate.edge.s, self.setup, self.recorder.totals.last
        penetration, force, radius = candidate.penetration, candidate.force, candidate.radius
        setup.state = problem.accepted(s)
        stored = setup.stored_energy  # of every component
        if not all(map(math.isfinite, (penetration, force, radius, stored))):
            self._end(OutcomeKind.NOT_FINITE, "a force or a radius is not finite")
        if self.options.records:
            ends = (replace(at, record=None, before=()) for at in (problem.state, setup.state))
            self.recorder.steps.append(SurfaceStep(problem.dt, *ends))
        self.counters.steps += last is not None
        self.recorder.add(
            SurfaceState(
                time=self.time,
                penetration=penetration,
                force=force,
                radius=radius,
                edge=s,
                stored=stored,
                interface=setup.interface_energy,
                branch_dissipation=setup.state.dissipated,
                opening=setup.state.opening,
                zone=problem.zone(s),
                singular_force=problem.singular_force(s),
                smooth=bool(self.slopes.values) + bool(self.slopes.curvatures),
                bent=bent,
                **self._interface(candidate, last),
            )
        )
        if contact and setup.geometry.stress is not None and self.state.zone >= radius:
            self._end_below_zone()

    def _interface(self, candidate: ContactCandidate, last: SurfaceState | None) -> dict[str, float]:
        """Closure, energy spent and rate of the edge, where they do not follow from the contact radius."""
        adhesion, radius, dt = self.setup.adhesion, candidate.radius, candidate.problem.dt
        if adhesion is None or adhesion.reversible:
            return {}
        closure = candidate.problem.closure(candidate.edge.s) if radius > 0.0 else 0.0
        if last is None:
            return {"closure": closure}
        spent = energy_spent(adhesion, (last.radius, radius), (last.closure, closure))
        rate = (radius - last.radius) / dt if dt > 0.0 else 0.0
        return {"closure": closure, "spent": last.spent + spent, "rate": rate}

    def _on_stop(self) -> None:
        """Profiles and rows that are asked for at the present time."""
        if self.time in self.options.profile_times:
            setup = self.setup
            self.recorder.profiles.append(profile(self.state, setup.state, setup.placement, setup.solid))
        if self.time in self.options.record_times:
            self.rows_at[self.time] = len(self.recorder.rows) - 1

    # Ends of a run

    def _end(self, kind: OutcomeKind, reason: str) -> NoReturn:
        raise RunEnded(Outcome(kind, reason, self.time))

    def _end_below_zone(self) -> NoReturn:
        raise RunEnded(below_zone_outcome([row[2] for row in self.recorder.rows], self.time))

    def _check_budget(self) -> None:
        outcome = budget_outcome(self.counters, self.options.max_steps, self.time)
        outcome = outcome or outgrown_outcome(self.setup.body, self.state.radius, self.time)
        if outcome is not None:
            raise RunEnded(outcome)

    def _contact_lost(self, candidate: ContactCandidate) -> NoReturn:
        """No equilibrium: the contact outgrows the mesh, or is lost."""
        problem = candidate.problem
        if candidate.edge.motion is EdgeMotion.ADVANCING:
            reason = f"the contact grows beyond the radius {candidate.radius:.6g} the mesh is made for"
            self._end(OutcomeKind.OUT_OF_RANGE, reason)
        if self.setup.adhesion is None:
            self._last_touch(problem.dt, problem.control, problem.value)
        self._pulled_off(problem.control)

    def _last_touch(self, dt: float, control: Control, value: float) -> None:
        """The row of the last touch without adhesion: a point, or a plane tip.

        A blunt profile keeps a radius within the shortest step of that.
        """
        value = 0.0 if control == "force" else value
        self.time += dt
        plane = self.search(dt, "force", 0.0).plane_contact()  # bears nothing as it is let go
        self._commit(plane or self.search(dt, control, value).held(0.0))

    def _pulled_off(self, control: Control) -> NoReturn:
        setup = self.setup
        self.recorder.event("pull-off", 0.5 * setup.geometry.spacing if setup.adhesion else 0.0)
        reason = f"contact lost at penetration {self.state.penetration:.6g}"
        # the spring takes the indenter to where the stage is; a given force takes the stage along
        if setup.compliance > 0.0 and control != "force":
            stage = self.state.penetration + setup.compliance * self.state.force
            self._commit(self.search(0.0, "stage", stage).held(0.0), contact=False)
        self._end(OutcomeKind.DETACHED, reason)

    @property
    def _rated(self) -> bool:
        """Whether the work of adhesion follows the speed of the edge."""
        return self.setup.adhesion is not None and self.setup.adhesion.rate is not None

    def _below_zone(self, candidate: ContactCandidate) -> bool:
        adhesion = self.setup.adhesion
        return adhesion is not None and candidate.radius < adhesion.zone

    def _end_at_zone(self, ahead: Callable[[float], EdgeSearch]) -> NoReturn:
        """End with the row in a step or part of a jump at which the contact is as short as its process zone.

        ``ahead`` gives the search at a share of it. An edge may leap past.
        """
        assert self.setup.adhesion is not None
        zone = self.setup.adhesion.zone

        def held(share: float) -> ContactCandidate:
            return ahead(share).held(zone)

        def excess(state: ContactCandidate) -> float:
            return self._excess(state, self.setup.law.taken(state.problem, state.edge.s))

        begin = excess(held(0.0))
        reached = located(held, excess, begin) if begin < 0.0 else None
        if reached is None:
            self._pulled_off(ahead(0.0).control)
        self.time += reached.problem.dt
        self._commit(reached)
        self._end_below_zone()

    # Trials

    def trial_step(self, segment: Segment, dt: float, end: float) -> StepCandidate:
        """A step with its edge within one step's travel."""
        return self._judged(self.ahead(segment, dt, end).trial(*self._reach()), segment)

    def _judged(self, contact: ContactCandidate, segment: Segment) -> StepCandidate:
        """A step with its slopes and its error."""
        if not contact.in_equilibrium:
            return StepCandidate(contact, {}, math.inf)
        now, dt, force = self.state, contact.problem.dt, contact.force
        singular = contact.problem.singular_force(contact.edge.s)
        slopes, tolerance = {"force": (force - now.force) / dt}, self.setup.tolerance
        allowed = {"force": tolerance * self.force_scale(force, singular, contact.radius)}
        if segment.control != "penetration":
            slopes["penetration"] = (contact.penetration - now.penetration) / dt
            allowed["penetration"] = tolerance * max(self.recorder.depth_scale(), self.setup.least_depth)
        error = max(self.slopes.error(slopes, allowed, dt), self._path_error(contact, dt))
        return StepCandidate(contact, slopes, error)

    def _setting_off(
        self, contact: ContactCandidate, segment: Segment, shortest: float
    ) -> ContactCandidate | None:
        """The state in which an edge pinned by hysteresis or a rim sets off; ``None`` if none does."""
        adhesion, state, start = self.setup.adhesion, self.setup.state, self.time
        way = contact.radius - state.radius
        moves_on = any((state.radius - radius) * way > 0.0 for _, radius in state.before[:1])
        if adhesion is None or way == 0.0 or moves_on:
            return None
        if adhesion.reversible and not math.isclose(state.radius, self.setup.surfaces.rim):
            return None
        limit, dt = adhesion.work if way < 0.0 else adhesion.closing, contact.problem.dt

        def resting(share: float) -> ContactCandidate:
            return self.ahead(segment, share * dt, start + share * dt).resting()

        def excess(state: ContactCandidate) -> float:
            return self._excess(state, limit)

        begin = excess(resting(0.0))
        found = located(resting, excess, begin) if begin * way > 0.0 else None
        return found if found is not None and found.problem.dt > shortest else None

    def _excess(self, state: ContactCandidate, taken: float) -> float:
        """Closure of a state over the energy that its edge takes up, less one."""
        self.counters.closure_evaluations += 1
        return max(state.problem.closure(state.edge.s) / taken, 0.0) - 1.0

    def _path_error(self, contact: ContactCandidate, dt: float) -> float:
        """Error of the edge's path over a step, relative to the allowed one.

        The force does not show it where it follows the loading whatever the edge does, as on a soft spring.
        Of the third order, it is told as the square of the step. None counts within an element, over which
        the passage of nodes ripples the path more than its steps do.
        """
        state, radius = self.setup.state, contact.radius
        if not self.setup.has_history or radius <= 0.0 or len(state.before) < 2:
            return 0.0
        radii, node = contact.problem.geometry.radii, int(contact.edge.s)
        if abs(radius - state.radius) < radii[node + 2] - radii[node]:
            return 0.0
        allowed = MISSED * self.setup.tolerance * self.setup.radius_scale(radius)
        missed = abs(radius - extrapolated(state.radius, dt, state.before))
        return (missed / allowed) ** (2.0 / 3.0)

    def _reach(self) -> tuple[float, float]:
        """Radii within one step's travel, at least one node either way."""
        geometry, radius = self.setup.geometry, self.state.radius
        travel = self.setup.travel(radius)
        low = min(geometry.position(radius - travel), self.state.edge - 1.0)
        high = max(geometry.position(radius + travel), self.state.edge + 1.0)
        return geometry.radius(low) if low > self.setup.law.lowest else 0.0, geometry.radius(high)

    def _deviation(self, segment: Segment, interval: DyadicInterval, span: float) -> float:
        """Deviation of the prescribed value from a parabola over a step, relative to the allowed one."""
        if segment.linear or span == 0.0:
            return 0.0
        largest = deviation_from_parabola(segment, interval.time, interval.next_time)
        return (largest / (MISSED * self.setup.tolerance * span)) ** (2.0 / 3.0)

    def _zone_fills_contact(self, contact: ContactCandidate) -> bool:
        """Whether a zone of fixed stress fills its contact, which is followed no farther."""
        if self.setup.geometry.stress is None or not contact.in_equilibrium:
            return False
        return contact.problem.zone(contact.edge.s) >= contact.radius

    # Steps

    def _advance(self, segment: Segment, interval: DyadicInterval, span: float) -> None:
        """One accepted step, after as many trials as it takes."""
        candidate, error = self._accepted_trial(segment, interval, span)
        contact, slopes = candidate.contact, candidate.slopes
        if segment.trigger is not None:
            at_level = step_to_level(self, segment, segment.trigger, contact)
            if at_level is not None:
                self.time += at_level.problem.dt
                self._commit(at_level)
                self.cursor.level_reached()
                return
        if contact.problem.dt < interval.dt:  # what follows has a slope of its own
            self.time += contact.problem.dt
            interval.end_at(self.time)
            self._commit(contact)
            self.slopes_jump()
            return
        radius, jumped = self.state.radius, not contact.in_equilibrium
        travel = self.setup.travel(radius)
        if jumped:
            contact, slopes, error = self._edge_jump(contact, segment, interval), {}, 0.0
        elif self._below_zone(contact):
            self._end_in_step(segment, interval.dt)
        before = StepBefore(self.time, interval.position, self.slopes, self.recorder.totals, self.setup.state)
        self.time = interval.next_time
        interval.advance()
        self._commit(contact)
        self.before = None if jumped else before
        if jumped:
            self.slopes_jump()
        else:
            # the speed of a rated edge is of second order, and so is what rows tell
            known = Slopes() if self._rated else self.slopes
            self.slopes = known.followed(slopes, contact.problem.dt)
        moved = abs(self.state.radius - radius)
        if error > 1.0 or moved > 0.9 * travel:
            interval.halve()
        elif error < 0.25 and moved < 0.4 * travel:
            interval.double()

    def _accepted_trial(
        self, segment: Segment, interval: DyadicInterval, span: float
    ) -> tuple[StepCandidate, float]:
        """The first trial step that is accepted, not committed, and its error; the interval has its size."""
        while True:
            deviation = self._deviation(segment, interval, span)
            if deviation > _REJECT and not interval.shortest:
                interval.halve()
                continue
            self._check_budget()
            candidate = self.trial_step(segment, interval.dt, interval.next_time)
            setting_off = self._setting_off(candidate.contact, segment, interval.least)
            if setting_off is not None:
                candidate = self._judged(setting_off, segment)
            error = max(deviation, candidate.error)
            if self._first_step_was_too_long(candidate, interval):
                continue
            peak = self._tension_peak(candidate)
            refused = error > _REJECT or self._zone_fills_contact(candidate.contact)
            refused |= peak is not None and peak.rise * interval.dt > peak.allowed
            if refused and not interval.shortest:
                self._reject(interval)
            elif peak is None or not self._divide_last_step(peak, interval):
                return candidate, error

    def _reject(self, interval: DyadicInterval) -> None:
        self.counters.rejected_steps += 1
        interval.halve()

    def _present_force_scale(self) -> float:
        """Force to which errors are relative in the accepted state."""
        now = self.state
        return self.force_scale(now.force, now.singular_force, now.radius)

    def _tension_peak(self, candidate: StepCandidate) -> TensionPeak | None:
        """The turn of the tension at the last row, if it is the largest so far."""
        tension = -self.state.force
        rise, fall = -self.slopes.values.get("force", 0.0), candidate.slopes.get("force", math.inf)
        allowed = MISSED * self.setup.tolerance * self._present_force_scale()
        turns = rise > 0.0 and fall > 0.0 and tension + allowed > self.recorder.totals.largest_tension
        return TensionPeak(rise, fall, allowed) if turns else None

    def _divide_last_step(self, peak: TensionPeak, interval: DyadicInterval) -> bool:
        """Take the last step back if too much of the peak may lie within it; whether it is taken back."""
        before = self.before
        if before is None or not interval.divisible(before.position):
            return False
        earlier = -before.slopes.values.get("force", -math.inf)
        if missed_peak(earlier, peak.rise, peak.fall, self.time - before.time) <= peak.allowed:
            return False
        self._take_back(before, interval)
        return True

    def _first_step_was_too_long(self, candidate: StepCandidate, interval: DyadicInterval) -> bool:
        """Whether the step after a kink, which had no slope before it, misses too much of the force's curve.

        The next step shows that; then it is taken back, to be taken in parts.
        """
        before = self.before
        if before is None or "force" in before.slopes.values or "force" not in candidate.slopes:
            return False
        if not interval.divisible(before.position):
            return False
        turn = abs(candidate.slopes["force"] - self.slopes.values["force"])
        length = self.time - before.time
        missed = turn * length**2 / (length + interval.dt)
        if missed <= _REJECT * self.setup.tolerance * self._present_force_scale():
            return False
        self._take_back(before, interval)
        return True

    def _take_back(self, before: StepBefore, interval: DyadicInterval) -> None:
        """Return to the begin of the last step, to take it in parts."""
        self.time = before.time
        self.slopes = before.slopes
        self.recorder.take_back(before.totals)
        self.setup.state = before.state
        self.counters.steps -= 1
        self.counters.rejected_steps += 1
        self.before = None
        interval.take_back(before.position)

    def _edge_jump(
        self, candidate: ContactCandidate, segment: Segment, interval: DyadicInterval
    ) -> ContactCandidate:
        """The state after an edge jump; it is an event if the edge jumps far.

        Where the energy follows the speed, an edge that a short step takes beyond the zone has passed it.
        """
        landed = self.ahead(segment, interval.dt, interval.next_time).extended(candidate)
        if not landed.in_equilibrium or self._below_zone(landed) or self._zone_fills_contact(landed):
            if self._rated and landed.edge.motion is not EdgeMotion.ADVANCING:
                self._end_in_step(segment, interval.dt)
            self._contact_lost(landed)
        if abs(landed.radius - self.state.radius) > self.setup.travel(self.state.radius):
            advancing = candidate.edge.motion is EdgeMotion.ADVANCING
            self.recorder.event("snap-in" if advancing else "pull-off")
        return landed

    def _end_in_step(self, segment: Segment, dt: float) -> NoReturn:
        """The contact becomes shorter than its process zone within a step."""
        start = self.time
        self._end_at_zone(lambda share: self.ahead(segment, share * dt, start + share * dt))


class _NoEquilibrium(Exception):
    """A shorter step does not end in equilibrium."""


def located(
    at: Callable[[float], ContactCandidate], excess: Callable[[ContactCandidate], float], begin: float
) -> ContactCandidate | None:
    """The state at the share of a step or jump where an excess loses the sign that it has at the begin.

    ``None`` if it has that at the end as well.
    """
    ends = {0.0: begin, 1.0: excess(at(1.0))}
    if begin * ends[1.0] > 0.0:
        return None
    return at(root_between(lambda share: excess(at(share)), ends))


def step_to_level(
    run: SteppedStates, segment: Segment, trigger: Trigger, contact: ContactCandidate
) -> ContactCandidate | None:
    """The state at the level; ``None`` if the step does not pass it, or passes it in a jump of the edge."""
    now, dt = run.state, contact.problem.dt

    def excess(candidate: ContactCandidate) -> float:
        if not candidate.in_equilibrium:
            raise _NoEquilibrium
        return trigger.excess(candidate.penetration, candidate.force, candidate.radius)

    def tried(share: float) -> ContactCandidate:
        return run.trial_step(segment, share * dt, run.time + share * dt).contact if share < 1.0 else contact

    try:
        return located(tried, excess, trigger.excess(now.penetration, now.force, now.radius))
    except _NoEquilibrium:
        return None
