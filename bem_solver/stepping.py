"""The loop: trial steps, accepted or not; only here is state committed.

Steps adapt to how far edge and load depart from straight lines within them, and to a limit on the travel of
the edge. Where the edge would go further than that, the step that takes it just there is sought instead; if
it goes further even in no time, with the travel limit reduced sixty-fourfold, the contact is unstable:
recorded as an event, followed by the next stable contact at the same load or, without one, by detachment.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from scipy.optimize import brentq

from bem_solver.candidate import Candidate, Unresolvable
from bem_solver.checkpoint import Place, goes_on, of_stepper
from bem_solver.commit import committed
from bem_solver.energy import Energies
from bem_solver.history import History
from bem_solver.loading_intervals import Piece
from bem_solver.prediction import Past, departure, grown, shrunk
from bem_solver.recorder import Recorder
from bem_solver.root_search import rising_root
from bem_solver.start import contact_scale, equilibrium
from bem_solver.surface import Surface
from bem_solver.trial import Front, Problem, Trial, evaluate
from contact_scene import Outcome, OutcomeKind, RunMonitor

_FINEST_TRAVEL = 1.0 / 64.0
_LOAD_WEIGHT = 4.0  # the load follows the prescribed history closer than the edge its chord
_WIDEST_TRAVEL = 4096.0
_ACCURACY = 4e-3  # of the edge, in step tolerances of the length it is resolved on
_RESIDUAL = 1e-2  # of the closure, in step tolerances of the work of adhesion
_NOTHING = 1e-9  # of the largest force: steep profiles keep a radius to the last
_VANISHING = 2e-3  # contact radius, relative to its largest: an adhesionless contact is lifting off


@dataclass
class Stepper:
    """State of a run: committed front and energies, and what the next step is predicted from."""

    problem: Problem
    front: Front
    energies: Energies
    recorder: Recorder
    tolerance: float
    divisions: int
    max_steps: int
    scale: float
    progress: Callable[[float], None] | None = None
    monitor: RunMonitor | None = None
    place: Place = field(default_factory=Place)
    slope: float = 0.0  # of the residual with the edge, from the last accepted search
    travel: float = 1.0  # share of the travel limit in force
    step: float = 0.0
    largest_force: float = 0.0
    largest_edge: float = 0.0
    receding: bool = True  # which way the edge last ran into its travel limit
    span: float = 0.0  # by which the prescribed quantity varies over the piece
    past: Past = field(default_factory=Past)

    def follow(self, piece: Piece) -> Outcome | None:
        """Take the run through a piece, from where it stands in it; an outcome if it ends there."""
        if not self.place.begun:
            self._begin(piece)
        parameter, rejected = self.place.parameter, self.place.rejected
        while parameter < piece.length:
            self.place.reach(parameter, rejected)
            if not goes_on(self.monitor, lambda: of_stepper(self)):
                return Outcome(OutcomeKind.INTERRUPTED, "stopped from outside", self.front.time)
            counters = self.problem.counters
            if counters.steps + counters.rejected_steps >= self.max_steps:
                reason = f"{self.max_steps} steps were not enough"
                return Outcome(OutcomeKind.STEP_BUDGET, reason, self.front.time)
            if self.front.edge == 0.0:
                parameter, outcome = self._touch(piece, parameter)
                if outcome is not None:
                    return outcome
                continue
            step = self._next_step(piece, parameter)
            if parameter + step <= parameter:
                return Outcome(OutcomeKind.STEP_UNDERFLOW, "the step fell below rounding", self.front.time)
            try:
                candidate = self._attempt(piece, parameter, step)
            except Unresolvable:
                self.travel *= 4.0
                candidate = None
                if self.travel <= _WIDEST_TRAVEL:
                    counters.rejected_steps += 1
                    continue
            if candidate is None:
                counters.rejected_steps += 1
                if _FINEST_TRAVEL < self.travel <= _WIDEST_TRAVEL:
                    self.travel *= 0.5
                    continue
                outcome = self._run_away(piece, parameter)
                if outcome is not None:
                    return outcome
                continue
            moved = abs(candidate.trial.motion.new_edge - self.front.edge)
            # a travel that no shorter step shortens is the edge snapping over an annulus: taken as it is
            far = moved > 10.0 * _ACCURACY * self.tolerance * self.problem.length_at(self.front.edge)
            snapped = far and any(step < 0.5 * tried and moved > 0.7 * gone for tried, gone in rejected)
            if candidate.error > 1.0 and not (snapped and candidate.error < math.inf):
                counters.rejected_steps += 1
                if candidate.error == math.inf and step <= 1e-12 * piece.length:
                    outcome = self._run_away(piece, parameter)
                    if outcome is not None:
                        return outcome
                    continue
                rejected.append((step, moved))
                self.step = shrunk(step, candidate.error)
                continue
            rejected = []
            self.slope = candidate.slope or self.slope
            self.step = grown(candidate.parameter - parameter, candidate.error)
            parameter = candidate.parameter
            self._commit(candidate.trial, piece.time(parameter))
            self.past.add(parameter, self.front.edge, self._load(piece, self.front))
            self.travel = min(1.0, 2.0 * self.travel)
            if self.front.edge <= self.problem.zone:
                self.recorder.event("pull-off", self.front)
                reason = "the contact has become as short as the process zone"
                return Outcome(OutcomeKind.DETACHED, reason, self.front.time)
            if self.problem.work == 0.0 and (
                self.front.edge < _VANISHING * self.largest_edge
                or abs(self.front.surface.force) < _NOTHING * self.largest_force
            ):
                return self._lift_off(piece)
        if piece.jump:
            self.step = 0.0  # a share of the jump, no time
        return None

    def _begin(self, piece: Piece) -> None:
        """Set out on a piece."""
        if piece.fresh:
            self.recorder.kink()
            self.step = min(self.step, 0.05 * piece.length) if self.step > 0.0 else 0.01 * piece.length
        if piece.jump:
            self.step = 0.1
        self.span = piece.span
        self.past.rows = (
            [(0.0, self.front.edge, self._load(piece, self.front))]
            if piece.fresh
            else [(row[0] - self.past.rows[-1][0], row[1], row[2]) for row in self.past.rows]
        )
        self.place.begun = True

    def _next_step(self, piece: Piece, parameter: float) -> float:
        """The step to try.

        Within the travel limit, over no more than a slight bend of the prescribed history, and not leaving a
        sliver before the end.
        """
        reach = 0.9 * self.travel * self.problem.length_at(self.front.edge) / self.divisions
        speed = abs(self.past.rates(self.step)[0])
        if speed * self.step > reach:
            self.step = reach / speed
        left = piece.length - parameter
        self.step = min(self.step, left)
        while (bend := piece.bend(parameter, self.step, self.span) / self.tolerance) > 1.0:
            self.step = shrunk(self.step, bend)
        if self.step >= left * (1.0 - 1e-9):
            return left
        return min(self.step, 0.5 * left) if 2.0 * self.step > left else self.step

    @staticmethod
    def _load(piece: Piece, front: Front) -> float:
        """The quantity that is not prescribed."""
        return front.surface.force if piece.control == "penetration" else front.penetration

    def _trial(self, piece: Piece, parameter: float, edge: float) -> Trial:
        duration = 0.0 if piece.jump else piece.time(parameter) - self.front.time
        return evaluate(self.problem, self.front, duration, edge, piece.control, piece.prescribed(parameter))

    def _attempt(self, piece: Piece, parameter: float, step: float) -> Candidate | None:
        """A candidate for the step, or ``None`` where the edge runs away."""
        front, length = self.front, self.problem.length_at(self.front.edge)
        limit = self.problem.scene.indenter.edge
        reach = self.travel * length / self.divisions
        low, high = max(front.edge - reach, 0.25 * front.edge), min(front.edge + reach, limit)
        rates = self.past.rates(step)
        end = piece.length if step == piece.length - parameter else parameter + step
        if front.edge == limit:
            resting = self._at_rest(piece, parameter, end, rates)
            if resting is not None:
                return resting
        found = rising_root(
            lambda edge: self._trial(piece, end, edge),
            self.past.edge_after(step),
            self.slope,
            low,
            high,
            _ACCURACY * self.tolerance * length,
            _RESIDUAL * self.tolerance * self.problem.work or math.inf,
        )
        if found.where == "here" or (found.where == "above" and high == limit):
            return Candidate(end, found.trial, self._error(piece, found.trial, step, rates), found.slope)
        self.receding = found.where == "below"
        edge = low if self.receding else high

        def residual(share: float) -> float:
            return self._trial(piece, parameter + share * step, edge).residual

        if (residual(0.0) > 0.0) == (found.trial.residual > 0.0):
            return None
        share = self._share(residual, found.trial.residual > 0.0)
        if parameter + share * step <= parameter:
            raise Unresolvable
        trial = self._trial(piece, parameter + share * step, edge)
        inward = self._trial(piece, parameter + share * step, edge - 0.01 * reach)
        if inward.residual > trial.residual:
            return Candidate(end, found.trial, math.inf)  # an equilibrium, but not a stable one
        return Candidate(parameter + share * step, trial, 0.0, found.slope)

    @staticmethod
    def _share(residual: Callable[[float], float], sign: bool) -> float:
        """Share of the step at which a residual of the given sign at its end begins, however early."""
        upper = lower = 1.0
        while lower > 1e-300 and (residual(lower) > 0.0) == sign:
            lower, upper = 1e-3 * lower, lower
        return brentq(residual, lower, upper, xtol=1e-300, rtol=1e-7)

    def _at_rest(
        self, piece: Piece, parameter: float, end: float, rates: tuple[float, float]
    ) -> Candidate | None:
        """A step of a contact that fills a flat punch, up to where it recedes; ``None`` from there on."""
        edge, step = self.front.edge, end - parameter
        trial = self._trial(piece, end, edge)
        if trial.residual <= 0.0:
            return Candidate(end, trial, self._error(piece, trial, step, rates))
        if self._trial(piece, parameter, edge).residual >= -1e-6 * trial.residual:
            return None
        at = brentq(lambda p: self._trial(piece, p, edge).residual, parameter, end, xtol=1e-12 * end)
        if at <= parameter:
            return None
        trial = self._trial(piece, at, edge)
        return Candidate(
            at, trial, self._error(piece, trial, at - parameter, self.past.rates(at - parameter))
        )

    def _error(self, piece: Piece, trial: Trial, step: float, rates: tuple[float, float]) -> float:
        """Departure of edge and load from straight lines, in tolerances."""
        edge = trial.motion.new_edge
        stiffness = 2.0 * edge * self.problem.chain.relaxed
        force = self.span * (stiffness if piece.control == "penetration" else 1.0)
        # a load that starts from zero is measured against a hundredth of what is to come
        scale = max(self.largest_force, abs(trial.surface.force), 0.01 * force)
        load = trial.surface.force
        if piece.control == "force":
            load = trial.motion.new_penetration
            scale /= stiffness
        off_edge = departure(edge - self.front.edge - rates[0] * step, self.problem.length_at(edge))
        off_load = departure(load - self._load(piece, self.front) - rates[1] * step, scale)
        return max(off_edge, _LOAD_WEIGHT * off_load) / self.tolerance

    def _commit(self, trial: Trial, time: float) -> None:
        """Make the trial the state."""
        surface = trial.surface
        if not (math.isfinite(surface.force) and math.isfinite(trial.motion.new_penetration)):
            raise FloatingPointError("force or penetration is not finite")
        self.front, self.energies = committed(
            self.problem, self.front, self.energies, trial, time, self.divisions, self.tolerance
        )
        self.largest_force = max(self.largest_force, abs(surface.force))
        self.largest_edge = max(self.largest_edge, surface.edge)
        self.problem.counters.steps += 1
        self.recorder.row(self.front, self.energies)
        if self.progress is not None:
            self.progress(time)

    def _restart(self, piece: Piece, parameter: float, step: float) -> None:
        """Forget the rates after a jump of the edge."""
        self.past.rows = [(parameter, self.front.edge, self._load(piece, self.front))]
        self.travel, self.step = 1.0, step
        self.recorder.kink()

    def _touch(self, piece: Piece, parameter: float) -> tuple[float, Outcome | None]:
        """Without contact: wait for the load to turn positive, then make the first small contact."""
        if piece.control == "force" and piece.prescribed(piece.length) < 0.0:
            return parameter, Outcome(OutcomeKind.DETACHED, "pulled without contact", self.front.time)
        stride = piece.length / 64.0
        later = min(parameter + stride, piece.length)
        if piece.prescribed(later) <= 0.0:
            free = Surface.free(self.problem.annuli)
            penetration = (
                piece.prescribed(later) if piece.control == "penetration" else self.front.penetration
            )
            self.front = Front(piece.time(later), penetration, free, self.front.history)
            self.recorder.row(self.front, self.energies)
            return later, None
        if piece.prescribed(parameter) < 0.0:
            parameter = brentq(piece.prescribed, parameter, later, xtol=1e-14 * piece.length)
        # far enough to be positive beyond rounding, near enough for the history not to matter
        first = min(parameter + 1e-6 * piece.length, piece.length)
        while piece.prescribed(first) <= 0.0 and first < piece.length:
            first = min(parameter + 2.0 * (first - parameter), piece.length)
        load = piece.prescribed(first)
        scale = contact_scale(self.problem.scene, load) if piece.control == "penetration" else self.scale
        found = equilibrium(self.problem, self.front, piece.control, load, scale)
        if found is None:
            return parameter, Outcome(OutcomeKind.NO_EQUILIBRIUM, "no first contact found", self.front.time)
        self._commit(found, piece.time(first))
        self._restart(piece, first, max(first - parameter, 1e-6 * piece.length))
        return first, None

    def _run_away(self, piece: Piece, parameter: float) -> Outcome | None:
        """The edge runs away at the present load: find where it comes to rest."""
        front, problem = self.front, self.problem
        limit = problem.scene.indenter.edge

        def trial(edge: float) -> Trial:
            return evaluate(problem, front, 0.0, edge, piece.control, piece.prescribed(parameter))

        # a residual of rounding size is no reason to stop
        stress = problem.work or 0.5 * self.largest_force / front.edge
        receding, nothing = self.receding, 1e-9 * stress
        reach = problem.length_at(front.edge) / self.divisions
        # from beyond the stretch that was tried in vain: landing where it stood would be for ever
        start = reach * _FINEST_TRAVEL
        edge = front.edge - start if receding else min(front.edge + start, limit)
        ratio = 1.0 / 1.02 if receding else 1.02
        smallest = max(1e-3 * self.scale, problem.zone)  # as short as the process zone is no contact any more
        while smallest < edge < 1e3 * self.scale and (receding or edge < limit):
            nearer, edge = edge, min(edge * ratio, limit)
            landed = trial(edge)
            stays = landed.residual < -nothing if receding else landed.residual > nothing
            if not stays and edge < limit:
                continue
            if stays:
                low, high = min(edge, nearer), max(edge, nearer)
                landed = rising_root(
                    trial, edge, 0.0, low, high, _ACCURACY * self.tolerance * problem.length_at(edge)
                ).trial
            if abs(landed.motion.new_edge - front.edge) > reach:  # less is no jump but a step
                self.recorder.event("pull-off" if receding else "snap-in", front)
            self._commit(landed, front.time)
            self._restart(piece, parameter, 1e-3 * piece.length)
            return None
        self.recorder.event("pull-off" if receding else "snap-in", front)
        if receding:
            reason = f"no stable contact at {piece.control} {piece.prescribed(parameter):.6g}"
            return Outcome(OutcomeKind.DETACHED, reason, front.time)
        return Outcome(OutcomeKind.OUT_OF_RANGE, "the contact spreads without bound", front.time)

    def _lift_off(self, piece: Piece) -> Outcome:
        """The last, vanishing contact of an adhesionless indenter: its area falls to zero linearly."""
        (before, wide, _), (now, narrow, _) = self.past.rows[-2:]
        ahead = narrow**2 * (now - before) / (wide**2 - narrow**2) if wide > narrow else 0.0
        end = min(now + ahead, piece.length)
        penetration = piece.prescribed(end) if piece.control == "penetration" else self.front.penetration
        free = Surface.free(self.problem.annuli)
        # the free surface keeps its dent
        dent = replace(History.blank(len(self.problem.chain)), outer=self.front.history.outer)
        self.front = Front(piece.time(end), penetration, free, dent)
        self.energies = self.energies.unloaded()
        self.recorder.event("pull-off", self.front)
        self.recorder.row(self.front, self.energies)
        return Outcome(OutcomeKind.DETACHED, "the contact area fell to zero", self.front.time)
