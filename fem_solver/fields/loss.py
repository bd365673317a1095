"""Energy per volume that the branches have lost so far, carried along as the mesh moves.

Over a step a branch loses ``m (w_0 q(s, s) + w_1 q(s, dx) + w_2 q(dx, dx))`` (``Prony.loss_weights``), with
its spring at the begin, ``s``, the change ``dx`` of the whole, and the form ``q`` of which ``m q/2`` is the
energy of the spring. That is not negative, so a sum of two squares,

    ``m q(v_1, v_1) + m q(v_2, v_2)``,   ``v_1 = sqrt(w_0) (s + w_1/(2 w_0) dx)``,
    ``v_2 = sqrt(w_2 - w_1^2/(4 w_0)) dx``.

All of it is linear in the components of the surface, and as long as the mesh stays the densities everywhere
follow from the Gram sum of the components of ``v_1`` and ``v_2``. In components the energy of the whole body
is the sum of squares: that sum is cut where what is left out is a share ``CUT`` of the energy, which bounds
the density left out anywhere, summed over the body. So a run takes few back-substitutions, whatever its rows.

Where the mesh moves on, what was lost is projected onto the mesh at its new place (``Recovery.taken_over``).
Its energy remains; it is known as finely as the meshes have been since it was lost.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fem_solver.fields.body import Body, Springs
from fem_solver.placement import Placement
from fem_solver.prony import Prony
from fem_solver.state import ComponentState

Array = NDArray[np.float64]

CUT = 1e-8
"""Energy left out by the truncation, relative to the energy of all vectors."""
_BLOCK = 256
"""Vectors added between two truncations; bounds the memory."""


class Losses:
    """Losses of the steps on one mesh, a branch each as few components of the surface.

    Parameters
    ----------
    springs : Springs
    """

    def __init__(self, springs: Springs) -> None:
        self._springs = springs
        times = springs.times
        self._law = Prony(0.0, np.ones_like(times), times)
        self._vectors: list[list[Array]] = [[] for _ in times]
        self._full = _BLOCK

    def add(self, dt: float, begin: ComponentState, end: ComponentState) -> None:
        """Add a step, both ends of which are on this mesh."""
        if not 0.0 < dt < np.inf:
            return
        before, springs = self._springs.components(begin.components, begin.branches)
        change = self._springs.components(end.components, end.branches)[0] - before
        weights = self._law.loss_weights(dt).T
        for spring, (first, second, third), vectors in zip(springs, weights, self._vectors, strict=True):
            mixed = second / (2.0 * first)
            vectors.append(np.sqrt(first) * (spring + mixed * change))
            vectors.append(np.sqrt(max(third - 0.5 * second * mixed, 0.0)) * change)
        if any(len(vectors) >= self._full for vectors in self._vectors):
            self._vectors = [_leading(vectors) for vectors in self._vectors]
            self._full = max(map(len, self._vectors)) + _BLOCK

    def density(self, body: Body, here: Placement) -> Array:
        """Densities of all added; shape (branches, points)."""
        lost = np.zeros((len(self._vectors), body.points))
        for k, (spring, vectors) in enumerate(zip(self._springs.branches, self._vectors, strict=True)):
            for vector in _leading(vectors):
                lost[k] += 2.0 * body.energy(spring, body.strained(vector, here))
        return lost


def _leading(vectors: list[Array]) -> list[Array]:
    """Few vectors with the same Gram sum."""
    if not vectors:
        return []
    rows = np.array(vectors)
    flat = rows.reshape(len(rows), -1)
    energies, modes = np.linalg.eigh(flat @ flat.T)
    left_out = np.cumsum(np.maximum(energies, 0.0))
    leading = modes[:, left_out > CUT * left_out[-1]]
    return list((leading.T @ flat).reshape(-1, *rows.shape[1:]))
