"""A step that ends where the force, the radius or the penetration reaches the level of a trigger.

The duration of the step is the unknown: a step of every shorter duration is a trial of its own, with its own
edge, so that the state at the level is as accurate as any other.
"""

from __future__ import annotations

from collections.abc import Callable

from contact_scene import Trigger
from validation.reference.tracking.root import bracketed
from validation.reference.tracking.state import FrontState
from validation.reference.tracking.step_outcome import FrontCandidate, StepOutcome

NARROW = 1e-15
"""Difference of two durations, relative to the step, below which they are the same."""
AT_LEVEL = 1e-13
"""Distance from the level, relative to it, at which it is reached: the rounding of a force."""


class _EndsBefore(Exception):
    """A trial step that does not go as far as it was asked to."""

    def __init__(self, outcome: StepOutcome) -> None:
        super().__init__()
        self.outcome = outcome


def excess_of(trigger: Trigger, candidate: FrontCandidate) -> float:
    """Distance of a candidate beyond the level."""
    surface = candidate.surface
    return trigger.excess(surface.penetration, candidate.force, surface.radius)


def step_to_level(
    trigger: Trigger, state: FrontState, passing: StepOutcome, step_until: Callable[[float], StepOutcome]
) -> tuple[StepOutcome, bool]:
    """The step that ends at the level, or a shorter one if the edge does not let it go so far.

    Parameters
    ----------
    trigger : Trigger
    state : FrontState
        Present state.
    passing : StepOutcome
        A step that passes the level.
    step_until : callable(float) -> StepOutcome
        A trial step to no later than a time.

    Returns
    -------
    StepOutcome
    bool
        Whether it ends at the level.
    """
    begin, end = state.time, passing.candidates[-1].time

    def excess(time: float) -> float:
        outcome = step_until(time)
        if not outcome.candidates or outcome.candidates[-1].time != time:
            raise _EndsBefore(outcome)
        return excess_of(trigger, outcome.candidates[-1])

    first = trigger.excess(state.surface.penetration, state.force, state.surface.radius)
    last = excess_of(trigger, passing.candidates[-1])
    tolerance = AT_LEVEL * abs(trigger.level)
    try:
        time = bracketed(excess, begin, first, end, last, tolerance, NARROW * (end - begin))
    except _EndsBefore as shorter:
        return shorter.outcome, False
    return step_until(time), True
