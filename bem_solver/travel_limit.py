"""The shorter step that takes the edge just to its travel limit; how near a limit point is, if none does."""

from __future__ import annotations

import math

from scipy.optimize import brentq

from bem_solver.root_search import RootSearchResult
from bem_solver.step_error import error_at_limit
from bem_solver.step_result import Candidate, FailedStep, StepFailure
from bem_solver.step_trials import StepTrials
from bem_solver.trial import TrialContact

_HALVINGS = 1100
"""Trials that find any share of a step: halvings from one down to the smallest number."""


def to_travel_limit(
    step: StepTrials, receding: bool, edge: float, root: RootSearchResult[TrialContact]
) -> Candidate | FailedStep:
    """The shorter step that takes the edge to its travel limit, if it is stable there.

    Parameters
    ----------
    step : StepTrials
    receding : bool
        Whether the edge goes inwards.
    edge : float
        The limit.
    root : RootSearchResult
        Of the edge at the end of the step, which lies beyond.

    Returns
    -------
    Candidate or FailedStep
    """
    start, beyond = step.state.parameter, root.trial
    known = {1.0: beyond, 0.0: step.trial(start, edge)}

    def residual(share: float) -> float:
        if share not in known:
            known[share] = step.trial(start + share * step.step, edge)
        return known[share].residual

    shortest = min(step.shortest_step / step.step, 1.0)
    if (residual(shortest) > 0.0) == (beyond.residual > 0.0):
        if (residual(0.0) > 0.0) == (beyond.residual > 0.0):
            way = _way_to_limit_point(step, edge, residual(0.0))
            return FailedStep(StepFailure.BEYOND_TRAVEL_LIMIT, receding, way)
        # within rounding of the time it goes at least so far
        parameter = min(start + step.shortest_step, step.interval.length)
        return Candidate(parameter, step.trial(parameter, edge), 0.0)
    share = brentq(residual, shortest, 1.0, xtol=1e-300, rtol=step.closure_accuracy, maxiter=_HALVINGS)
    parameter = start + share * step.step
    if parameter <= start:
        return FailedStep(StepFailure.UNRESOLVED, receding)
    trial = known[share]
    inward = step.trial(parameter, edge - 0.01 * step.reach(not receding))
    if inward.residual > trial.residual:
        travel = abs(beyond.motion.new_edge - step.state.contact.edge)
        way = _way_to_limit_point(step, edge, residual(0.0))
        return FailedStep(StepFailure.UNSTABLE, receding, way, travel)
    error = error_at_limit(
        step, trial, parameter - start, lambda: step.trial(parameter, step.state.contact.edge)
    )
    return Candidate(parameter, trial, error, root.slope)


def _way_to_limit_point(step: StepTrials, far: float, residual: float) -> float:
    """Distance of the edge from where it will run away; zero if it is within the smallest travel.

    At the load of the start the residual vanishes at the stable edge and, on the other side of the limit
    point and nearly as far from it, at an unstable one: by the parabola through the stable edge, a place
    near to it, and ``far`` with its ``residual``, half the distance between them.
    """
    edge = step.state.contact.edge
    reach, near = abs(far - edge), 2.0 * step.smallest_travel
    if reach <= near:
        return math.inf
    sign = math.copysign(1.0, far - edge)
    drop = sign * step.trial(step.state.parameter, edge + sign * near).residual / near
    if drop <= 0.0:
        return 0.0
    bend = (drop - sign * residual / reach) / (reach - near)
    return 0.5 * (near + drop / bend) if bend > 0.0 else math.inf
