"""Kinks of the fields: where the load had one or the edge turned, what it left has a jump, or one of slope.

The closure has its breaks there. The path has a corner where the edge or an end of its zone comes to one of
them. Most are slight, and passed over: the next steps are predicted by as many rows as lie behind. A step
that fails by far is tried again as far as the first corner on its way.
"""

from __future__ import annotations

import math

import numpy as np

from validation.reference.path.rheology import Body, total
from validation.reference.path.state import State

NEARBY = 0.02
"""Distance from a kink at which the fields are compared, in zones: a thinner layer counts as a jump."""

FADED = 1e-3
"""Jump, in tolerances and the field at the edge, below which a kink is forgotten."""


def corner(state: State, zone: float, travel: float) -> float:
    """Distance to the first place on the way of the edge where the path may have a corner; else NaN."""
    at = np.add.outer((-zone, 0.0, zone) if zone else (0.0,), state.kinks).ravel()
    ahead = at * np.sign(travel)
    near = 1e-7 * zone if zone else 1e-9 * state.radius
    within = at[(at > -state.radius) & (ahead > near) & (ahead < abs(travel))]
    return float(within[np.abs(within).argmin()]) if len(within) else math.nan


def faded(state: State, body: Body, zone: float, tolerance: float) -> tuple[float, ...]:
    """The kinks that are left, without those whose fields have become smooth.

    The fields are compared as straight lines through two points on either side: a slope is no jump.
    """
    kinks = np.array(state.kinks)
    if state.radius == 0.0 or len(kinks) < 2:
        return state.kinks
    size, rheology = zone or 0.1 * state.radius, body.rheology
    apart = np.minimum(NEARBY * size, np.maximum(np.abs(kinks) / 3.0, 1e-9 * size))
    probes = (kinks[:, None] + apart[:, None] * np.array([-2.0, -1.0, 1.0, 2.0])).ravel()
    x = np.concatenate((probes, size * np.array([-1.0, -1e-12, 1e-12, 1.0])))
    G = body.transform(np.maximum(state.radius + x, 0.0))
    held, carried = state.surface.at(x, G, rheology.times, rheology.retardation)
    stress = rheology.relaxed * (state.depth - G) + float(rheology.moduli @ state.memory)
    field = total(carried) + np.where(held, stress, G - state.depth)
    one, two, three, four = field[:-4].reshape(-1, 4).T
    jump, bend = np.abs(2.0 * (three - two) + one - four), np.abs(four - three - two + one)
    at_edge = np.abs(field[-4:])
    scale = np.where(kinks < 0.0, at_edge[:2].max(), at_edge[2:].max())
    left = jump + bend > FADED * tolerance * scale
    left |= np.abs(kinks) < 1e-6 * (zone or state.radius)
    return tuple(kinks[left].tolist())
