"""Length of a process zone of fixed cohesive stress ``s`` (definition: ``contact_scene.adhesion``).

The zone is as long as the mean tension over it is ``(4/pi) s``. Of the singular part that mean falls as the
root of the length, so that there is one such length, if the tension over the whole contact is not larger.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from bem_solver.closure import ClosureRule
from bem_solver.surface import ContactSurface

_LEAST = 1e-3
"""Shortest zone that is followed, in zones at rest: the edge pulls a thirtieth of what it would at rest."""


def tension_over(surface: ContactSurface, rule: ClosureRule, length: float) -> float:
    """``int sigma dr`` over a length from the edge inwards, the punches at kinks from their own edges on.

    Parameters
    ----------
    surface : ContactSurface
    rule : ClosureRule
    length : float
        At most the contact radius.

    Returns
    -------
    float
        Force per length, positive in tension.
    """
    total = length * (rule.weight @ surface.tension(length * rule.distance))
    kinks = surface.kinks
    if kinks is None or surface.strengths is None:
        return float(total)
    depth = surface.edge - kinks.radius
    for index in np.flatnonzero(depth < length).tolist():
        own = length - depth[index]
        tension = surface.strengths[index] * kinks.tension(index, own * rule.distance)
        total += own * (rule.weight @ tension)
    return float(total)


def zone_at(surface: ContactSurface, rule: ClosureRule, stress: float, at_rest: float) -> float:
    """Length of the zone, at most the contact radius.

    Parameters
    ----------
    surface : ContactSurface
    rule : ClosureRule
    stress : float
        Cohesive stress.
    at_rest : float
        Length at rest, a thousandth of which is the least.

    Returns
    -------
    float
    """

    def excess(length: float) -> float:
        return tension_over(surface, rule, length) - 4.0 / math.pi * stress * length

    edge = surface.edge
    least = min(_LEAST * at_rest, 0.5 * edge)
    if edge == 0.0 or surface.kappa >= 0.0 or excess(least) <= 0.0:
        return least
    if excess(edge) >= 0.0:
        return edge
    return float(brentq(excess, least, edge, xtol=1e-15 * edge, rtol=1e-12))
