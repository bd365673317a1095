"""The end of a contact that a process zone of fixed stress comes to fill: no step may pass over it."""

from __future__ import annotations

from contact_scene import Segment
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_outcome import StepOutcome
from validation.reference.tracking.surface import Surface

ZONE_END_SHARE = 1e-4
"""Longest step, in load steps, within which a zone of fixed stress may come to fill its contact: the end."""


def fills_its_zone(problem: FrontProblem, surface: Surface) -> bool:
    """Whether a zone of fixed stress has grown over the whole contact."""
    condition = problem.condition
    if not isinstance(condition, Griffith) or condition.adhesion.stress is None or surface.radius == 0.0:
        return False
    return condition.zone_at(surface, problem.body) >= surface.radius


def to_the_end_of_the_zone(
    problem: FrontProblem, state: FrontState, outcome: StepOutcome, segment: Segment
) -> StepOutcome:
    """A shorter step, if a zone of fixed stress would fill the contact somewhere within this one.

    Parameters
    ----------
    problem : FrontProblem
    state : FrontState
        Present state.
    outcome : StepOutcome
        Of a trial step from there.
    segment : Segment
        Load step it belongs to.

    Returns
    -------
    StepOutcome
        The same, or one that is rejected.
    """
    if not outcome.candidates or not fills_its_zone(problem, outcome.candidates[-1].surface):
        return outcome
    duration = outcome.candidates[-1].time - state.time
    if duration <= ZONE_END_SHARE * (segment.end - segment.start):
        return outcome
    travel = abs(outcome.candidates[-1].surface.radius - state.surface.radius)
    return StepOutcome(0.25 * duration, rejected=True, travel=0.25 * travel or None)
