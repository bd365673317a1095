"""What a moving edge takes up per area, and what the interface has spent (definition: ``contact_scene``).

The velocity of the edge at the end of a step is the slope there of the parabola through the edge at both
ends and at the start of the step before, if there was one without a kink between: second order in the step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Adhesion

Array = NDArray[np.float64]

_LEAST_SLOPE = 0.01
"""Speed at the end of a step, relative to its mean, below which the parabola would turn the edge around."""


@dataclass(frozen=True)
class EdgeStep:
    """A step of the edge: its duration, and where the edge was at its start."""

    duration: float
    edge: float


def end_velocity(edge: float, now: float, duration: float, before: EdgeStep | None) -> float:
    """Rate of the radius at the end of a step from ``edge`` to ``now``; infinite at fixed time."""
    if now == edge:
        return 0.0
    if duration <= 0.0:
        return math.copysign(math.inf, now - edge)
    mean = (now - edge) / duration
    if before is None or before.duration <= 0.0:
        return mean
    earlier = (edge - before.edge) / before.duration
    slope = mean + (mean - earlier) * duration / (duration + before.duration)
    return math.copysign(max(slope * math.copysign(1.0, mean), _LEAST_SLOPE * abs(mean)), mean)


def energy_taken(adhesion: Adhesion, velocity: float) -> float:
    """Energy per area that the edge takes up; at rest that at which it opens."""
    return adhesion.closing if velocity > 0.0 else adhesion.opening(-velocity)


def closure_of_departure(adhesion: Adhesion, closure: float, at_once: bool) -> float | None:
    """Closure at which an edge at rest sets off, the way it is driven; ``None`` if it rests.

    ``closure`` is the integral with the edge where it is; ``at_once`` at fixed time, where the edge has no
    finite speed.
    """
    if closure < adhesion.closing:
        return adhesion.closing
    opening = adhesion.opening(math.inf) if at_once else adhesion.work
    return opening if closure > opening else None


def energy_spent(adhesion: Adhesion, radius: Array, closure: Array) -> Array:
    """Energy that the interface takes up over every step (n - 1,); negative where the edge closes.

    Of contact radii and closure integrals (n,) at the rows: what an opening edge takes up there.
    """
    area = -np.pi * np.diff(radius**2)
    opening = np.full_like(closure, adhesion.work)
    if adhesion.rate is not None:
        opening = np.clip(closure, adhesion.work, adhesion.opening(math.inf))
    return area * np.where(area > 0.0, 0.5 * (opening[1:] + opening[:-1]), adhesion.closing)
