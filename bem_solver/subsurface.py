"""Stress in a half-space by superposition of annular loads (Love 1929; Eason, Noble, Sneddon 1955).

The pressure of a :class:`contact_scene.SurfaceProfile` is ``p(r) = e(t)/cos(t)`` with ``r = a sin(t)`` and
``e`` smooth up to the edge: a flat punch with the same edge singularity, and a rest that annuli of constant
pressure with equal steps in ``t`` carry, each the difference of two discs. This needs no history: with a
constant Poisson's ratio the stress is the *elastic* one under the pressure of the same instant.

For a load ``p(r) = int P(k) J0(k r) k dk`` the stress at depth s follows from

    A0, A1 = int P (k, k^2) exp(-k s) J0(k r) dk,      C0, C1, C2 = int P (1, k, k^2) exp(-k s) J1(k r) dk.

A disc of radius c under unit pressure has ``P = c J1(k c)/k``: the Lipschitz-Hankel integrals of Eason, Noble
and Sneddon, Phil. Trans. R. Soc. A 247, 529 (1955), in elliptic integrals of ``m = 4 c r/((c + r)^2 + s^2)``.
``A0`` is the solid angle of the disc over 2 pi; ``C0`` follows from the others, being homogeneous of degree
one in ``(c, r, s)``. The punch of unit radius and pressure ``1/sqrt(1 - r^2)`` has ``P = sin(k)/k``.

Coordinates ``(r, z)``, the body in ``z <= 0``; stress positive in tension, components ``(rr, zz, tt, rz)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.special import ellipe, ellipkm1, elliprf, elliprj

from contact_scene import SurfaceProfile

Array = NDArray[np.float64]

DIVISIONS = 400
"""Annuli that carry the smooth rest of the pressure."""
_BLOCK = 1 << 18
"""Points times discs evaluated at once: bounds the memory to a few megabytes."""
_AXIS = 1e-4
"""Distance from the axis, relative to that from the rim, below which the limits on the axis are used."""


def subsurface_stress(
    profile: SurfaceProfile, r: ArrayLike, z: ArrayLike, poisson: float, divisions: int = DIVISIONS
) -> Array:
    """Stress at points of a half-space; a profile of a layer has another below it.

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
    """Stress (4, n) from the potentials (5, n) above; lengths in contact radii."""
    a0, a1, c0, c1, c2 = loads
    ring = (1.0 - 2.0 * poisson) * c0 - depth * c1
    return np.stack([depth * a1 - a0 + ring, -a0 - depth * a1, -2.0 * poisson * a0 - ring, depth * r * c2])


def disc_load(r: Array, s: Array, c: Array) -> Array:
    """``A0, A1, C0/r, C1/r, C2/r`` of unit pressure on a disc; arguments broadcast, shape (5, ...).

    ``r >= 0`` and ``s > 0`` are the point's distance from the axis and depth, ``c > 0`` the radius.
    """
    r, s, c = np.broadcast_arrays(r, s, c)
    squared = c**2 + s**2
    near = r < _AXIS * np.sqrt(squared)
    at = np.where(near, c, r)  # any radius off the axis: replaced below
    far = (c + at) ** 2 + s**2
    close = (c - at) ** 2 + s**2
    length = np.sqrt(far)
    m, complement = 4.0 * c * at / far, close / far
    first, second = ellipkm1(complement), ellipe(m)
    # solid angle: n = 4 c r/(c + r)^2 and Pi(n|m) = RF + n/3 RJ, by Carlson
    side = (c - at) / (c + at)
    share = np.maximum(side**2, 1e-300)
    third = elliprf(0.0, complement, 1.0) + (1.0 - share) / 3.0 * elliprj(0.0, complement, 1.0, share)
    beyond = np.where(at < c, 1.0, np.where(at > c, 0.0, 0.5))
    a0 = beyond - s / (np.pi * length) * (first + np.where(at == c, 0.0, side * third))
    # int J0(kc) J0(kr) exp(-ks) dk, and the integrals of J1(kc) J1(kr) (1, k) exp(-ks)
    zeroth = 2.0 * first / (np.pi * length)
    a1 = ((squared - 2.0 * s**2 - at**2) / close * second + first) / (np.pi * length)
    c1 = length / (np.pi * at) * ((1.0 - 0.5 * m) * first - second)
    c2 = s / (np.pi * at * length) * ((1.0 - 0.5 * m) / complement * second - first)
    c0 = 0.5 * (c**2 / at * (1.0 - s * zeroth - a0) + at * a0 - s * c1)
    distance = np.sqrt(squared)
    middle = c**2 / (distance * (distance + s))  # 1 - s/distance
    bend, twist = c**2 / distance**3, s * c**2 / distance**5
    axis = [middle, bend, 0.5 * middle, 0.5 * bend, 1.5 * twist]
    general = [a0, a1, c0 / at, c1 / at, c2 / at]
    return np.stack([np.where(near, limit, value) for limit, value in zip(axis, general, strict=True)])


def punch_load(r: Array, s: Array) -> Array:
    """``A0, A1, C0/r, C1/r, C2/r`` of the unit punch at depth ``s > 0``, shape (5, n)."""
    z = s - 1j
    root = np.sqrt((r - 1.0) * (r + 1.0) + s**2 - 2j * s)
    total = root + z
    return np.stack([1.0 / root, z / root**3, 1.0 / total, 1.0 / (root * total), 1.0 / root**3]).imag
