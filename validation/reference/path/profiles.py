"""Pressure, displacement and gap of the surface, by inverse Abel transform of what the table says anywhere.

    p(r) = -(1/pi) int_r^inf dq/sqrt(x^2-r^2)                                     (r < a),
    g(r) = (2/pi) int_a^r d(y)/sqrt(r^2-y^2) dy,   u = D - f + g                  (r > a).

``q`` falls to zero at the edge, and jumps where it was released and covered at different times. Between radii
where they may do so, ``q`` and ``d`` are polynomials in panels; with ``x = r cosh(t)`` and ``y = r sin(t)``
no integrand is singular.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from contact_scene import Indenter, SurfaceProfile
from validation.reference.path.fields import NODES, TO_POWERS, WEIGHTS
from validation.reference.path.numerics import ROUNDING, total
from validation.reference.path.rheology import IndentedBody
from validation.reference.path.state import State

Array = NDArray[np.float64]

POINTS = 160
"""Points on either side of the edge."""
AXIS = 1e-6
"""Radius, in contact radii, that stands for the axis: the pressure at the tip of a cone is infinite."""
_GRADED = 0.4 ** np.arange(1, 24)
"""Distances of breaks from the edge, the axis and knots of the profile, beyond which it goes as a root."""
_ORDERS = np.arange(len(NODES))


def profile(body: IndentedBody, indenter: Indenter, state: State) -> SurfaceProfile:
    """State of the surface, at points crowded towards the edge but not on it."""
    a, edges = state.radius, state.surface.edges
    far = min(1.5 * (a + max(float(edges[-1]) if edges.size else 0.0, 0.0)) or 1.0, body.image.reach)
    within = a * np.sin(0.5 * np.pi * np.arange(POINTS) / POINTS) if a > 0.0 else np.empty(0)
    beyond = a + (far - a) * (np.arange(1 if a > 0.0 else 0, POINTS + 1) / POINTS) ** 2
    radius = np.concatenate((within, beyond))
    gaps = np.concatenate((0.0 * within, gap(body, state, beyond)))
    pressed = pressure(body, state, within) if a > 0.0 else within
    return SurfaceProfile(
        time=state.time,
        penetration=state.depth,
        force=state.force,
        contact_radius=a,
        radius=radius,
        pressure=np.concatenate((pressed, 0.0 * beyond)),
        displacement=state.depth - indenter.height(radius) + gaps,
        gap=gaps,
    )


def pressure(body: IndentedBody, state: State, radius: Array) -> Array:
    """``p(r)`` for ``0 <= r < a``, shape (m,); positive in compression."""
    a = state.radius
    breaks = _breaks(body, state, 0.0, a)
    width, q = (
        np.diff(breaks),
        _panels(lambda x: body.rheology.stress(*state.in_contact(body, x - a)), breaks),
    )
    slopes = _ORDERS[1:, None] * q[1:] / width
    jumps = np.append(q[0, 1:], 0.0) - q.sum(axis=0)  # at the outer end of each panel

    def at(r: float) -> float:
        first = max(int(breaks.searchsorted(r, side="right")) - 1, 0)
        outer = breaks[first + 1 :]
        t = np.arccosh(np.append(max(breaks[first] / r, 1.0), outer / r))
        span = np.diff(t)[:, None]
        share = (r * np.cosh(t[:-1, None] + span * NODES) - breaks[first:-1, None]) / width[first:, None]
        sharp = jumps[first:] @ (1.0 / np.sqrt((outer - r) * (outer + r)))
        smooth = (span * WEIGHTS * polyval(share, slopes[:, first:, None], tensor=False)).sum()
        return -float(sharp + smooth) / math.pi

    return np.array([at(r) for r in np.maximum(radius, AXIS * a).tolist()])


def gap(body: IndentedBody, state: State, radius: Array) -> Array:
    """``g(r)`` for ``r >= a``, shape (m,)."""
    a, far = state.radius, float(radius.max())
    breaks = _breaks(body, state, a, far)

    def opening(y: Array) -> Array:
        phi, G, carried = state.carried(body, y - a)
        return total(carried) - (phi @ state.depths - G)

    width, d = np.diff(breaks), _panels(opening, breaks)

    def at(r: float) -> float:
        last = int(breaks.searchsorted(r))
        t = np.arcsin(np.append(breaks[:last] / r, 1.0))
        span = np.diff(t)[:, None]
        share = (r * np.sin(t[:-1, None] + span * NODES) - breaks[:last, None]) / width[:last, None]
        return 2.0 / math.pi * float((span * WEIGHTS * polyval(share, d[:, :last, None], tensor=False)).sum())

    return np.array([at(r) if r > a else 0.0 for r in np.maximum(radius, AXIS * far).tolist()])


def _panels(field: Callable[[Array], Array], breaks: Array) -> Array:
    """Coefficients (6, l) of the polynomials in the panels between breaks, of the share of the panel."""
    at = breaks[:-1, None] + np.diff(breaks)[:, None] * NODES
    return np.asarray(TO_POWERS @ field(at.ravel()).reshape(at.shape).T)


def _breaks(body: IndentedBody, state: State, low: float, high: float) -> Array:
    """Radii between which the fields are smooth, with the ends."""
    knots = body.transform.knots
    marks = np.append(knots[(knots > low) & (knots < high)], (low, state.radius))[:, None]
    edges = state.radius + state.edges_between(low - state.radius, high - state.radius)
    near = marks + (high - low) * np.append(_GRADED, -_GRADED)
    breaks = np.unique(np.concatenate((near.ravel(), marks.ravel(), edges)))
    breaks = breaks[(breaks > low + ROUNDING * high) & (breaks < high * (1.0 - ROUNDING))]
    apart = np.diff(breaks, prepend=low) > ROUNDING * high
    return np.concatenate(([low], breaks[apart], [high]))
