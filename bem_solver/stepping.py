"""The loop: trial steps, accepted or not; only here is history committed.

Steps adapt to the error of extrapolating the edge and the load from the steps before, and to a limit on the
travel of the edge. Where the edge would go further than that, the step that takes it just there is sought
instead; if it goes further even in no time, with the travel limit reduced sixty-fourfold, the contact is unstable:
recorded as an event, followed by the next stable contact at the same load or, without one, by detachment.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from bem_solver.energy import Energies, stepped, surface_work
from bem_solver.history import History, distinct, gaps_to_halve, graded_nodes
from bem_solver.pieces import Piece
from bem_solver.points import advanced
from bem_solver.recorder import Recorder
from bem_solver.rootsearch import Found, rising_root
from bem_solver.start import split
from bem_solver.trial import Front, Problem, Trial, evaluate, points_at
from scene import Outcome, OutcomeKind

_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 2.0
_FINEST_TRAVEL = 1.0 / 64.0


@dataclass(frozen=True)
class Candidate:
    """A trial that satisfies the closure, the parameter it was reached at, and its error in tolerances."""

    parameter: float
    trial: Trial
    error: float
    stopped_short: bool


class Stepper:
    """State of a run: committed front and energies, and what the next step is predicted from."""

    def __init__(
        self,
        problem: Problem,
        front: Front,
        energies: Energies,
        recorder: Recorder,
        tolerance: float,
        divisions: int,
        max_steps: int,
        scale: float,
        progress: Callable[[float], None] | None,
    ) -> None:
        self.problem, self.front, self.energies, self.recorder = problem, front, energies, recorder
        self.tolerance, self.divisions, self.max_steps, self.scale = tolerance, divisions, max_steps, scale
        self.progress = progress
        self.slope = 0.0
        self.travel = 1.0  # share of the travel limit in force
        self.largest_force = abs(front.surface.force)
        self.largest_edge = front.edge
        self.past: list[tuple[float, float, float]] = []  # parameter, edge, load
        self.step = 0.0

    def length(self) -> float:
        """Length on which the edge is resolved at present."""
        if self.problem.work > 0.0:
            return self.problem.zone
        return 0.05 * self.front.edge

    def follow(self, piece: Piece) -> Outcome | None:
        """Take the run through a piece; an outcome if it ends there."""
        parameter = 0.0
        if piece.fresh or self.step <= 0.0:
            self.past = []
            self.step = min(self.step, 0.05 * piece.length) if 0.0 < self.step and not piece.jump else 0.01 * piece.length
        if piece.jump:
            self.step = 0.1
        while parameter < piece.length:
            counters = self.problem.counters
            if counters.steps + counters.rejected_steps >= self.max_steps:
                reason = f"{self.max_steps} steps were not enough"
                return Outcome(OutcomeKind.STEP_BUDGET, reason, self.front.time)
            if self.front.edge == 0.0:
                parameter, outcome = self._make_contact(piece, parameter)
                if outcome is not None:
                    return outcome
                continue
            left = piece.length - parameter
            reach = 0.9 * self.travel * self.length() / self.divisions
            speed = abs(self._rates(self.step)[0])
            if speed * self.step > reach:
                self.step = reach / speed
            step = left if self.step >= left * (1 - 1e-9) else min(self.step, 0.5 * left if self.step > 0.5 * left else left)
            if parameter + step <= parameter:
                return Outcome(OutcomeKind.STEP_UNDERFLOW, "the step fell below rounding", self.front.time)
            candidate = self._attempt(piece, parameter, step)
            if candidate is None:
                if self.travel > _FINEST_TRAVEL:
                    self.travel *= 0.5
                    counters.rejected_steps += 1
                    continue
                outcome = self._unstable(piece, parameter)
                if outcome is not None:
                    return outcome
                continue
            if candidate.error > 1.0:
                counters.rejected_steps += 1
                self.step = step * max(_SHRINK, _SAFETY / np.sqrt(candidate.error))
                continue
            taken = candidate.parameter - parameter
            finite = np.isfinite(candidate.trial.surface.force) and np.isfinite(candidate.trial.motion.new_penetration)
            if not finite:
                return Outcome(OutcomeKind.NOT_FINITE, "force or penetration is not finite", self.front.time)
            if not self.past:
                self.past.append((parameter, self.front.edge, self._load_now(piece)))
            parameter = candidate.parameter
            self.past.append((parameter, candidate.trial.motion.new_edge, self._load(piece, candidate.trial)))
            self._commit(candidate.trial, piece.time(parameter))
            if not piece.jump and self.progress is not None:
                self.progress(self.front.time)
            growth = _GROW if candidate.error == 0 else min(_GROW, _SAFETY / np.sqrt(candidate.error))
            self.step = taken * max(growth, _SHRINK) if candidate.stopped_short else step * growth
            self.travel = min(1.0, 2.0 * self.travel)
            if self.problem.work == 0.0 and self.front.edge < 2e-3 * self.largest_edge:
                return self._lift_off()
        return None

    def _trial(self, piece: Piece, parameter: float, step: float, edge: float) -> Trial:
        at = parameter + step
        end = piece.time(at) if at < piece.length else piece.end
        duration = 0.0 if piece.jump else end - self.front.time
        return evaluate(self.problem, self.front, duration, edge, piece.control, piece.prescribed(at))

    def _attempt(self, piece: Piece, parameter: float, step: float) -> Candidate | None:
        """A candidate for the step, or ``None`` where the edge runs away."""
        front = self.front
        limit = self.problem.scene.indenter.edge
        reach = self.travel * self.length() / self.divisions * 1.0
        low = max(front.edge - reach, 0.25 * front.edge)
        high = min(front.edge + reach, limit)
        rates = self._rates(step)
        guess = front.edge + rates[0] * step

        def at_edge(edge: float) -> Trial:
            return self._trial(piece, parameter, step, edge)

        found: Found[Trial] = rising_root(at_edge, guess, self.slope, low, high, 1e-7 * self.length())
        if found.slope > 0.0:
            self.slope = found.slope
        if found.where == "here" or (found.where == "above" and high == limit):
            return Candidate(
                parameter + step if step < piece.length - parameter else piece.length,
                found.trial,
                self._error(piece, found.trial, step, rates),
                False,
            )
        edge = low if found.where == "below" else high

        def residual(share: float) -> float:
            return self._trial(piece, parameter, share * step, edge).residual

        if (residual(0.0) > 0.0) == (found.trial.residual > 0.0):
            return None
        share = brentq(residual, 0.0, 1.0, xtol=1e-9, rtol=1e-9)
        if parameter + share * step <= parameter:
            return None
        trial = self._trial(piece, parameter, share * step, edge)
        return Candidate(parameter + share * step, trial, 0.0, True)

    def _error(self, piece: Piece, trial: Trial, step: float, rates: tuple[float, float]) -> float:
        """Error of the extrapolations, in tolerances."""
        edge_error = abs(trial.motion.new_edge - self.front.edge - rates[0] * step) / self.length()
        change = self._load(piece, trial) - self._load_now(piece) - rates[1] * step
        force = max(self.largest_force, abs(trial.surface.force))
        if piece.control == "penetration":
            load_error = abs(change) / force if force > 0 else 0.0
        else:
            load_error = abs(change) * 2.0 * self.front.edge * self.problem.chain.relaxed / force if force > 0 else 0.0
        return max(edge_error, load_error) / self.tolerance

    @staticmethod
    def _load(piece: Piece, trial: Trial) -> float:
        return trial.surface.force if piece.control == "penetration" else trial.motion.new_penetration

    def _load_now(self, piece: Piece) -> float:
        return self.front.surface.force if piece.control == "penetration" else self.front.penetration

    def _rates(self, step: float) -> tuple[float, float]:
        """Rates of edge and load over a past stretch no shorter than ``step``, where there is one.

        A shorter one would magnify the small unevenness with which the edge passes the annuli.
        """
        if len(self.past) < 2:
            return 0.0, 0.0
        now = self.past[-1]
        base = next((p for p in reversed(self.past[:-1]) if now[0] - p[0] >= step), self.past[0])
        del self.past[: max(0, len(self.past) - 64)]
        return (now[1] - base[1]) / (now[0] - base[0]), (now[2] - base[2]) / (now[0] - base[0])

    def _commit(self, trial: Trial, time: float, row: bool = True) -> None:
        """Make the trial the state; history is updated here and nowhere else."""
        problem, motion, surface = self.problem, trial.motion, trial.surface
        history = self.front.history
        duration = motion.duration
        if problem.remembers:
            problem.counters.history_updates += 1
            edge, length = motion.new_edge, self._resolved_length(motion.new_edge)
            reach = max(abs(edge - motion.edge), 0.25 * length)
            radius = distinct(np.concatenate((history.radius, graded_nodes(problem.annuli.radii, edge, reach))))
            spacing = self._spacing(radius, edge, length)
            radius = distinct(
                np.concatenate((radius, gaps_to_halve(radius, 0.5 * (spacing[1:] + spacing[:-1]))))
            )
            load = surface.outside(np.maximum(radius, edge))
            state = advanced(problem.chain, points_at(problem, self.front, radius), motion, load)
            history = split(problem.chain, radius, state, load, edge)
            tolerance = 0.02 * self.tolerance * float(np.abs(state).max(initial=0.0))
            history = History(
                *(
                    track.thinned(tolerance, self._spacing(track.radius, edge, length), problem.counters.steps % 2)
                    for track in (history.inner, history.outer)
                )
            )
            points = points_at(problem, self.front, edge * problem.annuli.radii)
            variables = advanced(problem.chain, points, motion, None)
        else:
            variables = np.empty((problem.annuli.count, 0))
        work, branches = surface_work(problem.annuli, problem.chain, surface.edge, surface.scaled, variables)
        self.energies = stepped(problem.chain, self.energies, work, branches, duration)
        self.front = Front(time, motion.new_penetration, surface, history)
        self.largest_force = max(self.largest_force, abs(surface.force))
        self.largest_edge = max(self.largest_edge, surface.edge)
        problem.counters.steps += 1
        if row:
            self.recorder.row(self.front, self.energies)

    def _resolved_length(self, edge: float) -> float:
        return self.problem.zone if self.problem.work > 0.0 else 0.05 * edge

    def _spacing(self, radius: np.ndarray, edge: float, length: float) -> np.ndarray:
        """Largest distance between nodes: fine within two zones of the edge, a share of the distance beyond."""
        beyond = np.maximum(np.abs(radius - edge) - 2.0 * length, 0.0)
        return length / self.divisions + 0.05 * beyond

    def _make_contact(self, piece: Piece, parameter: float) -> tuple[float, Outcome | None]:
        """From no contact to the first small one (adhesionless): where the penetration turns positive."""
        raise AssertionError

    def _unstable(self, piece: Piece, parameter: float) -> Outcome | None:
        """The edge runs away at the present load: find where it comes to rest."""
        front, problem = self.front, self.problem
        value = piece.prescribed(parameter)

        def trial(edge: float) -> Trial:
            return evaluate(problem, front, 0.0, edge, piece.control, value)

        reach = self.length() / self.divisions * _FINEST_TRAVEL
        receding = trial(max(front.edge - reach, 0.25 * front.edge)).residual > 0.0
        self.recorder.event("pull-off" if receding else "snap-in", front)
        limit = problem.scene.indenter.edge
        edge = front.edge
        factor = 1.0 / 1.02 if receding else 1.02
        while 1e-3 * self.scale < edge < 1e3 * self.scale:
            nearer, edge = edge, edge * factor
            if edge >= limit:
                edge = limit
            candidate = trial(edge)
            if (candidate.residual > 0.0) != receding or edge == limit:
                if edge == limit and candidate.residual <= 0.0:
                    landed = candidate
                else:
                    low, high = min(edge, nearer), max(edge, nearer)
                    landed = rising_root(trial, edge, 0.0, low, high, 1e-7 * self.length()).trial
                self._commit(landed, front.time)
                self.past = []
                self.travel = 1.0
                self.step = 1e-3 * piece.length
                return None
        if receding:
            reason = f"no stable contact at {piece.control} {value:.6g}"
            return Outcome(OutcomeKind.DETACHED, reason, front.time)
        return Outcome(OutcomeKind.OUT_OF_RANGE, "the contact spreads without bound", front.time)

    def _lift_off(self) -> Outcome:
        raise AssertionError

