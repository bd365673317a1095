"""Stored energy and branch dissipation (paper, Sec. on energy) without a double integral over the surface.

With ``Y = int p v``, ``X_k = int p e_k`` and ``W_k = int s_k e_k`` over the surface (``e_k = G s_k`` the
displacement of Voigt branch k, ``s_k`` its apparent stress), Eq. U is ``U = Y/(2 Einf*) + sum_k W_k/(2
J_k)``. Because G is symmetric, ``dW_k/dt = 2 (J_k X_k - W_k)/theta_k``: one number per branch, by the same
exact recursion as the branch itself. The branch power (Eq. dissipated energy) is ``P_k = (J_k Y -
X_k)/theta_k - dU_k/dt``. With a sharp edge that integral exceeds the loss of the energy balance by what the
tip releases in excess of the glassy ``K^2/(2 Einf*)``; both are reported.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bem_solver.annuli import Annuli
from bem_solver.creep import Chain

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Energies:
    """``load_work`` is Y; ``branch_work`` (K,) is X; ``branch_energy`` (K,) is W; ``dissipated`` the time
    integral of the branch power."""

    load_work: float
    branch_work: Array
    branch_energy: Array
    dissipated: float

    def stored(self, chain: Chain) -> float:
        """Stored energy U."""
        branches = float(np.sum(self.branch_energy / chain.compliances))
        return 0.5 * (self.load_work / chain.glassy + branches)

    def unloaded(self) -> Energies:
        """Without load, nothing else changed."""
        return Energies(0.0, 0.0 * self.branch_work, self.branch_energy, self.dissipated)


def surface_work(
    annuli: Annuli, chain: Chain, edge: float, scaled: Array, variables: Array
) -> tuple[float, Array]:
    """``Y`` and ``X_k`` of a contact with scaled pressures (M,) and variables (M, K) at the annuli."""
    forces = edge * annuli.areas * scaled
    load = annuli.matrix @ scaled
    work = float(forces @ load)
    lags = (variables @ chain.rotation.T) * chain.lag_scale
    return work, chain.compliances * work - forces @ lags


def at_start(chain: Chain, load_work: float, relaxed: bool) -> Energies:
    """Energies of the start state: fully relaxed, or glassy with nothing in the branches yet."""
    share = chain.compliances * (1.0 if relaxed else 0.0)
    return Energies(load_work, share * load_work, share * chain.compliances * load_work, 0.0)


def stepped(
    chain: Chain, before: Energies, load_work: float, branch_work: Array, duration: float
) -> Energies:
    """Energies after a step over which X varies linearly."""
    y = 2.0 * duration / chain.retardation
    decay, spread = chain.decay(y), chain.spread(y)
    energy = decay * before.branch_energy + chain.compliances * (
        branch_work * (1.0 - spread) + before.branch_work * (spread - decay)
    )
    # work done on branch k: int (J_k Y - X_k)/theta_k dt, by the trapezoid
    lag = chain.compliances * (load_work + before.load_work) - (branch_work + before.branch_work)
    received = 0.5 * duration * lag / chain.retardation
    gained = 0.5 * (energy - before.branch_energy) / chain.compliances
    return Energies(load_work, branch_work, energy, before.dissipated + float(np.sum(received - gained)))
