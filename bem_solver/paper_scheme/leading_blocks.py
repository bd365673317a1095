"""LU factors without row exchanges: one factorisation serves every leading block of a matrix.

With ``K = L U``, for every n ``K[:n, :n] = L[:n, :n] U[:n, :n]`` and ``K[n:, :n] = L[n:, :n] U[:n, :n]``. So
``y = L^-1 b`` holds the forward solutions of *all* leading blocks, and ``K[n:, :n] K[:n, :n]^-1 b[:n]`` is
``L[n:, :n] y[:n]``, without a backward solution.

Doing without pivoting is safe for the influence matrix of uniform annuli: from 10 to 2000 annuli every
multiplier stays below 0.58 and every pivot between 1.7 and 2 annulus widths, so partial pivoting would
exchange no rows. The matrix is nearly a symmetric positive definite kernel times the areas of the annuli, and
each leading block is the influence matrix of a smaller contact. That no rows are exchanged is checked.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular
from scipy.linalg.blas import dtpsv
from scipy.linalg.lapack import dgetrf

Array = NDArray[np.float64]


def _packed(triangle: Array) -> Array:
    """Rows of a lower triangle one after another: storage of which every leading block is a prefix."""
    return np.concatenate([triangle[j, : j + 1] for j in range(len(triangle))])


class LeadingBlocks:
    """Factors of a matrix (N, N), for solutions with any leading block.

    Parameters
    ----------
    matrix : ndarray (N, N)

    Attributes
    ----------
    factors : ndarray (N, N)
        ``L`` (unit diagonal, not stored) below the diagonal, ``U`` on and above it.

    Raises
    ------
    ArithmeticError
        If the matrix is singular or needs row exchanges.
    """

    def __init__(self, matrix: Array) -> None:
        factors, rows, info = dgetrf(matrix)
        if info or np.any(rows != np.arange(len(rows))):
            raise ArithmeticError("the matrix cannot be factorised without exchanging rows")
        self.factors = np.ascontiguousarray(factors)
        self._lower = _packed(self.factors)
        self._upper = _packed(self.factors.T)

    def forward(self, values: Array) -> Array:
        """``L^-1 b`` for b (n,), any n <= N."""
        return dtpsv(len(values), self._lower, values, trans=1, diag=1)

    def backward(self, values: Array) -> Array:
        """``U^-1 y`` for y (n,): the solution with the leading block of that size."""
        return dtpsv(len(values), self._upper, values)

    def adjoint(self, values: Array) -> Array:
        """``U^-T c`` for c (n,): ``c[:m] @ K[:m, :m]^-1 b[:m]`` is ``(U^-T c)[:m] @ (L^-1 b)[:m]``."""
        return dtpsv(len(values), self._upper, values, trans=1)

    def last(self, forward: Array, count: int) -> Array:
        """The last ``count`` entries of ``U^-1 y`` for y (n,)."""
        n = len(forward)
        corner = self.factors[n - count : n, n - count : n]
        return solve_triangular(corner, forward[n - count :], check_finite=False)

    def beyond(self, forward: Array, end: int) -> Array:
        """Rows n to ``end`` of ``K[:, :n] K[:n, :n]^-1 b`` from ``y = L^-1 b`` (n,)."""
        n = len(forward)
        return self.factors[n:end, :n] @ forward
