"""Polynomials in powers of ``u`` in [0, 1], and the points on which they are made."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

DEGREE = 4
"""Of the path in its arclength. Degree 3 takes a tenth more steps; 5 and more up to three times as many,
because the polynomial then reaches back over changes of the step by orders of magnitude."""
ORDERS = np.arange(DEGREE + 1)


def gauss(count: int) -> tuple[Array, Array]:
    """Points and weights on [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (points + 1.0), 0.5 * weights


def horner(coefficients: Array, u: Array) -> Array:
    """Values of a polynomial."""
    value = coefficients[-1] + 0.0 * u
    for coefficient in coefficients[-2::-1].tolist():
        value = value * u + coefficient
    return value


def derivative(coefficients: Array) -> Array:
    """Coefficients of the derivative."""
    return coefficients[1:] * np.arange(1, len(coefficients))


def powers(u: Array, degree: int) -> Array:
    """``u^0 ... u^degree`` (m, degree + 1)."""
    table = np.empty((degree + 1, len(u)))
    table[0], table[1:] = 1.0, u
    return np.multiply.accumulate(table, axis=0, out=table).T


def inverse(way: Array, rise: Array) -> Array:
    """``u`` (m,) at which a monotone polynomial without constant term has come to ``rise`` (m,).

    Where it sets off or arrives with no slope, a turn of the edge, it is a square root: the parabola with
    the same slopes at both ends tells where to begin.
    """
    if not len(rise):
        return rise
    orders = np.arange(len(way))
    whole = float(way.sum())
    share = np.minimum(np.maximum(rise / whole, 0.0), 1.0)
    linear = min(max(1.0 + 0.5 * float(way[1] - way @ orders) / whole, 0.0), 2.0)
    root = np.sqrt(np.maximum(linear * linear + 4.0 * (1.0 - linear) * share, 0.0))
    u = 2.0 * share / np.maximum(linear + root, 1e-300)
    both = np.zeros((len(way), 2))
    both[:, 0], both[:-1, 1] = way, (orders * way)[1:]
    for _ in range(8):
        value, slope = (powers(u, len(way) - 1) @ both).T
        step = (value - rise) / np.where(slope == 0.0, whole, slope)
        u = np.minimum(np.maximum(u - step, 0.0), 1.0)
        if np.abs(step).max() < 1e-8:  # quadratic: one more would be below rounding
            break
    return u
