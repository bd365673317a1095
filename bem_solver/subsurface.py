"""Stress under the surface by superposition of annular loads (Love 1929; Eason, Noble, Sneddon 1955).

The pressure of a :class:`contact_scene.SurfaceProfile` is ``p(r) = e(t)/cos(t)`` with ``r = a sin(t)`` and
``e`` smooth up to the edge: a flat punch with the same edge singularity, ``e(pi/2)/cos(t)``, and a rest that
goes to zero there. Annuli of constant pressure with equal steps in ``t`` carry the rest, each the difference
of two discs.

This needs no history. With a constant Poisson's ratio the stress is ``s = C : E * de``, the hereditary
product of Young's modulus and strain with the one elastic tensor C of unit modulus. ``E * de`` is compatible
like ``e`` itself (the product acts in time, compatibility in space), so s is an *elastic* stress: it is in
equilibrium, derives from a compatible strain and meets the tractions ``-p(r)`` on the surface, and by the
uniqueness of the elastic solution depends on the pressure of the same instant alone.

Coordinates ``(r, z)``, the body in ``z <= 0``; stress positive in tension, components ``(rr, zz, tt, rz)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from bem_solver.disc_potentials import disc_load, punch_load
from contact_scene import SurfaceProfile

Array = NDArray[np.float64]

DIVISIONS = 400
"""Annuli that carry the smooth rest of the pressure."""
_BLOCK = 1 << 18
"""Points times discs evaluated at once: bounds the memory to a few megabytes."""


def subsurface_stress(
    profile: SurfaceProfile, r: ArrayLike, z: ArrayLike, poisson: float, divisions: int = DIVISIONS
) -> Array:
    """Stress at points of the body.

    Parameters
    ----------
    profile : SurfaceProfile
        Surface at one time (``Options.profile_times``).
    r, z : array_like
        Points, ``r >= 0``, ``z <= 0``; broadcast to one shape (...).
    poisson : float
        Constant Poisson's ratio.
    divisions : int
        Annuli of the rest. At depths less than an annulus, ``1.6 a/divisions``, single annuli are seen.

    Returns
    -------
    ndarray, shape (4, ...)
        ``rr, zz, tt, rz``; zero without contact. Points on the very edge are evaluated 1e-9 a beneath it.
    """
    r, z = np.broadcast_arrays(np.asarray(r, float), np.asarray(z, float))
    if np.any(z > 0.0) or np.any(r < 0.0):
        raise ValueError("the body is in r >= 0, z <= 0")
    a = profile.contact_radius
    stress = np.zeros((4, r.size))
    if a > 0.0:
        edge, borders, jumps = _annular(profile, divisions)
        block = max(_BLOCK // len(borders), 1)
        for start in range(0, r.size, block):
            part = slice(start, start + block)
            x, depth = r.ravel()[part] / a, np.maximum(-z.ravel()[part] / a, 1e-9)
            discs = disc_load(x[:, None], depth[:, None], borders)
            loads = edge * punch_load(x, depth) + discs @ jumps
            stress[:, part] = _stress(loads, x, depth, poisson)
    return stress.reshape(4, *r.shape)


def _annular(profile: SurfaceProfile, divisions: int) -> tuple[float, Array, Array]:
    """Edge value of ``p cos(t)``, disc radii over ``a`` and the pressure of the disc of each radius."""
    a = profile.contact_radius
    inside = profile.radius < a
    angle = np.arcsin(profile.radius[inside] / a)
    values = profile.pressure[inside] * np.cos(angle)
    # smooth and even about the axis and about the edge
    keep = angle > 0.0
    angle, values = angle[keep], values[keep]
    mirrored = np.concatenate([-angle[2::-1], angle, np.pi - angle[:-4:-1]])
    smooth = CubicSpline(mirrored, np.concatenate([values[2::-1], values, values[:-4:-1]]))
    edge = float(smooth(0.5 * np.pi))
    borders = np.linspace(0.0, 0.5 * np.pi, divisions + 1)
    node, weight = np.polynomial.legendre.leggauss(3)
    half = 0.5 * np.diff(borders)[:, None]
    inner = borders[:-1, None] + half * (1.0 + node)
    # the force of each annulus, 2 pi int (p - punch) r dr, over its area
    force = (half * weight * (smooth(inner) - edge) * np.sin(inner)).sum(axis=1)
    rest = 2.0 * force / np.diff(np.sin(borders) ** 2)
    return edge, np.sin(borders[1:]), rest - np.append(rest[1:], 0.0)


def _stress(loads: Array, r: Array, depth: Array, poisson: float) -> Array:
    """Stress (4, n) from the potentials (5, n) of ``disc_potentials``; lengths in contact radii."""
    a0, a1, c0, c1, c2 = loads
    ring = (1.0 - 2.0 * poisson) * c0 - depth * c1
    return np.stack([depth * a1 - a0 + ring, -a0 - depth * a1, -2.0 * poisson * a0 - ring, depth * r * c2])
