"""State of the history at quadrature points, and what a run stores of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fem_solver.partial_release import PartlyHeld
from fem_solver.prony import RelaxingField

Array = NDArray[np.float64]


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
    partly : PartlyHeld, optional
        The node next to an adhesive edge.
    """

    unknowns: Array
    shear: RelaxingField
    volume: RelaxingField
    far: tuple[RelaxingField, RelaxingField]
    dissipated: float = 0.0
    updates: int = 0
    partly: PartlyHeld | None = None


@dataclass(frozen=True)
class LoadOfPast:
    """Load that the past leaves at the end of a step, used by the trial and again when it is accepted."""

    dt: float
    modulus: float
    ratio: float
    load: Array
    far_memory: Array
