"""Surface pressure, displacement and gap by inverse Abel transform.

    p(r) = q(a)/(pi sqrt(a^2-r^2)) - (1/pi) int_r^a q'(x)/sqrt(x^2-r^2) dx        (r < a),
    g(r) = (2/pi) int_a^r d(y)/sqrt(r^2-y^2) dy,   u = D - f + g                  (r > a).

``q`` is a cubic between nodes: the pressure is elementary (``int x^m/sqrt(x^2-r^2) dx``, m = 0, 1, 2);
the gap takes ``y = r sin(angle)``, after which nothing is singular.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact_scene import Indenter, SurfaceProfile
from validation.reference.path.rheology import Body
from validation.reference.tracking import hermite
from validation.reference.tracking.surface import Surface

Array = NDArray[np.float64]

POINTS = 160
"""Points on either side of the edge."""
AXIS = 1e-6
"""Radius, in contact radii, that stands for the axis: the pressure at the tip of a cone is infinite."""
MERGED = 1e-7
"""Distance, in contact radii, below which two nodes count as one in second derivatives."""
_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(4)


def surface_profile(
    time: float, surface: Surface, force: float, body: Body, indenter: Indenter
) -> SurfaceProfile:
    """State of the surface, at points crowded towards the edge but not on it.

    Parameters
    ----------
    time : float
    surface : Surface
    force : float
    body : Body
    indenter : Indenter

    Returns
    -------
    SurfaceProfile
    """
    a = surface.radius
    angle = 0.5 * np.pi * np.arange(POINTS) / POINTS
    within = a * np.sin(angle) if a > 0.0 else np.empty(0)
    far = 1.5 * max(a, float(surface.outside[-1])) or 1.0
    beyond = a + (far - a) * (np.arange(1 if a > 0.0 else 0, POINTS + 1) / POINTS) ** 2
    radius = np.concatenate((within, beyond))
    opening = gap(surface, body, beyond)
    gaps = np.concatenate((np.zeros_like(within), opening))
    pressed = pressure(surface, body, within) if a > 0.0 else np.empty(0)
    return SurfaceProfile(
        time=time,
        penetration=surface.penetration,
        force=force,
        contact_radius=a,
        radius=radius,
        pressure=np.concatenate((pressed, np.zeros_like(beyond))),
        displacement=surface.penetration - indenter.height(radius) + gaps,
        gap=gaps,
    )


def pressure(surface: Surface, body: Body, radius: Array) -> Array:
    """``p(r)`` for ``0 <= r < a``, shape (m,).

    Parameters
    ----------
    surface : Surface
    body : Body
    radius : ndarray, shape (m,)
        Of the points, less than the contact radius.

    Returns
    -------
    ndarray, shape (m,)
        Stress, positive in compression.
    """
    a = surface.radius
    nodes = surface.inside
    fine = np.unique(np.concatenate((nodes, 0.75 * nodes[:-1] + 0.25 * nodes[1:], np.linspace(0.0, a, 400))))
    apart = np.append(np.diff(fine) > MERGED * a, True)
    fine = fine[apart]
    memory = surface.branches.sum(axis=1)
    q = hermite.evaluate(nodes, memory, hermite.slopes(nodes, memory), fine)
    q += body.rheology.relaxed * (surface.penetration - body.transform(fine))
    slope = hermite.slopes(fine, q)
    left, h = fine[:-1], np.diff(fine)
    secant = np.diff(q) / h
    bend = (
        slope[:-1] + slope[1:] - 2.0 * secant
    ) / h**2  # q' = slope + 2 c2 (x - left) + 3 bend (x - left)^2
    c2 = (3.0 * secant - 2.0 * slope[:-1] - slope[1:]) / h
    powers = (slope[:-1] - 2.0 * c2 * left + 3.0 * bend * left**2, 2.0 * c2 - 6.0 * bend * left, 3.0 * bend)
    r = np.maximum(radius, AXIS * a)[:, None]
    x = np.maximum(fine[None, :], r)
    root = np.sqrt((x - r) * (x + r))
    area = np.arccosh(x / r)
    integrals = (area, root, 0.5 * (x * root + r * r * area))
    inner = sum(c * np.diff(i, axis=1) for c, i in zip(powers, integrals, strict=True))
    edge = q[-1] / np.sqrt((a - r[:, 0]) * (a + r[:, 0]))
    return np.asarray((edge - np.sum(inner, axis=1)) / np.pi)


def gap(surface: Surface, body: Body, radius: Array) -> Array:
    """``g(r)`` for ``r >= a``, shape (m,).

    Parameters
    ----------
    surface, body
        As of :func:`pressure`.
    radius : ndarray, shape (m,)
        Of the points, no less than the contact radius.

    Returns
    -------
    ndarray, shape (m,)
        Length.
    """
    nodes, strain = surface.outside, surface.units.sum(axis=1)
    slope = hermite.slopes(nodes, strain)
    r = np.where(radius > 0.0, radius, 1.0)[:, None]
    breaks = np.concatenate((nodes, np.linspace(nodes[0], max(radius.max(), nodes[0]), 60)[1:]))
    breaks = np.unique(breaks)[None, :]
    angle = np.arcsin(np.minimum(breaks / r, 1.0))
    half = 0.5 * np.diff(angle, axis=1)[:, :, None]
    at = 0.5 * (angle[:, 1:] + angle[:, :-1])[:, :, None] + half * _GAUSS
    y = r[:, :, None] * np.sin(at)
    free = np.where(y > nodes[-1], 0.0, hermite.evaluate(nodes, strain, slope, y))
    d = free - surface.penetration + body.transform(y)
    total = (2.0 / np.pi) * (half * _WEIGHT * d).sum(axis=(1, 2))
    return np.where(radius > 0.0, total, 0.0)
