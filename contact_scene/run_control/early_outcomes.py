"""Outcomes of runs that end before their loading does, the same for all solvers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from contact_scene.trace import Counters, Outcome, OutcomeKind

_SURFACE = 16.0 * np.finfo(float).eps
"""Penetration, relative to the largest of a run, up to which an indenter only touches."""
_EQUAL_TENSION = 1e-9
"""Difference, relative to the largest tension, below which two tensions are the same."""


def budget_outcome(counters: Counters, max_steps: int, time: float) -> Outcome | None:
    """The outcome of a run whose budget of trial steps is used up; ``None`` while there is some left."""
    if counters.steps + counters.rejected_steps < max_steps:
        return None
    return Outcome(OutcomeKind.STEP_BUDGET, f"{max_steps} steps were not enough", time)


def below_zone_outcome(force: ArrayLike, time: float) -> Outcome:
    """The outcome of a run whose contact has shrunk to the length of its process zone, where the model ends.

    ``past_extremum`` where the largest tension lies before the last row; that with which a run begins and
    which only falls is no extremum.
    """
    tension = -np.asarray(force, float)
    rises = np.flatnonzero(np.diff(tension) > 0.0)
    largest = float(tension[rises[0] :].max(initial=0.0)) if rises.size else 0.0
    past = largest > 0.0 and float(tension[-1]) < largest * (1.0 - _EQUAL_TENSION)
    remark = "after" if past else "before"
    reason = f"the contact has shrunk to its process zone, {remark} the largest tension"
    return Outcome(OutcomeKind.BELOW_ZONE, reason, time, past)


def outcome_of_loss(
    outcome: Outcome, is_adhesive: bool, penetration: ArrayLike, contact_radius: ArrayLike
) -> Outcome:
    """The outcome of a run; a breakdown if it lost a contact that, without adhesion, cannot have been lost.

    Contact may be lost at a positive penetration, for a surface recovers more slowly than an indenter leaves
    it. But where the indenter is as deep as it has ever been, ``D(s) <= D(t) = w``, the point below it bears

        q = E(t) w + int_0^t [-E'(t - s)] (w - D(s)) ds > 0

    with any relaxation modulus, and a load that bears is not lost. Rows after the loss have no radius.
    """
    depth, touching = np.asarray(penetration, float), np.flatnonzero(np.asarray(contact_radius, float) > 0.0)
    if is_adhesive or outcome.kind is not OutcomeKind.DETACHED or not touching.size:
        return outcome
    last = int(touching[-1])
    lost = float(depth[last:].min())
    if lost < float(depth[: last + 1].max()) or lost <= _SURFACE * float(np.abs(depth).max()):
        return outcome
    reason = f"without adhesion, contact was lost at the largest penetration so far, {lost:.6g}"
    return Outcome(OutcomeKind.BREAKDOWN, reason, outcome.time)
