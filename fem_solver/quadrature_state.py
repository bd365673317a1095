"""State of the history at quadrature points: relaxing fields, and what a run stores of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.prony import Prony

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RelaxingField:
    """A relaxing modulus with the strain it acts on and its branch variables.

    Parameters
    ----------
    modulus : Prony
    x : ndarray, shape (m,)
        A strain field and, behind it, the two amplitudes of the far field.
    branches : ndarray, shape (branches, m)
    """

    modulus: Prony
    x: Array
    branches: Array

    @classmethod
    def at_rest(cls, modulus: Prony, size: int) -> RelaxingField:
        """Undeformed."""
        return cls(modulus, np.zeros(size), np.zeros((len(modulus.times), size)))

    def memory(self, dt: float) -> Array:
        """Stress that the past leaves at the end of a step."""
        return self.modulus.increment(dt).memory(self.branches, self.x)

    def advanced(self, dt: float, x: Array) -> RelaxingField:
        """State at the end of a step."""
        return RelaxingField(self.modulus, x, self.modulus.increment(dt).advance(self.branches, x - self.x))


@dataclass(frozen=True)
class QuadratureState:
    """Internal variables in the volume.

    Parameters
    ----------
    unknowns : ndarray, shape (unknowns,)
        Displacement and, in the mixed form, pressure.
    shear, volume : RelaxingField
    far : tuple of RelaxingField
        The two amplitudes of the far field.
    dissipated : float
        Energy dissipated in the branches so far.
    updates : int
        Accepted steps so far.
    """

    unknowns: Array
    shear: RelaxingField
    volume: RelaxingField
    far: tuple[RelaxingField, RelaxingField]
    dissipated: float = 0.0
    updates: int = 0


@dataclass(frozen=True)
class QuadratureSnapshot:
    """Serialisable state of the history, with the work done.

    ``solves`` are the back-substitutions by ratio of moduli, in the order in which these were factorised.
    """

    state: QuadratureState
    solves: dict[float, int]


@dataclass(frozen=True)
class LoadOfPast:
    """Load that the past leaves at the end of a step, used by the trial and again when it is accepted."""

    dt: float
    modulus: float
    ratio: float
    load: Array
    far_memory: Array
