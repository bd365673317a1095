"""Boussinesq's displacement of a point force, prescribed on the boundary of the truncated domain.

A half-space loaded by a normal pressure of total force ``F`` within a radius ``a`` displaces a point at
distance ``rho`` like the point force ``F`` up to terms of relative size ``(a/rho)^2``: for an axisymmetric
load the dipole vanishes. Prescribing that displacement on the far boundary leaves an error of the field near
the contact of the order ``(a/rho)^3`` where clamping the boundary leaves ``a/rho``.

With depth ``s = -z``, ``rho^2 = r^2 + s^2`` and a force ``F`` pressing downwards (Johnson, Contact
Mechanics, Eq. 3.18, with ``z`` turned upwards),

    ``u_r = F/(4 pi G) [ r s/rho^3 - (1 - 2 nu) r/(rho (rho + s)) ]``
    ``u_z = -F/(4 pi G) [ s^2/rho^3 + 1/rho + (1 - 2 nu)/rho ]``

and ``(1 - 2 nu)/G = 3/(3 K + G)``: the field is ``F/G`` times a shape independent of the material, plus
``3 F/(3 K + G)`` times another. So, by the correspondence principle, it holds for every isotropic linear
viscoelastic solid, whether or not its Poisson's ratio is constant: only two scalars of time are needed,
``e_1`` with ``G * e_1 = F`` and ``e_2`` with ``(3 K + G) * e_2 = 3 F`` (hereditary integrals).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def boussinesq_shapes(points: Array) -> tuple[Array, Array]:
    """The two shapes of the field, to be scaled by ``F/G`` and ``3 F/(3 K + G)``.

    Parameters
    ----------
    points : ndarray, shape (2, n)
        ``(r, z)`` with ``z <= 0``, not the origin.

    Returns
    -------
    shear, volume : ndarray, shape (2, n)
        Displacements ``(u_r, u_z)``, one over length.
    """
    r, depth = points[0], -points[1]
    rho = np.hypot(r, depth)
    shear = np.stack([r * depth / rho**3, -(depth**2 / rho**3 + 1.0 / rho)])
    volume = np.stack([-r / (rho * (rho + depth)), -1.0 / rho])
    return shear / (4.0 * np.pi), volume / (4.0 * np.pi)
