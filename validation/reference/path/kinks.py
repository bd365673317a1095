"""Kinks of the fields, weighed by what they do to the path.

Where the load has a kink or the edge turns, the fields it leaves have a jump, or a jump of slope. The edge
feels it where an end of its zone comes to that radius, or the edge itself does: at ``c - da``, ``c + da`` and
``c`` the slope of the residual over the radius changes, by the product of the jump on one side and of the
field that the closure pairs it with on the other. Passing over it unseen mispredicts the path by that change,
over the distance passed, over the gradient of the residual.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.edge_law import EdgeLaw
from validation.reference.path.rheology import Body, total
from validation.reference.path.state import State

Array = NDArray[np.float64]
NEARBY = 0.02
"""Distance from a kink at which the fields are compared, in zones: a thinner layer counts as a jump."""

AFTER_CORNER = 0.02
"""First step after a corner, in the step before, where the residual tells nothing about it."""
FADED = 1e-3
"""Jump, in tolerances and the field at the edge, below which a kink is forgotten."""


def corners(state: State, law: EdgeLaw, travel: float) -> tuple[Array, Array]:
    """Distances on the way at which the residual may have a kink, and the kinks they come from."""
    zone = law.zone
    kinks = np.array(state.kinks)
    shifts = (-zone, 0.0, zone) if zone and not law.cohesive else (0.0,)
    at = np.concatenate([kinks + shift for shift in shifts])
    ahead = math.copysign(1.0, travel) * at
    near = 1e-7 * zone if zone else 1e-9 * state.radius
    within = np.flatnonzero((at > -state.radius) & (ahead > near) & (ahead < 1.01 * abs(travel)))
    return at[within], np.tile(kinks, len(shifts))[within]


def weights(
    state: State, body: Body, law: EdgeLaw, passed: float, seen: float, at: Array, kinks: Array
) -> tuple[Array, Array]:
    """Misprediction of a step that passes over each, in tolerances; the part of it that mispredicts by one.

    ``passed``: way of the edge in the step. ``seen``: change of the residual in one tolerance.
    """
    a, zone = state.radius, law.zone
    if not zone or not seen:
        return np.full(len(at), math.inf), np.full(len(at), AFTER_CORNER)
    jump, bend, apart, (inner, stress, opening, outer) = _probed(state, body, zone, kinks)
    inside = kinks < 0.0
    partner = np.where(inside, opening, stress)
    partner = np.where(at == kinks, np.where(inside, outer, inner), partner)
    factor = 0.5 * math.pi / (a * math.pi**2 * zone * (law.adhesion.work if law.adhesion else 1.0))
    passed = min(passed, zone)
    factor = factor * np.abs(partner) / seen
    linear, square = factor * jump * passed, factor * 0.5 * bend / apart * passed**2
    return linear + square, 2.0 / (linear + np.sqrt(linear**2 + 4.0 * square))


def _probed(state: State, body: Body, zone: float, kinks: Array) -> tuple[Array, Array, Array, Array]:
    """Jumps of the fields at kinks, of their slopes times a distance, that distance; the fields at the edge.

    Jumps are those of the straight lines through two points on either side: a slope is none. The fields at
    the edge are ``q`` at ``a - da`` and ``a``, ``d`` at ``a`` and ``a + da``.
    """
    rheology = body.rheology
    size = zone or 0.1 * state.radius
    apart = np.minimum(NEARBY * size, np.maximum(np.abs(kinks) / 3.0, 1e-9 * size))
    probes = (kinks[:, None] + apart[:, None] * np.array([-2.0, -1.0, 1.0, 2.0])).ravel()
    edge = size * np.array([-1.0, -1e-12, 1e-12, 1.0])
    x = np.concatenate((probes, edge))
    G = body.transform(np.maximum(state.radius + x, 0.0))
    held, carried = state.surface.at(x, G, rheology.times, rheology.retardation)
    gap = state.depth - G
    stress = rheology.relaxed * gap + float(rheology.moduli @ state.memory)
    field = total(carried) + np.where(held, stress, -gap)
    one, two, three, four = field[:-4].reshape(-1, 4).T
    return np.abs(2.0 * (three - two) + one - four), np.abs(four - three - two + one), apart, field[-4:]


def faded(state: State, body: Body, zone: float, tolerance: float) -> tuple[float, ...]:
    """The kinks that are left, without those whose fields have become smooth."""
    kinks = np.array(state.kinks)
    if state.radius == 0.0 or len(kinks) < 2:
        return state.kinks
    jump, bend, _, edge = _probed(state, body, zone, kinks)
    scale = np.where(kinks < 0.0, np.abs(edge[:2]).max(), np.abs(edge[2:]).max())
    left = jump + bend > FADED * tolerance * scale
    left |= np.abs(kinks) < 1e-6 * (zone or state.radius)
    return tuple(kinks[left].tolist())
