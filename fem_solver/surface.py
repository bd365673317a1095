"""Surface compliance in triangular form: one factorisation serves every contact radius.

The compliance ``C`` of the surface nodes, ordered by radius, is factorised once, ``C = L L^T``. Contact of
the nodes ``0..m`` at prescribed displacement ``b`` asks for ``C_mm f = b``. With ``y = L^-1 b``, one
triangular solve for *all* m at once,

- the nodal forces are ``f = L_mm^-T y_m``: near the edge they need a small trailing block of ``L`` only;
- the displacement outside is ``L_om y_m``;
- the total force is ``sum_i e_i y_i`` with ``e = L^-1 1``: component i is what node i adds.

``L^-1`` is what the Abel transform is to the continuous half-space: ``y_i/e_i`` is the penetration of the
flat punch reaching to node i that would leave there the same stress singularity; it vanishes where an
adhesionless contact ends.

A set of nodes has no radius of its own. It is assigned that of the flat punch of the same stiffness,
``F = 2 E* A D``, i.e. ``A_m = sum_(i<=m) e_i^2/(2 E*)``, which exceeds the radius of the last node by about a
tenth of an element, differently for vertices and mid-side nodes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky
from scipy.linalg.lapack import dtrtrs

Array = NDArray[np.float64]


class SurfaceOperator:
    """Cholesky factor of the surface compliance for unit shear modulus.

    Parameters
    ----------
    compliance : ndarray, shape (n, n)
        Displacement per nodal force, nodes by rising radius; symmetric and positive definite.
    """

    def __init__(self, compliance: Array) -> None:
        self.compliance = compliance
        self.rows: Array = cholesky(compliance, lower=True)
        self._columns = np.asfortranarray(self.rows)
        self.unit = self.transform(np.ones(len(compliance)))
        self.stiffness = np.cumsum(self.unit**2)

    def transform(self, displacement: Array) -> Array:
        """``y = L^-1 b``."""
        return dtrtrs(self._columns, displacement, lower=1)[0]

    def forces(self, y: Array) -> Array:
        """``L^-T y``; entries beyond the last non-zero of ``y`` are zero."""
        return dtrtrs(self._columns, y, lower=1, trans=1)[0]

    def last_forces(self, y: Array, first: int) -> Array:
        """``L^-T y`` for the entries ``first..len(y)-1`` of a vector that ends there."""
        block = self._columns[first : len(y), first : len(y)]
        return dtrtrs(block, y[first:], lower=1, trans=1)[0]

    def effective_radii(self, plane_modulus: float) -> Array:
        """Radius of the flat punch as stiff as contact of the nodes ``0..m``, for every m.

        ``plane_modulus`` is ``E*`` at unit shear modulus.
        """
        return self.stiffness / (2.0 * plane_modulus)

    def transform_radii(self, radii: Array) -> Array:
        """Radius at which each transformed component sits, read from a paraboloid.

        A punch of height ``r^2`` has the transform ``2 x^2``.
        """
        return np.sqrt(np.maximum(0.5 * self.transform(radii**2) / self.unit, 0.0))
