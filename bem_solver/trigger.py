"""The step that ends where force, contact radius or penetration reaches the level of a trigger.

Each shorter step is a trial step with an edge of its own; the length that just reaches the level is the root
of how far its end is beyond.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from scipy.optimize import brentq

from bem_solver.step import TrialStep
from bem_solver.step_result import Candidate
from contact_scene import Trigger

_LENGTH_ACCURACY = 1e-14
"""Accuracy of the length of the step, relative to it: close to rounding."""


@dataclass(frozen=True)
class Located:
    """The candidate to accept, and whether it is at the level."""

    candidate: Candidate
    reached: bool


class _NoCandidate(Exception):
    """A shorter step has no candidate at its end."""


def excess_of(trigger: Trigger, candidate: Candidate) -> float:
    """Distance of a candidate beyond the level."""
    trial = candidate.trial
    return trigger.excess(trial.motion.new_penetration, trial.surface.force, trial.motion.new_edge)


def to_level(step: TrialStep, trigger: Trigger, candidate: Candidate) -> Located:
    """The candidate itself, if it does not pass the level, otherwise that of the step that ends there.

    Parameters
    ----------
    step : TrialStep
    trigger : Trigger
    candidate : Candidate
        Of the step, or of a part of it.

    Returns
    -------
    Located
        A step that passes the level but has no candidate just there is taken whole.
    """
    contact, begin = step.state.contact, step.state.parameter
    before = trigger.excess(contact.penetration, contact.surface.force, contact.edge)
    if before * excess_of(trigger, candidate) > 0.0:
        return Located(candidate, False)
    taken = candidate.parameter - begin

    def shorter(length: float) -> Candidate:
        result = replace(step, step=length).result()
        if not isinstance(result, Candidate) or result.parameter < begin + length:
            raise _NoCandidate
        return result

    def excess(length: float) -> float:
        if length == 0.0:
            return before
        return excess_of(trigger, candidate if length == taken else shorter(length))

    try:
        length = float(brentq(excess, 0.0, taken, xtol=_LENGTH_ACCURACY * taken, rtol=1e-15))
        return Located(candidate if length == taken else shorter(length), True)
    except _NoCandidate:
        return Located(candidate, True)
