"""Potentials in the half-space under a uniformly loaded disc and under a flat punch.

For a load ``p(r) = int P(k) J0(k r) k dk`` the stress at depth s follows from

    A0, A1 = int P (k, k^2) exp(-k s) J0(k r) dk,      C0, C1, C2 = int P (1, k, k^2) exp(-k s) J1(k r) dk

(see ``subsurface``). A disc of radius c under unit pressure has ``P = c J1(k c)/k``: the Lipschitz-Hankel
integrals of G. Eason, B. Noble, I.N. Sneddon, Phil. Trans. R. Soc. A 247, 529 (1955), in complete elliptic
integrals of the parameter ``m = 4 c r/((c + r)^2 + s^2)``. ``A0`` is the solid angle of the disc over 2 pi;
``C0`` follows from the others, being homogeneous of degree one in ``(c, r, s)``. The punch of unit radius and
pressure ``1/sqrt(1 - r^2)`` has ``P = sin(k)/k``, the imaginary part of exponentials of the depth ``s - i``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipe, ellipkm1, elliprf, elliprj

Array = NDArray[np.float64]

_AXIS = 1e-4
"""Distance from the axis, relative to that from the rim, below which the limits on the axis are used."""


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
