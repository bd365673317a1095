"""Length of a process zone of fixed cohesive stress, from the tension behind the edge.

The tension over the zone is that of the sharp edge, ``sigma = (1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx``.
Integrated over ``r`` from ``b = a - da`` to ``a``, and by parts over ``x = b/cos(t)``,

    int_b^a sigma dr = -(1/pi) int_0^arccos(b/a) q(b/cos t) dt = (4/pi) s da.

``q`` behind the edge does not depend on the zone: the length is one root for every end of a step.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.closure import points
from validation.reference.path.root import bracketed

Array = NDArray[np.float64]
_EVEN = np.linspace(0.0, 1.0, 5)
SHORTEST = 1e-3
"""Shortest zone that is followed, in zones at rest: the edge pulls a thirtieth as much."""
LONGEST = 1.0 - 1e-9
"""Longest, in contact radii: it fills the contact."""


def zone_length(
    stress: Callable[[Array], Array],
    edges: Array,
    radius: float,
    cohesive: float,
    at_rest: float,
    guess: float,
) -> float:
    """The length; ``stress``: ``q`` at radii in contact, ``edges``: where it may have kinks."""

    def lack(root: float) -> float:
        """Nearly straight in the root of the length: next to the edge the tension goes like ``K/sqrt(x)``."""
        inner = radius - root * root
        widest = math.acos(inner / radius)
        breaks = np.concatenate(
            (widest * _EVEN, np.arccos(inner / edges[(edges > inner) & (edges < radius)]))
        )
        angle, weight = points(np.unique(breaks))
        tension = -float(weight @ stress(np.minimum(inner / np.cos(angle), radius)))
        return (tension - 4.0 * cohesive * root * root) / root

    low, high = math.sqrt(min(SHORTEST * at_rest, 0.5 * radius)), math.sqrt(LONGEST * radius)
    x = math.sqrt(guess)
    f = lack(x)
    if not math.isfinite(f):
        return math.nan
    after = x * (1.0 + 1e-4)
    for _ in range(8):
        if not low < after < high:
            break
        value = lack(after)
        if value == f:
            break
        step = value * (after - x) / (value - f)
        x, f, after = after, value, after - step
        if abs(step) < 1e-13 * x:
            return x * x
    if lack(low) <= 0.0:
        return low * low
    if lack(high) >= 0.0:
        return high * high
    return bracketed(lack, low, high) ** 2
