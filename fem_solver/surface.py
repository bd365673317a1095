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
from scipy.linalg.blas import dsymv
from scipy.linalg.lapack import dpotrf, dtrtrs

Array = NDArray[np.float64]


class SurfaceOperator:
    """Surface compliance for unit shear modulus, and its Cholesky factor.

    Both live in one matrix: the factor in its lower triangle with the diagonal, the compliance above it.

    Parameters
    ----------
    compliance : ndarray, shape (n, n)
        Displacement per nodal force, nodes by rising radius; symmetric and positive definite. It is
        overwritten if it is in Fortran's order.
    """

    def __init__(self, compliance: Array) -> None:
        diagonal = compliance.diagonal().copy()
        self._matrix, failed = dpotrf(compliance, lower=1, clean=0, overwrite_a=1)
        if failed:
            raise ArithmeticError("the compliance of the surface is not positive definite")
        self._excess = diagonal - self._matrix.diagonal()
        self.unit = self.transform(np.ones(len(compliance)))
        self.stiffness = np.cumsum(self.unit**2)

    def displacement(self, forces: Array) -> Array:
        """``C f``; shape (n,)."""
        return dsymv(1.0, self._matrix, forces) + self._excess * forces

    def transform(self, displacement: Array) -> Array:
        """``y = L^-1 b``."""
        return dtrtrs(self._matrix, displacement, lower=1)[0]

    def forces(self, y: Array) -> Array:
        """``L^-T y``; entries beyond the last non-zero of ``y`` are zero."""
        return dtrtrs(self._matrix, y, lower=1, trans=1)[0]

    def last_forces(self, y: Array, first: int) -> Array:
        """``L^-T y`` for the entries ``first..len(y)-1`` of a vector, or of columns, that end there."""
        block = self._matrix[first : len(y), first : len(y)]
        return dtrtrs(block, y[first:], lower=1, trans=1)[0]

    def displacement_beyond(self, y: Array, end: int) -> Array:
        """``L y`` for the entries ``len(y)-1..end-1``: the displacement at the last node and beyond it.

        ``y`` is a vector or has several columns.
        """
        return self._matrix[len(y) - 1 : end, : len(y)] @ y

    def component(self, forces: Array, node: int) -> float:
        """``(L^T f)_node``."""
        return float(self._matrix[node:, node] @ forces[node:])

    def root(self) -> Array:
        """``L``; shape (n, n)."""
        return np.tril(self._matrix)

    def effective_radii(self, plane_modulus: float) -> Array:
        """Radius of the flat punch as stiff as contact of the nodes ``0..m``, for every m.

        ``plane_modulus`` is ``E*`` at unit shear modulus.
        """
        return self.stiffness / (2.0 * plane_modulus)

    def transform_radii(self, radii: Array) -> Array:
        """Radius at which each transformed component sits, read from a paraboloid.

        A punch of height ``r^2`` has the transform ``2 x^2``. Radii that elements of some 1e-9 of them leave
        within rounding of each other are put in order.
        """
        return np.sort(np.sqrt(np.maximum(0.5 * self.elastic_depths(radii**2), 0.0)))

    def elastic_depths(self, height: Array) -> Array:
        """Penetration at which contact with this height ends at each node, without adhesion."""
        return self.transform(height) / self.unit
