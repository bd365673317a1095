"""What a step adds to the quadratic forms of pressure and displacement that the energies consist of.

``Y = int p v`` and ``X_k = int p e_k`` over the surface, as in ``energy``, at unit modulus.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain
from bem_solver.surface import ContactSurface

Array = NDArray[np.float64]


@dataclass(frozen=True)
class WorkIncrement:
    """What a step does to the forms: Y and X after it, and what it adds to them.

    ``across`` is ``int p v`` and ``lag_across`` (K,) ``int p l_k`` with p after the step and v, ``l_k``
    before it; ``tip`` the part of ``int dp dv`` that belongs to the moving tip.
    """

    load_work: float
    branch_work: Array
    across: float
    lag_across: Array
    tip: float


def work_increment(
    chain: Chain,
    before: ContactSurface,
    after: ContactSurface,
    variables: Array,
    load_before: Array,
    variables_before: Array,
) -> WorkIncrement:
    """Quadratic forms after a step, and what it adds to them.

    Parameters
    ----------
    chain : Chain
    before, after : ContactSurface
        Around the step.
    variables : ndarray (M + 3 k, K)
        Internal variables at the annuli of ``after`` and at the readings of its kinks, after the step.
    load_before : ndarray (M + 3 k,)
        ``v`` there before the step.
    variables_before : ndarray (M + 3 k, K)
        Internal variables there before the step.

    Returns
    -------
    WorkIncrement
    """
    lags, lags_before = (at @ chain.rotation.T * chain.lag_scale for at in (variables, variables_before))
    works = after.work_on(np.column_stack((load_before, lags, lags_before)))
    work, lag_work, lag_across = after.load_work, works[1 : 1 + len(chain)], works[1 + len(chain) :]
    intensity = 0.5 * (before.stress_intensity**2 + after.stress_intensity**2)
    return WorkIncrement(
        work,
        chain.compliances * work - lag_work,
        float(works[0]),
        lag_across,
        intensity * np.pi * abs(after.edge**2 - before.edge**2),
    )
