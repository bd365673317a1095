"""A column of a trace between its rows: monotone cubic pieces, and how uncertain they are.

Rows are as sparse as a solver can afford: between two rows of an elastic contact a straight line misses the
curve by far more than the rows do. Through the rows of a smooth piece goes the cubic Hermite curve with
harmonic slopes (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984), which never leaves the range of its
two rows. A piece ends at a jump (two rows of equal time), at a corner, and where an edge at rest sets off or
a moving one comes to rest; between two rows that belong to no longer piece the curve is straight.

Nobody knows the curve between rows: as an estimate of the interpolation error serves the difference from the
curve with three-point slopes, whose error is of the same order and not of the same size. Where contact begins
or ends, the radius goes as some root of the time: it may be anything between the curve and a step.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from contact_scene import Trace

Array = NDArray[np.float64]

POINTS = np.array([0.0, 0.5 - np.sqrt(3.0 / 28.0), 0.5, 0.5 + np.sqrt(3.0 / 28.0), 1.0])
WEIGHTS = np.array([1.0 / 20.0, 49.0 / 180.0, 16.0 / 45.0, 49.0 / 180.0, 1.0 / 20.0])
"""Gauss-Lobatto points and weights on [0, 1], exact for the square of a cubic."""
CORNER = 10.0
"""A row is a corner if the slope changes there by this many times what it would with the curvature found at
either neighbour up to the row: of a smooth curve on rows that resolve it the two differ by a factor of two or
so, however different the steps on both sides are."""
SHORTEST = 1e-12
"""Least distance of two rows, relative to the duration of the run, that is not a jump: round-off of times."""

ROUND_OFF = 1e-14
"""Difference of two cubics through the same rows, relative to the largest value, that is rounding."""


class RowCurve:
    """A column over time.

    Parameters
    ----------
    time, value : ndarray, shape (n,)
        Rows, n >= 2; times never fall.
    corners : ndarray, shape (m,), optional
        Times at which the curve may turn, whether its rows tell it or not.
    touches : bool
        Whether it may jump within an interval at one end of which it is zero, as the radius of a contact.
    """

    def __init__(
        self, time: Array, value: Array, corners: Array | None = None, touches: bool = False
    ) -> None:
        self.time, self.value, self.touches = time, value, touches
        self.step = np.diff(time)
        least = SHORTEST * float(time[-1] - time[0])
        apart = self.step > least
        self.step = np.where(apart, self.step, 0.0)
        self.secant = np.diff(value) / np.where(apart, self.step, 1.0)
        self.secant[~apart] = 0.0
        self.smooth = _smooth(self.secant, self.step, apart, float(np.abs(value).max()))
        if corners is not None:
            self.smooth &= ~np.isclose(time[:, None], corners, rtol=0.0, atol=least).any(axis=1)
        harmonic, three_point = _inner_slopes(self.secant, self.step)
        self.slopes = _end_slopes(self.secant, self.step, self.smooth, harmonic)
        self.other_slopes = _end_slopes(self.secant, self.step, self.smooth, three_point)

    def within(self, grid: Array) -> Array:
        """Values at ``POINTS`` of every interval of ``grid``, limits from inside; shape (5, len(grid) - 1).

        No row lies inside an interval of ``grid``, which is ascending and within the times of the curve.
        """
        return self._cubic(grid, self.slopes)

    def uncertainty(self, grid: Array) -> Array:
        """Estimated interpolation error at the same points; none within the round-off of the values."""
        curve = self._cubic(grid, self.slopes)
        apart = np.abs(self._cubic(grid, self.other_slopes) - curve)
        if self.touches:
            i = self._interval(0.5 * (grid[1:] + grid[:-1]))
            touch = (self.value[i] == 0.0) != (self.value[i + 1] == 0.0)
            step = np.maximum(self.value[i], self.value[i + 1])
            apart = np.maximum(apart, np.where(touch & (self.step[i] > 0.0), step - curve, 0.0))
        return np.where(apart > ROUND_OFF * float(np.abs(self.value).max()), apart, 0.0)

    def at(self, time: float) -> float:
        """Value at one time, at a jump the later one."""
        return float(self._between(np.array([time]), np.array([time]), self.slopes)[0])

    def values(self, times: Array) -> Array:
        """Values at times of any order, shape (m,), at a jump the later one."""
        return self._between(times, times, self.slopes)

    def _cubic(self, grid: Array, slopes: tuple[Array, Array]) -> Array:
        middle = 0.5 * (grid[1:] + grid[:-1])
        return self._between(middle, grid[:-1] + POINTS[:, None] * np.diff(grid), slopes)

    def _interval(self, inside: Array) -> NDArray[np.intp]:
        """The intervals of rows that contain these times."""
        return np.clip(np.searchsorted(self.time, inside, side="right") - 1, 0, self.time.size - 2)

    def _between(self, inside: Array, at: Array, slopes: tuple[Array, Array]) -> Array:
        """Values at times ``at`` of the intervals of rows that contain the times ``inside``."""
        i = self._interval(inside)
        # Where the middle of two neighbouring floats is one of them, that pair of rows may be a jump.
        h = self.step[i]
        x = np.clip((at - self.time[i]) / np.where(h > 0.0, h, 1.0), 0.0, 1.0)
        x = np.where(h > 0.0, x, 0.0)
        rise = self.secant[i] * h
        begin, end = h * slopes[0][i] - rise, rise - h * slopes[1][i]
        return self.value[i] + rise * x + x * (1.0 - x) * (begin * (1.0 - x) + end * x)


def column_curve(trace: Trace, column: str, corners: Array | None = None) -> RowCurve:
    """A column of a trace over time.

    Parameters
    ----------
    trace : Trace
    column : str
        Name of the column.
    corners : ndarray, shape (m,), optional
        Times at which it may turn, besides those of rows at which the edge sets off or comes to rest.

    Returns
    -------
    RowCurve

    Notes
    -----
    The contact stiffness, and with it the rate of the force, jumps where an edge sets off, as from the rim of
    a punch. A solver may come there in one step of any length and go on in short ones, over which the slope
    changes as much again: a column alone does not tell that from a smooth bend, and the slope of the short
    steps would reach back over the whole long one.
    """
    rests = np.diff(trace.contact_radius) == 0.0
    ends = trace.time[1:-1][rests[1:] != rests[:-1]]
    both = ends if corners is None else np.concatenate((corners, ends))
    return RowCurve(trace.time, trace.columns()[column], both, column == "contact_radius")


def _smooth(secant: Array, step: Array, apart: NDArray[np.bool_], largest: float) -> NDArray[np.bool_]:
    """Whether the curve passes each row without jump or corner, shape (n,); false at both ends."""
    smooth = np.zeros(step.size + 1, bool)
    if step.size < 2:
        return smooth
    inner = apart[1:] & apart[:-1]
    change = np.where(inner, np.abs(np.diff(secant)), 0.0)
    shortest = np.where(inner, np.minimum(step[1:], step[:-1]), 1.0)
    certain = np.maximum(change - 8.0 * np.finfo(float).eps * largest / shortest, 0.0)
    bend = certain / np.where(inner, 0.5 * (step[1:] + step[:-1]), 1.0)
    before, after = np.append(0.0, bend[:-1]), np.append(bend[1:], 0.0)
    smooth[1:-1] = inner & (change <= CORNER * 0.5 * (before * step[:-1] + after * step[1:]))
    return smooth


def _inner_slopes(secant: Array, step: Array) -> tuple[Array, Array]:
    """Harmonic and three-point slopes at every row, shape (n,); zero at both ends and at jumps."""
    harmonic, three_point = np.zeros(step.size + 1), np.zeros(step.size + 1)
    before, after, h0, h1 = secant[:-1], secant[1:], step[:-1], step[1:]
    rising = before * after > 0.0
    largest = np.where(rising, np.maximum(np.abs(before), np.abs(after)), 1.0)
    first, second = np.where(rising, before / largest, 1.0), np.where(rising, after / largest, 1.0)
    total = np.where(h0 + h1 > 0.0, h0 + h1, 1.0)
    weight = (h0 + 2.0 * h1) / (3.0 * total)
    harmonic[1:-1] = np.where(
        rising, largest * first * second / (weight * second + (1.0 - weight) * first), 0.0
    )
    least = 3.0 * np.minimum(np.abs(before), np.abs(after))
    three_point[1:-1] = np.clip((h1 * before + h0 * after) / total, -least, least)
    return harmonic, three_point


def _end_slopes(secant: Array, step: Array, smooth: NDArray[np.bool_], inner: Array) -> tuple[Array, Array]:
    """Slopes at both ends of every interval, shape (n - 1,) each; one-sided where a smooth piece ends."""
    begin = np.where(smooth[:-1], inner[:-1], secant)
    end = np.where(smooth[1:], inner[1:], secant)
    if secant.size < 2:
        return begin, end
    onward = _one_sided(secant[:-1], secant[1:], step[:-1], step[1:])
    begin[:-1] = np.where(~smooth[:-2] & smooth[1:-1], onward, begin[:-1])
    back = _one_sided(secant[1:], secant[:-1], step[1:], step[:-1])
    end[1:] = np.where(~smooth[2:] & smooth[1:-1], back, end[1:])
    return begin, end


def _one_sided(own: Array, beside: Array, h0: Array, h1: Array) -> Array:
    """Slope of the parabola through three rows at the outer one, limited so that the curve stays monotone."""
    total = np.where(h0 + h1 > 0.0, h0 + h1, 1.0)
    slope = ((2.0 * h0 + h1) * own - h0 * beside) / total
    slope = np.where(slope * own <= 0.0, 0.0, slope)
    least = 3.0 * np.abs(own)
    return np.clip(slope, -least, least)
