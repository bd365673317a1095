"""Internal variables of a relaxing modulus, updated exactly for strains that are linear in time.

A modulus ``m(t) = m_0 + sum_k m_k exp(-t/tau_k)`` acts on a strain-like quantity ``x`` (a number, a surface
vector, a field at quadrature points: all alike) as

    ``s = m_0 x + sum_k b_k``,   ``b_k' = -b_k/tau_k + m_k x'``.

Over a step ``dt`` in which ``x`` is linear in time, exactly,

    ``b_k <- exp(-y_k) b_k + m_k phi(y_k) dx``,   ``y_k = dt/tau_k``,   ``phi(y) = (1 - exp(-y))/y``,

so ``s = m_hat x + memory`` with the algorithmic modulus ``m_hat = m_0 + sum_k m_k phi(y_k)``. The formulas
hold from ``dt = 0`` (the glassy jump) to ``dt = inf`` (fully relaxed).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SHORT = 1e-4
"""Time, relative to a relaxation or retardation time, below which a series replaces a difference of nearly
equal numbers; the error of both is below 1e-11."""


def phi(y: Array) -> Array:
    """``(1 - exp(-y))/y`` with ``phi(0) = 1`` and ``phi(inf) = 0``."""
    with np.errstate(invalid="ignore"):
        return np.where(y > 0.0, -np.expm1(-y) / np.where(y > 0.0, y, 1.0), 1.0)


def mean_phi(y: Array) -> Array:
    """``(1 - phi(y))/y``, the mean over a time of the mean so far of what decays; 1/2 at 0."""
    return np.where(y > _SHORT, (1.0 - phi(y)) / np.where(y > _SHORT, y, 1.0), 0.5 - y / 6.0 + y**2 / 24.0)


@dataclass(frozen=True)
class Increment:
    """Coefficients of one step; ``decay`` and ``gain`` have shape (branches,)."""

    modulus: float
    decay: Array
    gain: Array

    def memory(self, branches: Array, x: Array | float) -> Array:
        """Part of the new stress that the old state determines: ``sum_k decay_k b_k - gain_k x``.

        ``branches`` has shape (branches,) or (branches, m), ``x`` the shape of one of them.
        """
        return self.decay @ branches - self.gain.sum() * np.asarray(x)

    def advance(self, branches: Array, dx: Array | float) -> Array:
        """Branch variables at the end of the step."""
        shape = (-1, *(1,) * (branches.ndim - 1))
        return self.decay.reshape(shape) * branches + self.gain.reshape(shape) * np.asarray(dx)


@dataclass(frozen=True)
class Prony:
    """Relaxing modulus; ``moduli`` and ``times`` have shape (branches,)."""

    relaxed: float
    moduli: Array
    times: Array

    @property
    def glassy(self) -> float:
        """``m(0)``."""
        return self.relaxed + float(self.moduli.sum())

    def scaled(self, factor: float) -> Prony:
        """The modulus times a number."""
        return Prony(self.relaxed * factor, self.moduli * factor, self.times)

    def plus(self, other: Prony) -> Prony:
        """Sum of two moduli, branches side by side."""
        moduli, times = np.append(self.moduli, other.moduli), np.append(self.times, other.times)
        return Prony(self.relaxed + other.relaxed, moduli, times)

    def increment(self, dt: float) -> Increment:
        """Coefficients of a step ``0 <= dt <= inf``."""
        y = dt / self.times
        gain = self.moduli * phi(y)
        return Increment(self.relaxed + float(gain.sum()), np.exp(-y), gain)

    def loss_weights(self, dt: float) -> Array:
        """Weights of the energy dissipated in each branch over a step, shape (3, branches).

        A Maxwell branch of stored energy ``Q(b, b)/2`` dissipates ``Q(b, b)/tau``. With
        ``b(t) = exp(-t/tau) b_0 + m tau/dt (1 - exp(-t/tau)) dx`` the loss over the step is
        ``w_0 Q(b_0, b_0) + w_1 Q(b_0, m dx) + w_2 Q(m dx, m dx)``; these are the weights.
        """
        y = dt / self.times
        one, two = phi(y), phi(2.0 * y)
        with np.errstate(invalid="ignore", divide="ignore"):
            curved = np.where(y < 1e-3, y / 3.0 - y**2 / 4.0, (1.0 - 2.0 * one + two) / y)
        return np.stack([y * two, 2.0 * (one - two), curved])

    def mean_loss_weights(self, dt: float) -> Array:
        """Means of :meth:`loss_weights` over durations from 0 to ``dt``, with ``dx`` in proportion to them.

        They belong to parts of a whole that take the strain for evenly distributed durations; shape
        (3, branches), for the ``dx`` of the longest.
        """
        y = dt / self.times
        one, two = mean_phi(y), mean_phi(2.0 * y)
        with np.errstate(invalid="ignore", divide="ignore"):
            curved = np.where(y < 1e-3, y / 12.0 - y**2 / 20.0, (0.5 - 2.0 * one + two) / y)
        return np.stack([y * two, 2.0 * (one - two), curved])


@dataclass(frozen=True)
class RelaxingField:
    """A relaxing modulus with the strain it acts on and its branch variables.

    Parameters
    ----------
    modulus : Prony
    x : ndarray, shape (m,)
        A strain-like quantity.
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

    def chosen(self, entries: NDArray[np.int64] | NDArray[np.bool_] | slice) -> RelaxingField:
        """Some entries, or some of them twice; copies but for a slice."""
        return RelaxingField(self.modulus, self.x[entries], self.branches[:, entries])
