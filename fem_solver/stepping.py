"""The loop over loading steps: trial, judgement, and the only place where anything is committed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from contact_scene import Counters, OutcomeKind, Segment
from contact_scene.loading import Control
from fem_solver.checkpoint import Place
from fem_solver.condensed import Response
from fem_solver.edge import EdgeLaw, EdgeSearch, Fate
from fem_solver.history import Ended, History
from fem_solver.recorder import Recorder, SurfaceState
from fem_solver.release import ContactProblem, EdgeGeometry
from fem_solver.step_control import Clock, Judge

Array = NDArray[np.float64]

_REJECT = 2.0  # errors over what is allowed at which a step is taken back
_SHORTEST = 1e-6  # of the shortest relaxation time or of the interval: below that, an instability
_FIRST = 1.0 / 64.0  # of the interval, and twice that of the shortest relaxation time: the first step
_SHORTEST_PART = 2.0**-10  # of a jump of the load, where the answer is curved
_LAST_PART = 2.0**-24  # of a jump of the load, before contact is lost
_NOTABLE = 4.0  # jumps of the edge that count as an event, in travels allowed per step
_BEND_SHARE = 10.0  # departure of the prescribed value from a straight line, allowed per tolerance
_SAMPLES = (0.273, 0.618, 1.0)  # uneven, so that no oscillation hides between them


@dataclass
class Run:
    """State of a run: the half-space, the edge and what has been recorded."""

    history: History
    geometry: EdgeGeometry
    law: EdgeLaw
    height: Array
    judge: Judge
    recorder: Recorder
    shortest_time: float
    force_scale: Callable[[float], float]
    max_steps: int
    visit: Callable[[float], None]
    goes_on: Callable[[], bool]
    wanted: tuple[float, ...] = ()
    place: Place = field(default_factory=Place)
    counters: Counters = field(default_factory=Counters)
    time: float = 0.0
    _range: float = 0.0

    @property
    def state(self) -> SurfaceState:
        """The last accepted state."""
        if self.recorder.last is None:
            raise AssertionError("the run has not started")
        return self.recorder.last

    def start(self, penetration: float, relaxed: bool) -> None:
        """Glassy or relaxed equilibrium, from the undeformed half-space."""
        dt = math.inf if relaxed else 0.0
        problem, response = self._problem(dt, "penetration", penetration)
        found = self.law.start(problem)
        self._count(problem)
        if found.fate is Fate.ADVANCING:
            self._out_of_range(found)
        if found.fate is Fate.RECEDING:
            raise Ended(
                OutcomeKind.NO_EQUILIBRIUM,
                f"no stable contact at penetration {penetration:.6g}",
            )
        self._commit(dt, problem, response, found.s)
        self.visit(self.time)

    def carry_out(self, segment: Segment, tell: Callable[[float], None]) -> None:
        """One loading step, from where the run stands in it; ``tell`` hears the fraction done."""
        place = self.place
        if place.start is None:
            self._set_out(segment)
        inner = [t for t in self.wanted if segment.start < t < segment.end]
        kinks = set(segment.kinks)
        for end in sorted({*inner, *kinks, segment.end}):
            if place.start is None or end <= place.start:
                continue
            if place.clock is None:
                place.clock = Clock(place.start, end)
                self._begin(place.clock, place.stride)
            while not place.clock.done:
                if not self.goes_on():
                    raise Ended(OutcomeKind.INTERRUPTED, "stopped from outside")
                self._step(segment, place.clock)
                tell((self.time - segment.start) / (segment.end - segment.start))
            self.visit(end)
            if end in kinks:
                self.judge.forget()
            place.reach(end, None if end in kinks else place.clock.dt)

    def _set_out(self, segment: Segment) -> None:
        """The jump, if any, with which a loading step begins."""
        state = self.state
        before = state.penetration if segment.control == "penetration" else state.force
        target = segment.value(segment.start)
        scale = max(abs(before), abs(target))
        self.judge.forget()
        if abs(target - before) > 1e-12 * scale:
            self._jump(segment.control, target)
        self._range = _range(segment)
        self.place.reach(segment.start, None)

    def _begin(self, clock: Clock, stride: float | None) -> None:
        length = clock.end - clock.start
        scale = min(self.shortest_time, length)
        first = stride or min(_FIRST * length, 2.0 * _FIRST * self.shortest_time)
        clock.limit(first, max(_SHORTEST * scale, 8.0 * np.spacing(abs(clock.end)), length * 2.0**-40))

    def _step(self, segment: Segment, clock: Clock) -> None:
        self._spend()
        while True:
            bend = self._bend(segment, clock)
            if bend > _REJECT and not clock.shortest:
                clock.halve()
                continue
            dt = clock.dt
            problem, response = self._problem(dt, segment.control, segment.value(clock.next_time))
            now = self.state
            low, high = self._travel(now)
            found = self.law.seek(problem, now.s, low, high)
            self._count(problem)
            if found.fate is Fate.SETTLED:
                slopes, scales = self._slopes(problem, found.s, dt)
                error = max(bend, self.judge.error(slopes, scales, dt))
                if error <= _REJECT or clock.shortest:
                    break
            elif clock.shortest:
                found = self._jump_edge(problem, found)
                slopes, error = {}, 0.0
                break
            self.counters.rejected_steps += 1
            clock.halve()
        self.time = clock.next_time
        clock.advance()
        self._commit(dt, problem, response, found.s)
        self.judge.accept(slopes)
        moved = abs(self.state.radius - now.radius)
        if error > 1.0 or moved > 0.9 * self.judge.travel:
            clock.halve()
        elif error < 0.25 and moved < 0.4 * self.judge.travel:
            clock.double()

    def _spend(self) -> None:
        """A step may be taken."""
        if self.counters.steps >= self.max_steps:
            raise Ended(OutcomeKind.STEP_BUDGET, f"{self.max_steps} steps did not suffice")

    def _bend(self, segment: Segment, clock: Clock) -> float:
        """How far the prescribed value departs from a straight line over a step, over what is allowed."""
        if segment.linear or self._range == 0.0:
            return 0.0
        start, value, rate = clock.time, segment.value(clock.time), segment.rate(clock.time)
        ahead = [(clock.next_time - start) * part for part in _SAMPLES]
        largest = max(abs(segment.value(start + x) - value - rate * x) for x in ahead)
        return largest / (_BEND_SHARE * self.judge.tolerance * self._range)

    def _travel(self, now: SurfaceState) -> tuple[float, float]:
        """Edge positions within one step's travel, at least one node either way."""
        low = self.geometry.position(now.radius - self.judge.travel)
        high = self.geometry.position(now.radius + self.judge.travel)
        return min(low, now.s - 1.0), max(high, now.s + 1.0)

    def _slopes(
        self, problem: ContactProblem, s: float, dt: float
    ) -> tuple[dict[str, float], dict[str, float]]:
        now = self.state
        radius = self.law.radius(problem, s)
        ends = {
            "force": (problem.force(s), now.force, self.force_scale(radius)),
            "penetration": (problem.penetration(s), now.penetration, self._depth_scale()),
            "radius": (radius, now.radius, 10.0 * radius),
        }
        if problem.control == "penetration":
            del ends["penetration"]
        slopes = {name: (new - old) / dt for name, (new, old, _) in ends.items()}
        return slopes, {name: scale for name, (_, _, scale) in ends.items()}

    def _depth_scale(self) -> float:
        depths = [row[1] for row in self.recorder.rows[:: max(1, len(self.recorder.rows) // 64)]]
        return max(max(depths) - min(depths), 1e-2 * max(abs(d) for d in depths))

    def _jump(self, control: Control, target: float) -> None:
        """A load that changes at once: glassy, as far as it takes the edge.

        Taken in parts over which the answer is nearly straight: the work is that of an edge that moves with
        the load, and contact is lost where it cannot follow, not where the jump began.
        """
        first = self.state.penetration if control == "penetration" else self.state.force
        done, part, scale = 0.0, 1.0, 0.0

        def at_once(share: float) -> tuple[ContactProblem, Response, EdgeSearch]:
            value = target if share == 1.0 else first + share * (target - first)
            problem, response = self._problem(0.0, control, value)
            found = self.law.seek(problem, self.state.s, self.law.lowest, math.inf)
            self._count(problem)
            return problem, response, found

        while done < 1.0:
            self._spend()
            part = min(part, 1.0 - done)
            problem, response, found = at_once(done + part)
            if found.fate is Fate.SETTLED:
                middle, _, halfway = at_once(done + 0.5 * part)
                ends = (_answer(self.state, control), _conjugate(problem, found.s))
                scale = max(scale, *(abs(end) for end in ends))
                bulge = abs(_conjugate(middle, halfway.s) - 0.5 * (ends[0] + ends[1]))
                curved = halfway.fate is not Fate.SETTLED or bulge > self.judge.tolerance * scale
                too_long = curved and part > _SHORTEST_PART
            else:
                too_long = part > _LAST_PART
            if too_long:
                self.counters.rejected_steps += 1
                part *= 0.5
                continue
            if found.fate is not Fate.SETTLED:
                self._lost(found)
            self._commit(0.0, problem, response, found.s)
            done += part
            part *= 2.0

    def _jump_edge(self, problem: ContactProblem, ran: EdgeSearch) -> EdgeSearch:
        """The edge outruns the shortest step: follow it to where it is stable again."""
        advancing = ran.fate is Fate.ADVANCING
        if not advancing and ran.s <= self.law.lowest:
            self._lost(ran)
        low, high = (ran.s, math.inf) if advancing else (self.law.lowest, ran.s)
        landed = self.law.seek(problem, ran.s, low, high)
        self._count(problem)
        if landed.fate is not Fate.SETTLED:
            self._lost(landed)
        jump = abs(self.law.radius(problem, landed.s) - self.state.radius)
        if jump > _NOTABLE * self.judge.travel:
            self.recorder.event("snap-in" if advancing else "pull-off")
        return landed

    def _lost(self, found: EdgeSearch) -> None:
        if found.fate is Fate.ADVANCING:
            self._out_of_range(found)
        self.recorder.event("pull-off")
        shrunk = self.state.radius < (self.geometry.zone or 0.0)
        remark = ", having shrunk below the process zone" if shrunk else ""
        raise Ended(OutcomeKind.DETACHED, f"contact lost at penetration {self.state.penetration:.6g}{remark}")

    def _out_of_range(self, found: EdgeSearch) -> None:
        reached = self.geometry.radius(found.s)
        raise Ended(
            OutcomeKind.OUT_OF_RANGE,
            f"the contact grows beyond the radius {reached:.6g} the mesh is made for",
        )

    def _problem(self, dt: float, control: str, value: float) -> tuple[ContactProblem, Response]:
        response = self.history.respond(dt)
        return ContactProblem(self.geometry, response, self.height, control, value), response

    def _count(self, problem: ContactProblem) -> None:
        self.counters.closure_evaluations += problem.evaluations
        self.counters.linear_solves += 1

    def _commit(self, dt: float, problem: ContactProblem, response: Response, s: float) -> None:
        forces = problem.forces(s)
        values = (problem.penetration(s), problem.force(s), self.law.radius(problem, s))
        if not (np.isfinite(forces).all() and all(map(math.isfinite, values))):
            raise Ended(OutcomeKind.NOT_FINITE, "a force or a radius is not finite")
        self.history.commit(dt, response, forces)
        penetration, force, radius = values
        history = self.history
        displacement = history.displacement
        gap = self.height - penetration + displacement
        state = SurfaceState(
            self.time,
            penetration,
            force,
            radius,
            s,
            forces,
            displacement,
            history.stored_energy,
            -0.5 * float(forces @ gap),
            history.dissipated,
        )
        self.recorder.add(state)
        self.counters.steps += len(self.recorder.rows) > 1


def _answer(state: SurfaceState, control: Control) -> float:
    """The quantity that is not prescribed."""
    return state.force if control == "penetration" else state.penetration


def _conjugate(problem: ContactProblem, s: float) -> float:
    """The same, of a trial."""
    return problem.force(s) if problem.control == "penetration" else problem.penetration(s)


def _range(segment: Segment) -> float:
    """Span of a curved control law over its segment, from unevenly spread samples."""
    if segment.linear:
        return 0.0
    spread = np.mod(np.arange(256) * 0.5 * (math.sqrt(5.0) - 1.0), 1.0)
    values = [segment.value(segment.start + (segment.end - segment.start) * x) for x in spread]
    return max(values) - min(values)
