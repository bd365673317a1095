"""Penetration during one step, and its convolution with the relaxation of a branch in contact.

``D(s) = D0 + jump + c1 s + c2 s^2 + c3 s^3`` for ``0 < s <= duration``; the jump happens at the very start,
against the glassy modulus. A branch in contact from ``s`` to the end of the step gains
``E_k int_s^h exp(-(h - s')/tau_k) D'(s') ds'``, exact for this cubic:

    int_0^h exp(-(h-u)/tau) u^m du = m! h^(m+1) phi_(m+1)(h/tau).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


SMALL = 0.2
"""Argument below which ``phi_3`` is taken from its series: ten terms then reach double precision."""
_SERIES = [(-1.0) ** j / math.factorial(j + 3) for j in range(9, -1, -1)]


def phi(y: Array) -> tuple[Array, Array, Array]:
    """``phi_m(y) = int_0^1 exp(-y (1 - v)) v^(m-1)/(m-1)! dv`` for m = 1, 2, 3 and ``y >= 0``."""
    small = y < SMALL
    if small.all():
        return _from_series(y)
    z = np.where(small, 1.0, y)
    one = -np.expm1(-z) / z
    two = (1.0 - one) / z
    direct = (one, two, (0.5 - two) / z)
    if not small.any():
        return direct
    series = _from_series(np.where(small, y, 0.0))
    one, two, three = (np.where(small, s, d) for s, d in zip(series, direct, strict=True))
    return one, two, three


def _from_series(y: Array) -> tuple[Array, Array, Array]:
    """By Horner's rule, then downwards: no difference of nearly equal numbers."""
    three = np.full_like(y, _SERIES[0])
    for coefficient in _SERIES[1:]:
        three = three * y + coefficient
    two = 0.5 - y * three
    return 1.0 - y * two, two, three


@dataclass(frozen=True)
class PenetrationPath:
    """Penetration during one step; ``rates = (c1, c2, c3)``."""

    duration: float
    start: float
    jump: float
    rates: tuple[float, float, float]

    def penetration(self, s: Array | float) -> Array | float:
        """``D`` at ``s`` after the start of the step (after the jump)."""
        c1, c2, c3 = self.rates
        return self.start + self.jump + s * (c1 + s * (c2 + s * c3))

    @property
    def end(self) -> float:
        """``D`` at the end of the step."""
        return float(self.penetration(self.duration))


@dataclass(frozen=True)
class BranchGain:
    """What branches in contact gain, per unit of their moduli: ``int exp(-(until - s)/tau_k) D'(s) ds``.

    Linear in the rates of the penetration; what belongs to each is the same for all that are tried in a step.

    Parameters
    ----------
    begin, until : ndarray, shape (m,)
        Limits of the integral, times from the start of the step.
    times : ndarray, shape (n,)
        Relaxation times ``tau_k``.
    """

    begin: Array
    until: Array
    times: Array

    def under(self, depth: PenetrationPath) -> Array:
        """Under a penetration: lengths, shape (m, n)."""
        c1, c2, c3 = depth.rates
        if c2 == 0.0 and c3 == 0.0:
            return c1 * self._of_ramp
        first, second, third = self._of_powers
        gained = c1 * first + c2 * second
        return gained if c3 == 0.0 else gained + c3 * third

    @cached_property
    def _of_ramp(self) -> Array:
        """Of ``D = s``."""
        return -self.times * np.expm1((self.begin - self.until)[:, None] / self.times)

    @cached_property
    def _of_powers(self) -> tuple[Array, Array, Array]:
        """Of ``D = s``, ``s^2`` and ``s^3``."""
        b, h = self.begin[:, None], (self.until - self.begin)[:, None]
        one, two, three = phi(h / self.times)
        one, two = h * one, h * h * two
        return one, 2.0 * (b * one + two), 3.0 * b * (b * one + 2.0 * two) + 6.0 * h**3 * three


def straight(duration: float, start: float, jump: float, end: float) -> PenetrationPath:
    """Constant speed after the jump.

    Parameters
    ----------
    duration : float
    start : float
        Penetration before the jump.
    jump : float
        Jump at the very start.
    end : float
        Penetration at the end.

    Returns
    -------
    PenetrationPath
    """
    rate = (end - start - jump) / duration if duration > 0.0 else 0.0
    return PenetrationPath(duration, start, jump, (rate, 0.0, 0.0))


def cubic(duration: float, start: float, end: float, rate: float, end_rate: float) -> PenetrationPath:
    """The Hermite cubic through both ends.

    Parameters
    ----------
    duration : float
    start : float
        Penetration at the start; no jump.
    end : float
        Penetration at the end.
    rate : float
        Speed at the start.
    end_rate : float
        Speed at the end.

    Returns
    -------
    PenetrationPath
    """
    mean = (end - start) / duration
    c2 = (3.0 * mean - 2.0 * rate - end_rate) / duration
    c3 = (rate + end_rate - 2.0 * mean) / duration**2
    return PenetrationPath(duration, start, 0.0, (rate, c2, c3))
