"""Moments of a run that a figure shows."""

from __future__ import annotations

import numpy as np

from contact_scene import Scene, Trace
from validation.measure.approach import end_of_approach
from validation.measure.observables import largest_tension

JUMP_IN, END_OF_APPROACH = "jump-in", "end of approach"
START_OF_DETACHMENT, PULL_OFF = "start of detachment", "pull-off"
HUNDREDTH = 0.01
"""Length that replaces the process zone where there is no adhesion, over the contact radius."""


def zone(scene: Scene, contact_radius: float) -> float:
    """Process-zone length; without adhesion a hundredth of the contact radius."""
    if scene.adhesion is not None and scene.is_adhesive:
        return scene.adhesion.zone
    return HUNDREDTH * contact_radius


def key_moments(trace: Trace, scene: Scene) -> dict[int, str]:
    """Rows of a cycle and their names, in order of time; what a run does not have is left out.

    The start, the end of the approach, the first row of the withdrawal at which the edge has receded by a
    process zone, and the largest tension.
    """
    turn, pull = end_of_approach(trace), largest_tension(trace)
    named = {0: JUMP_IN if scene.loading.start == "jump-in" else "start"}
    if turn > 0:
        named[turn] = END_OF_APPROACH
    radius = trace.contact_radius
    least = radius[turn] - zone(scene, float(radius[turn]))
    receded = turn + np.flatnonzero((radius[turn:] <= least) & (radius[turn:] > 0.0))
    if receded.size and (pull is None or receded[0] < pull):
        named[int(receded[0])] = START_OF_DETACHMENT
    if pull is not None and pull > turn:
        named[pull] = PULL_OFF
    return dict(sorted(named.items()))


def in_contact(trace: Trace, count: int) -> list[int]:
    """Rows spread evenly in time over the part of a run in contact, first and last included."""
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if touching.size == 0:
        return []
    first, last = trace.time[touching[0]], trace.time[touching[-1]]
    wanted = np.linspace(first, last, count)
    nearest = np.abs(trace.time[touching][:, None] - wanted).argmin(axis=0)
    return sorted({int(row) for row in touching[nearest]})
