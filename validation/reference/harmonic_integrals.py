"""Repeated integrals of the half-space's harmonic functions at a complex depth.

Every axisymmetric load is a sum of ``cos(k x)`` (see :mod:`validation.reference.subsurface`), and
``exp(-k s) cos(k x) = Re exp(-k Z)`` with the complex depth ``Z = s + i x``. With ``R^2 = r^2 + Z^2``,
``Re R > 0``, the Laplace transforms of the Bessel functions form two ladders,

    T_n = int_0^inf k^-n exp(-k Z) J0(k r) dk,    S_n = int_0^inf k^-n exp(-k Z) J1(k r) dk,

    T_-1 = Z/R^3,  T_0 = 1/R,  T_1 = -L,  T_2 = Z L - R,  T_3 = 3 Z R/4 - (Z^2/2 - r^2/4) L,
    S_-1/r = 1/R^3,  S_0/r = 1/(R (R + Z)),  S_1/r = 1/(R + Z),  S_2/r = -[L + Z/(R + Z)]/2,
    S_3/r = [Z L - R + (R^2 + R Z + Z^2)/(3 (R + Z))]/2,    L = log(R + Z).

From ``n = 1`` (``n = 2``) on the integrals diverge at ``k = 0``; the functions given are the ones with
``dT_n/dZ = -T_(n-1)``, ``dS_n/dZ = -S_(n-1)``, and what they leave open drops out between two ends of a load.
Nothing is subtracted as ``r -> 0``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


def ladders(r: Array, depth: Array, x: float) -> tuple[list[Complex], list[Complex]]:
    """``[T_-1 .. T_3]`` and ``[S_-1/r .. S_3/r]`` at ``depth + i x``.

    Parameters
    ----------
    r, depth : ndarray, shape (...)
        Distance from the axis, >= 0, and depth, > 0.
    x : float
        Imaginary part of the complex depth, >= 0.

    Returns
    -------
    two lists of five complex arrays of shape (...)
    """
    z = depth + 1j * x
    # not r^2 + Z^2, which loses the distance from the circle r = x
    root = np.sqrt((r - x) * (r + x) + depth**2 + 2j * depth * x)
    total = root + z
    log = np.log(total)
    even = [
        z / root**3,
        1.0 / root,
        -log,
        z * log - root,
        0.75 * z * root - (0.5 * z**2 - 0.25 * r**2) * log,
    ]
    odd = [
        1.0 / root**3,
        1.0 / (root * total),
        1.0 / total,
        -0.5 * (log + z / total),
        0.5 * (z * log - root + (root**2 + root * z + z**2) / (3.0 * total)),
    ]
    return even, odd
