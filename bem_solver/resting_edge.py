"""A step in which the edge rests: up to where it sets out, if it does."""

from __future__ import annotations

import math

from scipy.optimize import brentq

from bem_solver.edge_energy import closure_of_departure
from bem_solver.step_error import step_error
from bem_solver.step_result import Candidate
from bem_solver.step_trials import StepTrials
from bem_solver.trial import TrialContact


def in_full_contact(step: StepTrials) -> Candidate | None:
    """A step of a contact that fills a flat punch, up to where it recedes; ``None`` from there on."""
    start, edge = step.state.parameter, step.state.contact.edge
    trial = step.trial(step.end, edge)
    if trial.residual <= 0.0:
        return Candidate(step.end, trial, step_error(step, trial, step.end - start, rate_step=step.step))
    known = step.closure_accuracy * step.problem.work
    if step.trial(start, edge).residual >= -max(1e-6 * trial.residual, known):
        return None
    end = brentq(lambda p: step.trial(p, edge).residual, start, step.end, xtol=1e-12 * step.end)
    if end <= start:
        return None
    trial = step.trial(end, edge)
    return Candidate(end, trial, step_error(step, trial, end - start))


def pinned(step: StepTrials) -> Candidate | float:
    """A step of an edge at rest, up to where it sets out; if it moves at once, how strongly it would open.

    An edge that turns within the step sets out there, too. One that goes on as it came has not stopped:
    where it is known to its accuracy only, so is its closure.
    """
    start, edge, jump = step.state.parameter, step.state.contact.edge, step.interval.jump
    adhesion, last = step.problem.irreversible, step.state.contact.last_step
    assert adhesion is not None
    trial = step.trial(step.end, edge)
    departure = closure_of_departure(adhesion, trial.closure, jump)
    if departure is None:
        return Candidate(step.end, trial, step_error(step, trial, step.end - start))
    way = math.copysign(1.0, departure - trial.closure)

    def driven(at: TrialContact) -> float:
        return way * (1.0 - at.closure / departure)

    goes_on = last is not None and way * (edge - last.edge) > 0.0
    if not goes_on and driven(step.trial(start, edge)) < -step.closure_accuracy:
        end = brentq(
            lambda p: driven(step.trial(p, edge)), start, step.end, xtol=1e-14 * step.end, rtol=1e-14
        )
        if end > start:
            trial = step.trial(end, edge)
            return Candidate(end, trial, step_error(step, trial, end - start), speed_jumps=True)
    return trial.closure - adhesion.work
