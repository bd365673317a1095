"""Length of a process zone of fixed cohesive stress, from the tension behind the edge.

The tension over the zone is that of the sharp edge, ``sigma = (1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx``.
Integrated over ``r`` from ``b = a - da`` to ``a``, and by parts over ``x = b/cos(t)``, which lies
``da - 2 b sin(t/2)^2/cos(t)`` behind the edge,

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
    """The length; ``stress``: ``q`` at distances from the edge, ``edges``: those where it may have kinks."""

    def lack(root: float) -> float:
        """Nearly straight in the root of the length: next to the edge the tension goes like ``K/sqrt(x)``."""
        zone = root * root
        widest = 2.0 * math.asin(math.sqrt(0.5 * zone / radius))
        near = edges[(edges > -zone) & (edges < 0.0)]
        angles = 2.0 * np.arcsin(np.sqrt(0.5 * (zone + near) / (radius + near)))
        angle, weight = points(np.unique(np.concatenate((widest * _EVEN, angles))))
        behind = 2.0 * (radius - zone) * np.sin(0.5 * angle) ** 2 / np.cos(angle) - zone
        tension = -float(weight @ stress(np.minimum(behind, 0.0)))
        return (tension - 4.0 * cohesive * zone) / root

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
