"""Control laws that are not linear in time: how much they swing, and how far they leave their tangent."""

from __future__ import annotations

import math

import numpy as np

from contact_scene import Segment

_SAMPLES = (0.273, 0.618, 1.0)
"""Uneven shares of a step at which the deviation is sampled: an oscillation cannot vanish at all of them."""
_STRAIGHT = 1e-12
"""Swing, relative to the largest value, below which a law is straight but for rounding, as a smooth table of
rows on a line."""
_SPREAD = 256
"""Samples over a load step from which the swing is read."""


def swing(segment: Segment) -> float:
    """Range of a curved control law about the straight line between its ends, from unevenly spread samples.

    A drift many times as long as an oscillation is wide must not hide it.
    """
    if segment.linear:
        return 0.0
    shares = np.mod(np.arange(_SPREAD) * 0.5 * (math.sqrt(5.0) - 1.0), 1.0)
    length, change = segment.end - segment.start, segment.value(segment.end) - segment.value(segment.start)
    values = [segment.value(segment.start + length * x) - change * x for x in shares]
    spread = max(values) - min(values)
    largest = max(abs(change), *(abs(value) for value in values))
    return spread if spread > _STRAIGHT * largest else 0.0


def deviation_from_tangent(segment: Segment, start: float, end: float) -> float:
    """Largest deviation of the prescribed value from its tangent at ``start``, at samples up to ``end``.

    Parameters
    ----------
    segment : Segment
    start, end : float
        Times.

    Returns
    -------
    float
        In the unit of the prescribed value.
    """
    value, rate = segment.value(start), segment.rate(start)
    ahead = [(end - start) * share for share in _SAMPLES]
    return max(abs(segment.value(start + x) - value - rate * x) for x in ahead)
