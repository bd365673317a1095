"""What counts beside the error of a trial step: whether its edge leaps, or its zone fills the contact."""

from __future__ import annotations

import math

from bem_solver.run_state import RejectedStep, StepStart
from bem_solver.step_result import Candidate
from bem_solver.trial import EDGE_ACCURACY

_ZONE_END_SHARE = 1e-4
"""Longest step, in intervals, within which a zone of fixed stress may come to fill its contact: the end."""
_AS_FAR = 0.99
"""Travel, in that of a longer step in which nothing relaxes either, from which on an edge leaps: equal ones
differ by rounding."""


def zone_fills_contact(start: StepStart, candidate: Candidate, taken: float) -> bool:
    """Whether a zone of fixed stress comes to fill its contact within a step that is not yet short.

    Parameters
    ----------
    start : StepStart
    candidate : Candidate
    taken : float
        Length of its step.

    Returns
    -------
    bool
    """
    adhesion = start.problem.scene.adhesion
    if adhesion is None or adhesion.stress is None or start.problem.work == 0.0:
        return False
    fills = candidate.trial.zone >= candidate.trial.motion.new_edge
    return fills and taken > _ZONE_END_SHARE * start.interval.length


def edge_leaps(start: StepStart, now: RejectedStep) -> bool:
    """Whether the edge passes an annulus at once: shorter steps do not shorten its travel.

    Nor, where the load misses its line, do they mend that, though nothing relaxes in them. An edge whose
    load has just turned goes nearly as far in a tenth of the time, and does not leap.
    """
    length = start.problem.length_at(start.state.contact.edge)
    if now.travel <= 10.0 * EDGE_ACCURACY * start.settings.tolerance * length:
        return False
    shortest = math.inf if start.interval.jump else start.problem.chain.relaxation.min(initial=math.inf)
    as_far = [
        before
        for before in start.state.rejected
        if (now.step < 0.01 * before.step and now.travel > 0.7 * before.travel)
        or (now.step < 0.5 * before.step <= 0.5 * shortest and now.travel > _AS_FAR * before.travel)
    ]
    if now.load_error <= 1.0:
        return bool(as_far)
    return any(
        now.step < 0.25 * before.step <= 0.25 * shortest and now.load_error > 0.7 * before.load_error
        for before in as_far
    )
