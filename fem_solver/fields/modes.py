"""Energy dissipated over many steps as a sum over few vectors.

Over a step a branch loses ``w_0 Q(b, b)/m + w_1 Q(b, dx) + w_2 m Q(dx, dx)`` (``Prony.loss_weights``), a
quadratic form that is not negative, so a sum of two squares:

    ``Q(v_1) + Q(v_2)``,  ``v_1 = sqrt(w_0/m) (b + w_1 m/(2 w_0) dx)``,
    ``v_2 = sqrt(m (w_2 - w_1^2/(4 w_0))) dx``.

``Q`` may be evaluated anywhere in the body; all its values follow from the Gram sum ``sum_i v_i v_i^T`` of
surface vectors. Written in its eigenvectors with respect to the energy ``v^T C v`` of the whole body, that
sum is cut where what is left out is a share ``CUT`` of the energy, which then bounds the loss density left
out anywhere, summed over the body.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CUT = 1e-8
"""Energy left out by the truncation, relative to the energy of all vectors."""
_BLOCK = 256
"""Vectors added between two truncations; bounds the memory."""


class LossModes:
    """Sums the losses of steps and represents them by few vectors.

    Parameters
    ----------
    root : ndarray, shape (n, n)
        ``L`` of the compliance ``C = L L^T``.
    """

    def __init__(self, root: Array) -> None:
        self._root = root
        self._vectors: list[Array] = []
        self._full = _BLOCK

    def add(self, weights: Array, modulus: float, branch: Array, change: Array) -> None:
        """Add one step of a branch.

        Parameters
        ----------
        weights : ndarray, shape (3,)
            Of ``Prony.loss_weights`` for the branch.
        modulus : float
        branch : ndarray, shape (n,)
            Branch variable at the start of the step.
        change : ndarray, shape (n,)
            Of the surface vector ``w`` over the step.
        """
        first, second, third = weights
        mixed = second / (2.0 * first)
        rest = max(third - second * mixed / 2.0, 0.0)
        self._vectors.append(np.sqrt(first / modulus) * (branch + mixed * modulus * change))
        self._vectors.append(np.sqrt(rest * modulus) * change)
        if len(self._vectors) >= self._full:
            self._truncate()

    def take(self) -> Array:
        """The vectors so far, shape (k, n); the sum starts again from zero."""
        if self._vectors:
            self._truncate()
        vectors = np.array(self._vectors).reshape(len(self._vectors), len(self._root))
        self._vectors, self._full = [], _BLOCK
        return vectors

    def _truncate(self) -> None:
        vectors = np.array(self._vectors)
        scaled = vectors @ self._root
        energies, modes = np.linalg.eigh(scaled @ scaled.T)
        left_out = np.cumsum(np.maximum(energies, 0.0))
        leading = modes[:, left_out > CUT * left_out[-1]]
        self._vectors = list(leading.T @ vectors)
        self._full = len(self._vectors) + _BLOCK
