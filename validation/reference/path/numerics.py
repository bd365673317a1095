"""Polynomials in powers of ``u`` in [0, 1], and roots and least values between two ends.

These are all a run needs of SciPy, which takes longer to load than most runs take.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DEGREE = 4
"""Of the path in its arclength. Degree 3 takes a tenth more steps; 5 and more up to three times as many,
because the polynomial then reaches back over changes of the step by orders of magnitude."""
ORDERS = np.arange(DEGREE + 1)
ROUNDING = 1e-12
"""Relative difference of two numbers that may be rounding, of which a run adds up thousands."""
NEGLIGIBLE = 1e-9
"""Part of a whole that changes nothing that is asked for, and is not yet lost in rounding."""
SMALL_PART = 0.1
"""Of a whole, what is small beside it: scales of a run in the largest radius and penetration."""


def total(table: Array) -> Array:
    """Sums of the rows of a table (m, n): ten times as fast as ``sum`` on so short an axis."""
    return table @ np.ones(table.shape[1])


@cache
def gauss(count: int) -> tuple[Array, Array]:
    """Points and weights on [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (points + 1.0), 0.5 * weights


def chebyshev(x: Array, order: int) -> Array:
    """Chebyshev's polynomials (order, m)."""
    values, twice = np.ones((order, *x.shape)), 2.0 * x
    values[1:2] = x
    for n in range(2, order):
        values[n] = values[n - 1] * twice - values[n - 2]
    return values


@cache
def chebyshev_series(order: int) -> tuple[Array, Array]:
    """Chebyshev's knots, and what makes of values there the coefficients of a series."""
    knots = np.cos(np.pi * (np.arange(order) + 0.5) / order)
    series = 2.0 / order * chebyshev(knots, order)
    series[0] *= 0.5
    return knots, series


def horner(coefficients: Array, u: Array) -> Array:
    """Values of a polynomial."""
    value = coefficients[-1] + 0.0 * u
    for coefficient in coefficients[-2::-1].tolist():
        value = value * u + coefficient
    return value


def derivative(coefficients: Array) -> Array:
    """Coefficients (n - 1, ...) of the derivative."""
    return (coefficients[1:].T * np.arange(1, len(coefficients))).T


def powers(u: Array, degree: int) -> Array:
    """``u^0 ... u^degree`` (m, degree + 1)."""
    table = np.empty((degree + 1, len(u)))
    table[0], table[1:] = 1.0, u
    return np.multiply.accumulate(table, axis=0, out=table).T


def on_parabola(linear: Array, share: Array) -> tuple[Array, Array]:
    """``g`` at which ``c g + (1 - c) g^2`` has come to a share of its whole, and its slope there."""
    root = np.sqrt(np.maximum(linear * linear + 4.0 * (1.0 - linear) * share, 0.0))
    return 2.0 * share / np.maximum(linear + root, sys.float_info.min), root


def inverse(way: Array, rise: Array) -> Array:
    """``u`` (m,) at which a monotone polynomial without constant term has come to ``rise`` (m,).

    Where it sets off or arrives with no slope, a turn of the edge, it is a square root: the parabola with
    the same slopes at both ends tells where to begin.
    """
    whole = float(way.sum())
    if not len(rise) or not whole:  # lost in rounding
        return 0.0 * rise
    orders = np.arange(len(way))
    share = np.minimum(np.maximum(rise / whole, 0.0), 1.0)
    linear = min(max(1.0 + 0.5 * float(way[1] - way @ orders) / whole, 0.0), 2.0)
    u = on_parabola(np.array(linear), share)[0]
    both = np.zeros((len(way), 2))
    both[:, 0], both[:-1, 1] = way, (orders * way)[1:]
    for _ in range(8):
        value, slope = (powers(u, len(way) - 1) @ both).T
        step = (value - rise) / np.where(slope == 0.0, whole, slope)
        u = np.minimum(np.maximum(u - step, 0.0), 1.0)
        if np.abs(step).max() < 1e-8:  # quadratic: one more would be below rounding
            break
    return u


def bracketed(function: Callable[[float], float], first: float, last: float, narrow: float = 0.0) -> float:
    """Root between two ends at which a function has opposite signs, to ``narrow`` or to rounding.

    By inverse quadratic interpolation where that is safe, otherwise by halves (T.R. Chandrupatla, Adv. Eng.
    Software 28, 145 (1997)).
    """
    a, b = first, last
    fa, fb = function(a), function(b)
    if fa == 0.0 or fb == 0.0:
        return a if fa == 0.0 else b
    if not fa * fb < 0.0:
        raise ValueError(f"no change of sign between {first:g} and {last:g}: {fa:g}, {fb:g}")
    share = 0.5
    while True:
        x = a + share * (b - a)
        fx = function(x)
        if (fx > 0.0) == (fa > 0.0):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, fx
        best, least = (a, fa) if abs(fa) < abs(fb) else (b, fb)
        shortest = (2.0 * sys.float_info.epsilon * abs(best) + 0.5 * narrow) / abs(b - a)
        if least == 0.0 or shortest > 0.5:
            return best
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        share = 0.5
        if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
            share = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        share = min(max(share, shortest), 1.0 - shortest) if math.isfinite(share) else 0.5


def dip(function: Callable[[float], float], first: float, last: float, narrow: float) -> tuple[float, float]:
    """The lowest place between two ends, to ``narrow``, and its value; the first found that is not positive.

    By the golden section.
    """
    golden = 0.5 * (math.sqrt(5.0) - 1.0)
    a, b = first, last
    x, y = b - golden * (b - a), a + golden * (b - a)
    low, high = function(x), function(y)
    while min(low, high) > 0.0 and abs(b - a) > narrow:
        if low < high:
            b, y, high = y, x, low
            x = b - golden * (b - a)
            low = function(x)
        else:
            a, x, low = x, y, high
            y = a + golden * (b - a)
            high = function(y)
    return (x, low) if low < high else (y, high)
