"""What the branches receive within a step in which the load changes evenly, beyond straight lines.

Over a step ``L_k = int p l_k`` (``l_k`` the lag of branch k) and ``X_k = J_k Y - L_k`` are known at both
ends. Between them they are no straight lines: a lag decays with the branch's own time, and after a kink of
the loading most of it does. The trapezoid of a decaying exponential is too large by ``y^2/12`` of it, with
``y`` the step in retardation times, in every step and always in the same direction. With load and pressure
linear in a step (s its share, D = int dp dv without what belongs to the moving tip, which changes at once
wherever the tip is),

    L(s) = (L_0 + s int dp l) exp(-y s) + J (int p dv + tip + s D) (1 - exp(-y s))/y,

by which the trapezoid is corrected: the ends stay those of the states, whose errors do not add up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_SHARES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
"""Gauss points of a step, and their weights: exact to rounding for exponentials over up to ten times their
range."""


def beyond_straight_lines(
    lag: Array,
    lag_gained: Array,
    load_gained: float,
    load_bend: float,
    tip: float,
    compliances: Array,
    y: Array,
) -> tuple[Array, Array]:
    """Integrals of ``L`` and of ``X`` over a step beyond those of straight lines between its ends.

    Parameters
    ----------
    lag, lag_gained : ndarray (K,)
        ``int p l`` at the start, and ``int dp l`` with the lags of the start.
    load_gained, load_bend, tip : float
        ``int p dv``, and what ``int dp dv`` has apart from the moving tip and belonging to it.
    compliances, y : ndarray (K,)
        ``J_k``, and the step in retardation times.

    Returns
    -------
    received : ndarray (K,)
        ``y int (L - straight) ds``.
    stored : ndarray (K,)
        ``2 y int exp(-2 y (1 - s)) (X - straight) ds``.
    """

    def lagging(s: Array | float) -> Array:
        decay = np.exp(-y * s)
        risen = s * np.where(y * s > 1e-12, -np.expm1(-y * s) / np.maximum(y * s, 1e-300), 1.0)
        return (lag + s * lag_gained) * decay + compliances * (load_gained + tip + s * load_bend) * risen

    shares = _SHARES[:, None]
    end = lagging(1.0)
    bent = lagging(shares) - ((1.0 - shares) * lag + shares * end)
    load = compliances * load_bend * shares * (shares - 1.0)  # Y beyond its straight line
    received = y * (_WEIGHTS @ bent)
    stored = 2.0 * y * (_WEIGHTS @ (np.exp(-2.0 * y * (1.0 - shares)) * (load - bent)))
    return received, stored
