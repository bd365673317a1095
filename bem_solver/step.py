"""A trial step on graded annuli: a candidate for the next state, or why there is none.

Nothing is committed here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from bem_solver.kinks import speed_jump_between
from bem_solver.resting_edge import in_full_contact, pinned
from bem_solver.root_search import RootSearchResult, rising_root
from bem_solver.step_error import error_in_the_middle, least_bent_travel, step_error
from bem_solver.step_result import Candidate, FailedStep
from bem_solver.step_trials import StepTrials
from bem_solver.travel_limit import to_travel_limit
from bem_solver.trial import TrialContact


@dataclass(frozen=True)
class TrialStep(StepTrials):
    """A step along a loading interval, carried out: the edge at its end is sought.

    Where the edge would go further than its travel limit, or inside the process zone, the shorter step that
    takes it just there is sought instead. An edge turns only if the residual asks for it where it stands:
    just beyond the place where it would turn the annuli do not resolve what it covers, and where the residual
    hardly rises with the edge, as before a limit point, that makes a false root.
    """

    def result(self) -> Candidate | FailedStep:
        """The candidate, or why there is none."""
        problem, state = self.problem, self.state
        edge, limit = state.contact.edge, problem.scene.indenter.edge
        low = max(edge - self.reach(advancing=False), 0.25 * edge, problem.zone)
        if problem.scene.bare_plane_tip < edge:
            low = max(low, problem.scene.bare_plane_tip)
        high = min(edge + self.reach(advancing=True), limit)
        if edge == limit:
            resting = in_full_contact(self)
            if resting is not None:
                return resting
        if problem.irreversible is not None:
            opening = pinned(self)
            if isinstance(opening, Candidate):
                return opening
            low, high = (low, edge) if opening > 0.0 else (edge, high)
        at_end = cache(lambda at: self.trial(self.end, at))
        expected = self._expected_edge()
        if expected == edge and self._hardly_turns(at_end(edge).residual):
            return self._ending(at_end(edge))
        root = self._root(at_end, expected, low, high)
        if (root.x - edge) * state.contact.history.direction < 0.0:
            excess = at_end(edge).residual
            if self._hardly_turns(excess):
                return self._ending(at_end(edge))
            if (root.x - edge) * excess > 0.0:
                low, high = (low, edge) if excess > 0.0 else (edge, high)
                root = self._root(at_end, edge, low, high)
        if root.position == "converged" and 0.0 < root.x - edge <= self.edge_accuracy:
            return self._ending(at_end(edge), root.slope)
        if root.position == "converged" or (root.position == "above" and high == limit):
            return self._ending(root.trial, root.slope)
        receding = root.position == "below"
        return to_travel_limit(self, receding, low if receding else high, root)

    def _ending(self, trial: TrialContact, slope: float = 0.0) -> Candidate:
        """The candidate of the whole step."""
        return Candidate(self.end, trial, step_error(self, trial, self.step, slope), slope)

    def checked_in_the_middle(self, candidate: Candidate) -> Candidate:
        """A candidate with the error that shows there, of a step before which no rate is known.

        Only if a branch relaxes in it: over less a load has no time to turn.
        """
        state = self.state
        shortest = self.problem.chain.relaxation.min(initial=math.inf)
        told = len(state.accepted.rows) > 1 or candidate.trial.motion.duration <= shortest
        if told or candidate.error > 1.0:
            return candidate
        taken = candidate.parameter - state.parameter
        half = replace(self, step=0.5 * taken).result()
        if isinstance(half, FailedStep):
            return candidate
        error = error_in_the_middle(self, candidate.trial, half.trial, taken)
        return replace(candidate, error=max(candidate.error, error))

    def to_speed_jump(self, candidate: Candidate) -> Candidate | None:
        """A shorter step than a candidate's, to the first radius on its way at which its speed may jump.

        Of no length if that is where it starts; ``None`` if there is no such radius.
        """
        contact, problem = self.state.contact, self.problem
        edge, new_edge, zone = contact.edge, candidate.trial.motion.new_edge, candidate.trial.zone
        if problem.work == 0.0:
            return None
        radius = speed_jump_between(contact.history.past_kinks, zone, edge, new_edge, self.edge_accuracy)
        if radius is None:
            return None
        if abs(radius - edge) <= self.edge_accuracy:
            return replace(candidate, parameter=self.state.parameter, error=0.0, speed_jumps=True)
        step = replace(self, step=candidate.parameter - self.state.parameter)
        beyond = step.trial(candidate.parameter, radius)
        root = RootSearchResult("converged", radius, beyond, 0.0)
        result = to_travel_limit(step, new_edge < edge, radius, root)
        return replace(result, speed_jumps=True) if isinstance(result, Candidate) else None

    def _root(
        self, at_end: Callable[[float], TrialContact], guess: float, low: float, high: float
    ) -> RootSearchResult[TrialContact]:
        """Search for the edge at the end of the step."""
        slope, accuracy, residual = self.state.slope, self.edge_accuracy, self.residual_accuracy
        return rising_root(at_end, guess, slope, low, high, accuracy, residual)

    def _hardly_turns(self, excess: float) -> bool:
        """Whether the residual where the edge stands asks it to turn, but for no more than it is known.

        A glass that is stiffer by far than the rubber hardly lets it: the residual falls at once, and its
        next root is false.
        """
        known = min(self.state.slope * self.edge_accuracy, self.residual_accuracy)
        return 0.0 < excess * self.state.contact.history.direction <= known

    def _expected_edge(self) -> float:
        """Edge to start the search from: extrapolated, but the present one if the parabola turns round.

        Behind a receding edge of a stiff glass the residual of covered points is rounding, with false roots.
        Nor is it known within the outermost annulus: an edge expected nearer than its accuracy is sought
        where it stands, or at rest it would find them.
        """
        accepted, edge = self.state.accepted, self.state.contact.edge
        expected = accepted.edge_after(self.step)
        if abs(expected - edge) >= least_bent_travel(self, edge):
            expected = accepted.expected_edge(self.step)
        goes_on = (expected - edge) * accepted.rates(0.0)[0] > 0.0
        return expected if goes_on and abs(expected - edge) >= self.edge_accuracy else edge
