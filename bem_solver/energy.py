"""Stored energy and branch dissipation (paper, Sec. on energy) without a double integral over the surface.

With ``Y = int p v``, ``X_k = int p e_k`` and ``W_k = int s_k e_k`` over the surface (``e_k = G s_k`` the
displacement of Voigt branch k, ``s_k`` its apparent stress), Eq. U is ``U = Y/(2 Einf*) + sum_k W_k/(2
J_k)``, and because G is symmetric ``dW_k/dt = 2 (J_k X_k - W_k)/theta_k``: one number per branch.

The branch power (Eq. dissipated energy) is ``sum_k Q_k/(J_k theta_k)``, with ``Q_k`` the same quadratic form
of the lag ``l_k = J_k v - e_k``. Over steps shorter than ``theta_k`` the power is what the branch receives,
``(J_k Y - X_k)/theta_k``, less what it stores: forms of the states alone, whose errors do not add up. Over
longer ones that is the difference of large numbers. With v linear in such a step ``l_k`` is the lag before,
decayed, and a multiple of the change of v; ``Q_k`` and its integral are then exact for any length, and never
negative. What changes at the moving tip does so at once wherever the tip is, evenly over the step: of the
form of the change of v that is ``K^2 |dA|`` at most, with K at unit modulus.

With a sharp edge the branch integral exceeds the loss of the energy balance by what the tip releases in
excess of the glassy ``K^2/(2 Einf*)``; both are reported. While such an edge moves in steps that are long for
a branch, what the branches dissipate is taken from that balance (``tip_release``): a fast branch
sees of the tip only what passes within its own time, of which forms of the states at the ends of a longer
step hold nothing. So it is of any step in which the edge rests: nothing is released there, and under a
constant or a swinging penetration the load is not linear in time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from bem_solver.creep import Chain, phi
from bem_solver.even_step import beyond_straight_lines
from bem_solver.work_increment import WorkIncrement

Array = NDArray[np.float64]

_SHORT, _LONG = 0.25, 1.0
"""Steps, in retardation times, up to which a step is short and from which it is long; a mixture between, so
that energies depend continuously on the step. Longer ones counted as short lose 1 % of the heat of a fast
branch where the load swings: what it receives bends within them."""
_LITTLE_TIP, _MOSTLY_TIP = 0.25, 0.75
"""Shares of ``int dp dv`` belonging to the moving tip, up to which it leaves a long step long and from which
that counts as short; a mixture between."""


@dataclass(frozen=True)
class Energies:
    """``load_work`` is Y; ``branch_work`` (K,) is X; ``branch_energy`` (K,) is W; ``dissipated`` the time
    integral of the branch power. ``release`` is the glassy energy release rate of the tip, opening and
    closing, with adhesion; ``tip`` the integral of it over the area that the step before has gained, NaN
    where it is not known, and ``bend`` (K,) the part of what the branches received in it that is no
    trapezoid."""

    load_work: float
    branch_work: Array
    branch_energy: Array
    dissipated: float
    release: tuple[float, float] | None = None
    tip: float = math.nan
    bend: Array = field(default_factory=lambda: np.zeros(0))

    def stored(self, chain: Chain) -> float:
        """Stored energy U."""
        branches = float(np.sum(self.branch_energy / chain.compliances))
        return 0.5 * (self.load_work / chain.glassy + branches)

    def lag_energy(self, chain: Chain) -> Array:
        """``Q`` (K,), the form of the lag: ``W + J^2 Y - 2 J X``."""
        return (
            self.branch_energy
            + chain.compliances**2 * self.load_work
            - 2.0 * chain.compliances * self.branch_work
        )

    def supply(self, chain: Chain) -> Array:
        """Power that each branch receives, ``(J_k Y - X_k)/theta_k``, shape (K,)."""
        return (chain.compliances * self.load_work - self.branch_work) / chain.retardation

    def unloaded(self) -> Energies:
        """The same without load."""
        release = None if self.release is None else (0.0, 0.0)
        return replace(self, load_work=0.0, branch_work=0.0 * self.branch_work, release=release)


def initial_energies(chain: Chain, load_work: float, relaxed: bool) -> Energies:
    """Energies of the start state: fully relaxed, or glassy with no strain in the branches."""
    share = chain.compliances * (1.0 if relaxed else 0.0)
    branch_work = share * load_work
    branch_energy = share * chain.compliances * load_work
    return Energies(load_work, branch_work, branch_energy, 0.0, bend=np.zeros(len(chain)))


def updated_energies(chain: Chain, before: Energies, increment: WorkIncrement, duration: float) -> Energies:
    """Energies after a step, short or long compared with the retardation time of each branch.

    Parameters
    ----------
    chain : Chain
    before : Energies
    increment : WorkIncrement
    duration : float

    Returns
    -------
    Energies

    Notes
    -----
    A step counts as short, too, if most of what changes in it changes at the tip: all that is in the states.
    """
    y = duration / chain.retardation
    long = _share_of_long(y, increment, before)
    energy, lost, received = _short(chain, before, increment, y)
    if long.any():
        other = _long(chain, before, increment, y)
        energy, lost = (
            (1.0 - long) * one + long * two for one, two in zip((energy, lost), other, strict=True)
        )
    return Energies(
        increment.load_work,
        increment.branch_work,
        energy,
        before.dissipated + float(np.sum(lost)),
        bend=(1.0 - long) * received,
    )


def share_of_balance(durations: Array, shortest: float) -> Array:
    """Share of that in what the branches dissipate, by the length of the steps.

    Parameters
    ----------
    durations : ndarray (n,)
        Of the steps.
    shortest : float
        Of the relaxation times.

    Returns
    -------
    ndarray (n,)
        0 where a step is short for every branch: forms of the states, whose errors do not add up, hold all
        that the branches see of the tip. 1 where it is long for the fastest.
    """
    return _rising(durations / shortest)


def _rising(y: Array) -> Array:
    """0 up to ``_SHORT`` retardation times, 1 from ``_LONG`` on."""
    return np.minimum(np.log(np.maximum(y, _SHORT) / _SHORT) / np.log(_LONG / _SHORT), 1.0)


def _share_of_long(y: Array, increment: WorkIncrement, before: Energies) -> Array:
    """Weight of the long step's energies, 0 to 1 (K,)."""
    total = increment.load_work + before.load_work - 2.0 * increment.across
    tip = increment.tip / max(total, increment.tip) if increment.tip > 0.0 else 0.0
    rest = (_MOSTLY_TIP - tip) / (_MOSTLY_TIP - _LITTLE_TIP)
    return _rising(y) * min(max(rest, 0.0), 1.0)


