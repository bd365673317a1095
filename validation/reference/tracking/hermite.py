"""Piecewise cubic interpolation on unequal nodes: third order where smooth, bounded at kinks and steps.

Slopes are those of the parabola through three neighbours, held below three times the smaller of the two
neighbouring difference quotients. Unlike the monotone limiter of Fritsch and Carlson this keeps the slope at
a smooth extremum; a step of the data between two very close nodes still cannot throw the cubic off.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

STEP = 1e-4
"""Ratio of neighbouring intervals below which the short one is taken for a discontinuity of the data."""

Array = NDArray[np.float64]


def each_once(*values: Array) -> Array:
    """All values in rising order, each once; ``np.unique`` loads ``numpy.ma``, a tenth of a small run."""
    listed = np.sort(np.concatenate(values))
    return listed[np.concatenate(([True], listed[1:] != listed[:-1]))]


_GAUSS, _WEIGHT = np.polynomial.legendre.leggauss(4)  # exact for the square of a cubic
_GAUSS, _WEIGHT = 0.5 * (_GAUSS + 1.0), 0.5 * _WEIGHT
_ENDS, _NEXT = np.array([0, -1]), np.array([1, -2])  # the outer nodes and intervals, and the ones behind


def slopes(x: Array, y: Array, step: float = STEP) -> Array:
    """Limited slopes at the nodes ``x`` (m,), strictly rising; ``y`` has shape (m,) or (m, n).

    ``step`` is the ratio of neighbouring intervals at which the slope is that of the node's own side.
    """
    if len(x) == 1:
        return np.zeros_like(y)
    if y.ndim == 2 and y.shape[1] == 1:
        column: Array = slopes(x, y[:, 0], step)[:, None]
        return column
    widths = x[1:] - x[:-1]
    h = widths if y.ndim == 1 else widths[:, None]
    secant = (y[1:] - y[:-1]) / h
    if len(x) == 2:
        return np.concatenate((secant, secant))
    result = np.empty_like(y)
    left, right = secant[:-1], secant[1:]
    bound = np.abs(secant)
    bound *= 3.0
    bound = np.minimum(bound[:-1], bound[1:])
    middle = right - left
    middle *= h[:-1] / (h[:-1] + h[1:])
    middle += left
    np.minimum(np.maximum(middle, -bound), bound, out=result[1:-1])
    # At the ends, and beside a step, the slope is that of the node's own side.
    steps = beside_steps(widths, step)
    if y.ndim == 1 and not len(steps):  # the usual case: an eighth of a run is saved without arrays of two
        for end, behind in ((0, 1), (-1, -2)):
            last, width = float(secant[end]), float(widths[end])
            share = width / (width + float(widths[behind]))
            limit = 3.0 * abs(last)
            result[end] = min(max(last + (last - float(secant[behind])) * share, -limit), limit)
        return result
    on_left = widths[steps] < widths[steps - 1]
    nodes = np.concatenate((_ENDS, steps))
    near = np.concatenate((_ENDS % len(h), np.where(on_left, steps - 1, steps)))
    far = np.concatenate((_NEXT % len(h), np.where(on_left, steps - 2, steps + 1)))
    far = np.where((far >= 0) & (far < len(h)), far, near)
    far = np.where(widths[far] > step * widths[near], far, near)
    own = secant[near]
    one_sided = own + (own - secant[far]) * (h[near] / (h[near] + h[far]))
    bound = 3.0 * np.abs(own)
    result[nodes] = np.minimum(np.maximum(one_sided, -bound), bound)
    return result


def beside_steps(widths: Array, step: float = STEP) -> NDArray[np.intp]:
    """Inner nodes with another so close on one side that the data may step between them.

    ``widths`` are those of the intervals between all nodes, ``step`` the ratio of two of them from which on.
    """
    left, right = widths[:-1], widths[1:]
    return ((right < step * left) | (left < step * right)).nonzero()[0] + 1


def evaluate(x: Array, y: Array, slope: Array, at: Array) -> Array:
    """Cubic through the nodes at the points ``at`` (any shape; (m,) for 2-D ``y``); constant beyond.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Nodes, strictly rising.
    y : ndarray, shape (m,) or (m, n)
        Values at the nodes.
    slope : ndarray, shape of y
        Slopes at the nodes.
    at : ndarray
        Points.

    Returns
    -------
    ndarray
        Values, of the shape of ``at`` and the columns of ``y``.
    """
    if len(x) == 1:
        return np.broadcast_to(y[0], at.shape + y.shape[1:]).copy()
    i = x[1:-1].searchsorted(at, side="right")
    after = i + 1
    left = x.take(i)
    h = x.take(after) - left
    u = np.minimum(np.maximum((at - left) / h, 0.0), 1.0)
    if y.ndim == 2:
        h, u = h[:, None], u[:, None]
    first, last = y.take(i, axis=0), y.take(after, axis=0)
    return _cubic(first, last, h * slope.take(i, axis=0), h * slope.take(after, axis=0), u)


def rate(x: Array, y: Array, slope: Array, at: Array) -> Array:
    """Derivative of the cubic at the points ``at``, for 1-D ``y``.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Nodes, strictly rising.
    y : ndarray, shape (m,)
        Values at the nodes.
    slope : ndarray, shape (m,)
        Slopes at the nodes.
    at : ndarray
        Points.

    Returns
    -------
    ndarray
        Derivatives, of the shape of ``at``.
    """
    i = x[1:-1].searchsorted(at, side="right")
    h = x[i + 1] - x[i]
    u = (at - x[i]) / h
    secant = (y[i + 1] - y[i]) / h
    first, last = slope[i], slope[i + 1]
    return first + u * (6.0 * secant - 4.0 * first - 2.0 * last + 3.0 * u * (first + last - 2.0 * secant))


def integral(x: Array, y: Array) -> Array:
    """Integral of the cubic from the first node to the last; over axis 0."""
    if len(x) == 1:
        return np.zeros(y.shape[1:])
    slope = slopes(x, y)
    h = x[1:] - x[:-1]
    if y.ndim == 2:
        h = h[:, None]
    return (h * (0.5 * (y[1:] + y[:-1]) + h * (slope[:-1] - slope[1:]) / 12.0)).sum(axis=0)


def integral_of(x: Array, y: Array, density: Callable[[Array, Array], Array], slope: Array) -> float:
    """Integral of ``density(y(x), x)`` along the cubic, from the first node to the last; exact for squares.

    Parameters
    ----------
    x : ndarray, shape (m,)
        Nodes, strictly rising.
    y : ndarray, shape (m,) or (m, n)
        Values at the nodes.
    density : callable(ndarray, shape (l,) or (l, n), ndarray, shape (l,)) -> ndarray, shape (l,)
        Integrand, of values of the cubic and where they are.
    slope : ndarray, shape of y
        Slopes at the nodes.

    Returns
    -------
    float
    """
    if len(x) == 1:
        return 0.0
    h = x[1:] - x[:-1]
    wide = h if y.ndim == 1 else h[:, None]
    ends = np.array((y[:-1], y[1:], wide * slope[:-1], wide * slope[1:]))
    at = (x[:-1] + _GAUSS[:, None] * h).ravel()
    values = (_GAUSS_SHAPES @ ends.reshape(4, ends[0].size)).reshape(len(at), *y.shape[1:])
    return float((_WEIGHT[:, None] * h).ravel() @ density(values, at))


def _cubic(first: Array, last: Array, rise: Array, end: Array, u: Array) -> Array:
    """Cubics at fractions ``u`` of their intervals, from values and slopes times lengths at both ends."""
    step = last - first
    return first + u * (rise + u * (3.0 * step - 2.0 * rise - end + u * (rise + end - 2.0 * step)))


_UNIT = np.eye(4)[:, :, None]
_GAUSS_SHAPES = _cubic(_UNIT[0], _UNIT[1], _UNIT[2], _UNIT[3], _GAUSS).T
"""Cubics of unit value or slope at one end of their interval, at the points of the rule: (point, end)."""
