"""Dense output: values between the rows of a run, by a cubic through four rows of a smooth stretch.

The stencil is the four nearest rows, or the same shifted by one row, whichever cubic is smoothest: the speed
of the edge has a kink where it comes within one process zone of a former reversal, and a cubic should not be
laid across it (essentially non-oscillatory interpolation).

Where the curve is smooth on the scale of the rows, the quintic through six of them is taken: work is an
integral over many steps, and the errors of cubics add up.

Beside a long step, a polynomial through closely spaced rows amplifies their rounding errors. Where it leaves
the chord by more than the range of the four rows, the chord is taken.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SHIFT_RATIO = 0.03
"""Use a shifted stencil if its third difference is below this share of the centred one (ENO)."""

SMOOTH = 0.25
"""The quintic is taken where it differs from the cubic by less than this share of what the cubic does from
parabolas through three of its rows: corrections get smaller where the curve is smooth."""
LEAST_INTERVAL = 1.0 / 8.0
"""Least of its other intervals over that in question: beside a longer one it amplifies rounding errors."""

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def cubics(time: Array, values: Array, ends: Indices, index: Indices, at: Array) -> Array:
    """Values at times between the rows ``index`` and ``index + 1``.

    Parameters
    ----------
    time, values : ndarray, shape (l,) and (l, n)
        Rows; strictly rising times within a stretch.
    ends : ndarray of int
        Rows at which the stretches end and begin, rising, the first and last row among them. A short stretch
        has a polynomial of lower degree.
    index : ndarray of int, shape (m,)
        Row before each of the times.
    at : ndarray, shape (m,)
        Times.

    Returns
    -------
    ndarray, shape (m, n)
    """
    stretch = ends.searchsorted(index, side="right")
    first, last = ends[stretch - 1], ends[stretch]
    count = last - first + 1
    share = (at - time[index]) / (time[index + 1] - time[index])
    chord = values[index] + share[:, None] * (values[index + 1] - values[index])
    result = chord.copy()
    for degree in (1, 2, 3):
        these = count == degree + 1 if degree < 3 else count > 3
        if these.any():
            low, high, middle = first[these], last[these] - degree, index[these] - 1
            places = [np.maximum(np.minimum(middle + shift, high), low) for shift in (0, -1, 1)]
            result[these] = _smoothest(time, values, places, degree, at[these], chord[these])
    inner = (index - 2 >= first) & (index + 3 <= last)
    if inner.any():
        result[inner] = _raised(time, values, index[inner], at[inner], result[inner])
    return result


def _raised(time: Array, values: Array, index: Indices, at: Array, curve: Array) -> Array:
    """``curve``, by column the quintic in place of the centred cubic where the rows show both smooth."""
    near, rows = (index[:, None] + np.arange(-before, before + 2) for before in (1, 2))
    cubic, _ = _newton(time[near], values[near], at)
    quintic, _ = _newton(time[rows], values[rows], at)
    widths = np.diff(time[rows], axis=1)
    even = widths.min(axis=1) >= LEAST_INTERVAL * widths[:, 2]
    parabolas = [_newton(time[three], values[three], at)[0] for three in (near[:, :-1], near[:, 1:])]
    bent = np.minimum(*(np.abs(cubic - parabola) for parabola in parabolas))
    smooth = np.abs(quintic - cubic) < SMOOTH * bent
    return np.where(even[:, None] & smooth & (curve == cubic), quintic, curve)


def _smoothest(
    time: Array, values: Array, places: list[Indices], degree: int, at: Array, chord: Array
) -> Array:
    """Of the polynomials that begin at ``places`` the one with the smallest leading term, by column."""
    best = np.full_like(chord, np.inf)
    result = chord.copy()
    for place in places:
        rows = place[:, None] + np.arange(degree + 1)
        curve, leading = _newton(time[rows], values[rows], at)
        better = np.abs(leading) < SHIFT_RATIO * best
        wild = np.abs(curve - chord) > np.ptp(values[rows], axis=1)
        result = np.where(better, np.where(wild, chord, curve), result)
        best = np.where(better, np.abs(leading), best)
    return result


def _newton(nodes: Array, values: Array, at: Array) -> tuple[Array, Array]:
    """Polynomials through ``nodes`` (m, p) with ``values`` (m, p, n) at ``at`` (m,); their leading terms."""
    table = values.copy()
    degree = nodes.shape[1] - 1
    for order in range(1, degree + 1):
        gap = nodes[:, order:] - nodes[:, :-order]
        table[:, order:] = (table[:, order:] - table[:, order - 1 : -1]) / gap[:, :, None]
    result = table[:, degree]
    for i in range(degree - 1, -1, -1):
        result = table[:, i] + (at - nodes[:, i])[:, None] * result
    return result, table[:, degree]
