"""Annulus influence coefficients of the half-space (paper, Eqs. Kernel and Ghq).

Everything here is for unit plane modulus ``E* = E/(1 - nu^2) = 1``; displacement is positive downwards,
pressure positive in compression. The coefficients are scale-free: ``K(c r, c r') = c K(r, r')``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipe, ellipkm1

Array = NDArray[np.float64]


def disc_displacement(radius: ArrayLike, disc: ArrayLike) -> Array:
    """Surface displacement at ``radius`` under unit pressure on a disc of radius ``disc`` (Eq. Kernel).

    ``K(r, c) = 4 c E(r/c)/pi`` for r <= c and ``4 r [E(c/r) - (1 - (c/r)^2) K(c/r)]/pi`` outside, with the
    complete elliptic integrals of the modulus. Arguments are broadcast; zero for a disc of radius zero.
    """
    r, c = np.broadcast_arrays(np.asarray(radius, float), np.asarray(disc, float))
    outside = r > c
    large = np.where(outside, r, c)
    k = np.divide(np.where(outside, c, r), large, out=np.zeros(r.shape), where=large > 0)
    complement = (1.0 - k) * (1.0 + k)
    # (1 - k^2) K(k) -> 0 at k = 1, where K itself is infinite
    product = complement * ellipkm1(np.where(complement > 0, complement, 1.0))
    value = 4.0 / np.pi * large * (ellipe(1.0 - complement) - np.where(outside, product, 0.0))
    return np.where(c > 0, value, 0.0)


def annulus_influence(radius: Array, borders: Array) -> Array:
    """Displacement at each ``radius`` (m,) under unit pressure on each annulus (Eq. Ghq), shape (m, n).

    ``borders`` (n + 1,) rise from 0; annulus q lies between ``borders[q]`` and ``borders[q + 1]``.
    """
    return np.diff(disc_displacement(radius[:, None], borders[None, :]), axis=1)
