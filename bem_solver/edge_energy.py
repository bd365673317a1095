"""What a moving edge takes up per area, and what the interface has spent (definition: ``contact_scene``).

The velocity of the edge at the end of a step is the slope there of the parabola through the edge at both
ends and at the start of the step before, if there was one without a kink between: second order in the step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from contact_scene import Adhesion

_LEAST_SLOPE = 0.01
"""Speed at the end of a step, relative to its mean, below which the parabola would turn the edge around."""


@dataclass(frozen=True)
class EdgeStep:
    """A step of the edge: its duration, and where the edge was at its start."""

    duration: float
    edge: float


def end_velocity(edge: float, now: float, duration: float, before: EdgeStep | None) -> float:
    """Rate of the radius at the end of a step from ``edge`` to ``now``; infinite at fixed time.

    Parameters
    ----------
    edge, now : float
        Radius at the start and at the end.
    duration : float
    before : EdgeStep or None
        The step before; ``None`` after a kink.

    Returns
    -------
    float
        A length per time.
    """
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

    Parameters
    ----------
    adhesion : Adhesion
    closure : float
        The closure integral with the edge where it is.
    at_once : bool
        At fixed time, where the edge has no finite speed.

    Returns
    -------
    float or None
        An energy per area.
    """
    if closure < adhesion.closing:
        return adhesion.closing
    opening = adhesion.opening(math.inf) if at_once else adhesion.work
    return opening if closure > opening else None


def energy_spent(adhesion: Adhesion, before: float, after: float, closures: tuple[float, float]) -> float:
    """Energy that the interface takes up as the edge moves.

    Parameters
    ----------
    adhesion : Adhesion
    before, after : float
        Contact radius.
    closures : tuple of float
        The closure integral before and after: what an opening edge takes up there.

    Returns
    -------
    float
        Negative where the edge closes.
    """
    area = math.pi * (before - after) * (before + after)
    if area <= 0.0:
        return adhesion.closing * area
    if adhesion.rate is None:
        return adhesion.work * area
    most = adhesion.opening(math.inf)
    return area * 0.5 * sum(min(max(closure, adhesion.work), most) for closure in closures)