def _short(chain: Chain, before: Energies, increment: WorkIncrement, y: Array) -> tuple[Array, Array, Array]:
    """W after a step with X nearly linear, what turned into heat if it is shorter than the branch's time.

    The last (K,) is the part of that heat by which what the branch receives exceeds the trapezoid.
    """
    received, stored = _beyond(chain, before, increment, y)
    energy = short = _energy_under_linear_work(chain, before, increment, y) + chain.compliances * stored
    if (y > _LONG).any():
        y = np.minimum(y, _LONG)
        received, stored = _beyond(chain, before, increment, y)
        short = _energy_under_linear_work(chain, before, increment, y) + chain.compliances * stored
    # work done on the branch, int (J Y - X)/theta dt
    lag = chain.compliances * (increment.load_work + before.load_work) - (
        increment.branch_work + before.branch_work
    )
    lost = 0.5 * y * lag + received - 0.5 * (short - before.branch_energy) / chain.compliances
    return energy, lost, received


def _beyond(chain: Chain, before: Energies, increment: WorkIncrement, y: Array) -> tuple[Array, Array]:
    """Supply and energy beyond those under straight lines, for a load that changes evenly.

    Of the part that does not move on with the tip as it is: where the stress behind an advancing edge relaxes
    in a layer thinner than the travel that is nearly all of the load, and all lines are straight.
    """
    lag = chain.compliances * before.load_work - before.branch_work
    total = max(increment.load_work + before.load_work - 2.0 * increment.across, 0.0)
    tip = min(increment.tip, total)
    gained = increment.across - before.load_work
    both = increment.load_work + before.load_work
    stays = max(1.0 - increment.tip / both, 0.0) if increment.tip > 0.0 else 1.0
    received, stored = beyond_straight_lines(
        lag, increment.lag_across - lag, gained, total - tip, tip, chain.compliances, y
    )
    return stays * received, stays * stored


def _energy_under_linear_work(chain: Chain, before: Energies, increment: WorkIncrement, y: Array) -> Array:
    decay, spread = np.exp(-2.0 * y), phi(2.0 * y)
    return decay * before.branch_energy + chain.compliances * (
        increment.branch_work * (1.0 - spread) + before.branch_work * (spread - decay)
    )


def _long(chain: Chain, before: Energies, increment: WorkIncrement, y: Array) -> tuple[Array, Array]:
    """The same for a longer step, v linear but for the tip."""
    compliances = chain.compliances
    decay, spread, twice = np.exp(-y), phi(y), phi(2.0 * y)
    total = max(increment.load_work + before.load_work - 2.0 * increment.across, 0.0)  # int dp dv
    tip = min(increment.tip, total)
    lag = np.maximum(before.lag_energy(chain), 0.0)
    mixed = compliances * (increment.lag_across - compliances * before.load_work + before.branch_work)
    most = compliances * np.sqrt(lag * total)
    mixed = np.minimum(np.maximum(mixed, -most), most)
    driven = compliances**2 * (total - tip)
    after = decay**2 * lag + 2.0 * mixed * decay * spread + driven * spread**2 + compliances**2 * tip * twice
    lost = 0.5 * (1.0 - decay**2) * lag + mixed * y * spread**2 + driven * _mean_square_rise(y)
    lost = lost / compliances + 0.5 * compliances * tip * (1.0 - twice)
    return np.maximum(
        after, 0.0
    ) - compliances**2 * increment.load_work + 2.0 * compliances * increment.branch_work, lost


def _mean_square_rise(y: Array) -> Array:
    """``(1/y^2) int_0^y (1 - exp(-x))^2 dx``."""
    small = y / 3.0 - y**2 / 4.0 + 7.0 * y**3 / 60.0 - y**4 / 24.0
    safe = np.maximum(y, 0.01)
    arrived = -np.expm1(-safe)
    return np.where(y < 0.02, small, (safe - arrived - 0.5 * arrived**2) / safe**2)
