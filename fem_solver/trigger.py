"""The step that ends where force, contact radius or penetration reaches the level of a trigger.

Trial steps of other lengths than the dyadic ones, each with its own response of the half-space and its own
edge; the load step ends with the one that just reaches the level.
"""

from __future__ import annotations

from scipy.optimize import brentq

from contact_scene import Segment, Trigger
from fem_solver.contact_solver import ContactCandidate
from fem_solver.trial_step import TriedSteps

_LENGTH_TOLERANCE = 1e-14
"""Accuracy of the length of the step, relative to it: close to rounding."""


class _NoEquilibrium(Exception):
    """A shorter step does not end in equilibrium."""


def step_to_level(
    run: TriedSteps, segment: Segment, trigger: Trigger, dt: float, contact: ContactCandidate
) -> ContactCandidate | None:
    """The state at the level; ``None`` if the step does not pass it, or passes it in a jump of the edge.

    Parameters
    ----------
    run : TriedSteps
    segment : Segment
        Load step.
    trigger : Trigger
    dt : float
        Length of the step that may pass the level.
    contact : ContactCandidate
        Its end.

    Returns
    -------
    ContactCandidate or None
    """
    now = run.state
    before = trigger.excess(now.penetration, now.force, now.radius)

    def excess_of(candidate: ContactCandidate) -> float:
        if not candidate.in_equilibrium:
            raise _NoEquilibrium
        return trigger.excess(candidate.penetration, candidate.force, run.solver.radius(candidate))

    def excess(length: float) -> float:
        if length == 0.0:
            return before
        return excess_of(run.trial_step(segment, length, run.time + length).contact)

    try:
        if before * excess_of(contact) > 0.0:
            return None
        length = float(brentq(excess, 0.0, dt, xtol=_LENGTH_TOLERANCE * dt, rtol=1e-15))
        return run.trial_step(segment, length, run.time + length).contact
    except _NoEquilibrium:
        return None
