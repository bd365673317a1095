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
    """Values of polynomials whose coefficients lie along the last axis."""
    value = coefficients[..., -1] + 0.0 * u
    for order in range(coefficients.shape[-1] - 2, -1, -1):
        value = value * u + coefficients[..., order]
    return value


def derivative(coefficients: Array) -> Array:
    """Coefficients of the derivative."""
    return coefficients[..., 1:] * np.arange(1, coefficients.shape[-1])


def powers(u: Array, degree: int) -> Array:
    """``u^0 ... u^degree`` (m, degree + 1)."""
    return np.vander(u, degree + 1, increasing=True)


def inverse(coefficients: Array, rise: Array) -> Array:
    """``u`` at which monotone polynomials without constant term (m, n) have come to ``rise`` (m,).

    Where one sets off or arrives with no slope, a turn of the edge, it is a square root: the parabola with
    the same slopes at both ends tells where to begin.
    """
    whole = coefficients.sum(axis=-1)
    share = np.clip(rise / whole, 0.0, 1.0)
    slopes = derivative(coefficients)
    first = np.clip(1.0 + 0.5 * (slopes[..., 0] - slopes.sum(axis=-1)) / whole, 0.0, 2.0)
    root = np.sqrt(np.maximum(first * first + 4.0 * (1.0 - first) * share, 0.0))
    u = np.where(first + root > 0.0, 2.0 * share / np.maximum(first + root, 1e-300), 0.0)
    for _ in range(8):
        slope = horner(slopes, u)
        step = (horner(coefficients, u) - rise) / np.where(slope == 0.0, whole, slope)
        u = np.clip(u - step, 0.0, 1.0)
        if np.abs(step).max(initial=0.0) < 1e-8:  # quadratic: one more would be below rounding
            break
    return u
