"""Kinks of the fields: where the load had one or the edge turned, what it left has a jump, or one of slope.

The closure has its breaks there. The path has a corner where the edge or an end of its zone comes to one of
them. It is passed over: the next steps are predicted by as many rows as lie behind.

Kinks fade, and what many old turns have left is then smooth. So at every new one the entries of the table are
looked at two by two, and those joined that one polynomial replaces. A kink is what is still between entries.
The rows begin anew there, too: no step is predicted across the little that this changes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from validation.reference.path.fields import NODES, TO_POWERS, Passages, along
from validation.reference.path.numerics import powers
from validation.reference.path.rheology import Body, total
from validation.reference.path.state import State

Array = NDArray[np.float64]

FADED = 1e-2
"""Change, in tolerances and the field at the edge, below which two entries are joined: times their width, in
zones or as seen from the edge, for it is integrals over the fields that count. And times zone over radius: it
takes so little at least to drive the edge by a zone."""


def faded(state: State, body: Body, zone: float, tolerance: float) -> State:
    """The state with entries joined that have come to agree."""
    if state.radius == 0.0 or len(state.surface.held) < 2:
        return state
    size, relaxed = zone or 0.1 * state.radius, body.rheology.relaxed
    G, carried = state.carried(body, size * np.array([-1.0, -1e-12, 1e-12, 1.0]))
    field = np.abs(total(carried) + np.array([relaxed, relaxed, -1.0, -1.0]) * (state.depth - G))
    allowed = FADED * tolerance * size / state.radius * np.array([field[2:].max(), field[:2].max()])
    surface = state.surface
    for first in (0, 1):
        surface = _joined(surface, body, state.radius, first, size, allowed)
    return replace(state, surface=surface)


def _joined(
    surface: Passages, body: Body, radius: float, first: int, size: float, allowed: Array
) -> Passages:
    """The table with every other pair of entries joined where that changes less than ``allowed``.

    The new one carries what they do now, as if it were passed now.
    """
    pairs = np.arange(first, len(surface.held) - 1, 2)
    pairs = pairs[surface.held[pairs] == surface.held[pairs + 1]]
    if not len(pairs):
        return surface
    low, middle, high = surface.edges[pairs], surface.edges[pairs + 1], surface.edges[pairs + 2]
    parabola = _over_both(surface.parabola[pairs], surface.parabola[pairs + 1], low, middle, high)
    linear, one, two = parabola[:, 2:], (middle - low)[:, None] * NODES, (high - middle)[:, None] * NODES
    new = (high - low)[:, None] * NODES * (linear + (1.0 - linear) * NODES)
    x = np.hstack((low[:, None] + new, low[:, None] + one, middle[:, None] + two))
    G = body.transform(np.maximum(radius + x.ravel(), 0.0))
    carried = surface.at(x.ravel(), G, body.rheology.times, body.rheology.retardation)[1]
    carried = carried.reshape(*x.shape, -1)
    count = len(NODES)
    left = np.matmul(TO_POWERS, carried[:, :count])
    g = along(parabola.repeat(2 * count, axis=0), x[:, count:].ravel())[0]
    fitted = np.matmul(powers(g, count - 1).reshape(len(pairs), 2 * count, count), left)
    change = np.abs(fitted - carried[:, count:]).sum(axis=2).max(axis=1)
    width, away = high - low, np.minimum(np.abs(low), np.abs(high))
    share = width / np.minimum(np.maximum(width, away), size)
    agree = change * share < allowed[surface.held[pairs].astype(int)]
    return surface.joined(pairs[agree], parabola[agree], left[agree])


def _over_both(one: Array, two: Array, low: Array, middle: Array, high: Array) -> Array:
    """Parabolas that leave with the slope of one, arrive with that of the next, and have its pace between."""
    (begin, leaving), (met, before) = along(one, low), along(one, middle)
    (after, behind), (end, arriving) = along(two, middle), along(two, high)
    pace = behind / before
    length = np.abs(met - begin) + np.abs(end - after) * pace
    linear = 1.0 + 0.5 * length * (leaving - arriving / pace) / (high - low)
    linear[~np.isfinite(linear)] = 1.0  # the edge turned between them
    return np.column_stack((low, high - low, np.minimum(np.maximum(linear, 0.0), 2.0)))
