"""Curves over time between the rows of a trace, and how far two of them lie apart.

Rows are as sparse as a solver can afford: between two rows of an elastic contact a straight line misses the
curve by far more than the rows do. Through the rows of a smooth piece goes the cubic Hermite curve with
three-point slopes, limited so that it leaves the range of its two rows only where it bends at both the same
way, as at an extremum between them. A piece ends at a jump (two rows of equal time), where a load step ends,
at a corner, and where the speed of the edge jumps.
Nobody knows the curve between rows: as an estimate of the interpolation error serves the difference from the
curve with harmonic slopes (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5, 1984), which never leaves the
range of its two rows. Where contact begins or ends, the radius goes as some root of the time: it may be
anything between the curve and a step.

Two runs are laid on the union of their times, over the interval that both cover; between two neighbours each
is one cubic, so the integral of the squared difference is exact. A jump has a left and a right limit, and
both count. A difference is divided by the *size* of the quantity, or, so that a small oscillation on a large
contact is not lost, by its *excursion*: the difference of its largest and smallest value in a window of the
run. There the mean difference is left out, since a contact too large by a constant moves as it should.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Trace
from contact_scene.trace import Array
from validation.measure.windows import load_step_ends

CURVES = ("force", "contact_radius")
"""Columns that runs are compared by, as curves over time."""
MOVEMENT = "_movement"
"""Ending of the name of an error of a curve relative to its excursion in the worst window."""
POINTS = np.array([0.0, 0.5 - np.sqrt(3.0 / 28.0), 0.5, 0.5 + np.sqrt(3.0 / 28.0), 1.0])
WEIGHTS = np.array([1.0 / 20.0, 49.0 / 180.0, 16.0 / 45.0, 49.0 / 180.0, 1.0 / 20.0])
"""Gauss-Lobatto points and weights on [0, 1], exact for the square of a cubic."""
CORNER = 10.0
"""A row is a corner if the slope changes there by this many times what it would with the curvature found at
either neighbour up to the row: of a smooth curve on rows that resolve it the two differ by a factor of two or
so, however different the steps on both sides are. Without this rule a corner between long and short steps is
smoothed over: boundary elements on a spring would estimate their force at four tolerances."""
FASTER = 3.0
"""Least ratio of the speeds of an edge in neighbouring steps between which its speed jumps, if it does not
turn round: what changes less the rows of a column tell themselves, and a steady edge changes by rounding."""
SHORTEST = 1e-12
"""Least distance of two rows, relative to the duration of the run, that is not a jump: round-off of times."""
ROUNDING = 1e-14
"""Difference of two cubics through the same rows, relative to the largest value, that is rounding."""
LEAST_EXCURSION = 5e-3
"""Least excursion that a difference is divided by, relative to the largest magnitude of the column: the
tolerance of curves relative to their size, within which lies whatever moves less."""


class RowCurve:
    """A column over time: rows of times that never fall, at least two.

    ``corners`` are times at which it may turn, whether its rows tell it or not. It ``touches`` if it may jump
    within an interval at one end of which it is zero, as the radius of a contact.
    """

    def __init__(
        self, time: Array, value: Array, corners: Array | None = None, touches: bool = False
    ) -> None:
        self.time, self.value, self.touches = time, value, touches
        self.step = np.diff(time)
        least = SHORTEST * float(time[-1] - time[0])
        lasting = self.step > least
        self.step = np.where(lasting, self.step, 0.0)
        self.secant = np.diff(value) / np.where(lasting, self.step, 1.0)
        self.secant[~lasting] = 0.0
        smooth = _smooth(self.secant, self.step, lasting, float(np.abs(value).max()))
        if corners is not None:
            smooth &= ~np.isclose(time[:, None], corners, rtol=0.0, atol=least).any(axis=1)
        three_point, harmonic = _inner_slopes(self.secant, self.step)
        self.slopes = _end_slopes(self.secant, self.step, smooth, three_point)
        self.other_slopes = _end_slopes(self.secant, self.step, smooth, harmonic)

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
        return np.where(apart > ROUNDING * float(np.abs(self.value).max()), apart, 0.0)

    def at(self, time: float) -> float:
        """Value at one time, at a jump the later one."""
        return float(self.values(np.array([time]))[0])

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
        h = self.step[i]  # where the middle of two neighbouring floats is one of them, they may be a jump
        x = np.where(h > 0.0, np.clip((at - self.time[i]) / np.where(h > 0.0, h, 1.0), 0.0, 1.0), 0.0)
        rise = self.secant[i] * h
        begin, end = h * slopes[0][i] - rise, rise - h * slopes[1][i]
        return self.value[i] + rise * x + x * (1.0 - x) * (begin * (1.0 - x) + end * x)


def edge_turns(time: Array, radius: Array) -> Array:
    """Times at which the speed of the edge jumps: it sets off or comes to rest, or the loading has a kink.

    There the contact stiffness jumps, and with it the rate of the force, as where an edge leaves the rim of a
    punch. A solver may come there in one step of any length and go on in short ones, over which the slope
    changes as much again: a column alone does not tell that from a smooth bend, and the slope of the short
    steps would reach back over the whole long one. The speed of a decay in long steps falls by any factor,
    but by the same in each: what jumps changes far more than beside it, and by a larger factor.
    """
    lasts = np.diff(time) > 0.0
    moves = np.abs(np.diff(radius)) > ROUNDING * np.abs(radius).max(initial=0.0)
    speed = np.full(lasts.shape, np.nan)
    speed[lasts] = np.where(moves, np.diff(radius), 0.0)[lasts] / np.diff(time)[lasts]
    with np.errstate(divide="ignore", invalid="ignore"):
        size = np.log(np.abs(speed))
        faster = np.abs(np.diff(size)) > np.log(FASTER)
        turned = np.sign(speed[1:]) * np.sign(speed[:-1]) < 0.0
        jumps = _abrupt(speed) & (turned | faster & _abrupt(size))
    return time[1:-1][(jumps | (moves[1:] != moves[:-1])) & lasts[1:] & lasts[:-1]]


def _abrupt(values: Array) -> NDArray[np.bool_]:
    """Whether values change from one to the next by far more than before and after, shape (n - 1,); no change
    that lacks either is known to be."""
    change = np.abs(np.diff(values))
    around = np.maximum(np.append(np.nan, change[:-1]), np.append(change[1:], np.nan))
    return change > CORNER * around


def column_curve(trace: Trace, column: str, spans: Array | None = None) -> RowCurve:
    """A column of a trace over time, with corners where its edge turns and where load steps end, by the
    windows of the run."""
    turns = edge_turns(trace.time, trace.contact_radius)
    if spans is not None:
        turns = np.concatenate((load_step_ends(spans), turns))
    return RowCurve(trace.time, trace.columns()[column], turns, column == "contact_radius")


@dataclass(frozen=True)
class Distance:
    """How far one column of two runs lies apart, relative to the largest magnitude in the second.

    ``mean`` is that of ``|x - y|`` over the time of both, ``rms`` its root mean square; ``largest`` is
    at the time ``at`` and near a loss of contact mostly a shift in time. ``size`` is the largest magnitude in
    the second (1 if it is zero throughout), ``level`` its root mean square over that, and ``factor`` the
    constant that turns the second into the first with the least root mean square left over.
    """

    mean: float
    rms: float
    largest: float
    at: float
    size: float = 1.0
    level: float = 1.0
    factor: float = 1.0


@dataclass(frozen=True)
class MovementDistance:
    """How differently a column of two runs moves in its worst window, relative to the second's excursion."""

    rms: float
    begin: float
    end: float


def distance(
    run: Trace, reference: Trace, column: str = "force", spans: Array | None = None
) -> Distance | None:
    """Distance of ``run`` from ``reference`` in one column; ``None`` if they share no interval of time.

    ``spans`` are windows of the run, shape (n, 2): where load steps end, a curve may have a corner that rows
    of one column alone do not tell from a bend.
    """
    grid = _common_times(run.time, reference.time)
    if grid.size < 2:
        return None
    second = column_curve(reference, column, spans).within(grid)
    first = column_curve(run, column, spans).within(grid)
    apart = first - second
    size = float(np.abs(second).max()) or 1.0
    h = _interval_lengths(grid)
    span = float(grid[-1] - grid[0])
    worst = np.unravel_index(int(np.argmax(np.abs(apart) * (h > 0.0))), apart.shape)

    def mean(values: Array) -> float:
        return float((h * (WEIGHTS @ values)).sum() / span)

    square = mean(second**2)
    return Distance(
        mean=float((h * _mean_magnitude(apart)).sum() / span / size),
        rms=float(np.sqrt(mean(apart**2)) / size),
        largest=float(np.abs(apart[worst]) / size),
        at=float(grid[worst[1]] + POINTS[worst[0]] * h[worst[1]]),
        size=size,
        level=float(np.sqrt(square) / size),
        factor=mean(first * second) / square if square > 0.0 else 1.0,
    )


def movement_distance(
    run: Trace, reference: Trace, spans: Array, column: str = "force"
) -> MovementDistance | None:
    """How differently two runs move in the worst of several windows; ``None`` if they share none."""
    grid = _common_times(run.time, reference.time, spans)
    if grid.size < 2:
        return None
    second = column_curve(reference, column, spans).within(grid)
    apart = column_curve(run, column, spans).within(grid) - second
    return _worst_window(grid, apart, second, spans)


def interpolation_error(trace: Trace, column: str, spans: Array | None = None) -> float:
    """Estimated error of a curve between its rows: root mean square over the largest magnitude."""
    grid, size = np.unique(trace.time), float(np.abs(trace.columns()[column]).max(initial=0.0))
    if grid.size < 2 or size == 0.0:
        return 0.0
    unknown = column_curve(trace, column, spans).uncertainty(grid)
    return float(np.sqrt((np.diff(grid) * (WEIGHTS @ unknown**2)).sum() / (grid[-1] - grid[0])) / size)


def movement_interpolation_error(trace: Trace, spans: Array, column: str) -> float:
    """Estimated error of a curve between its rows, relative to its excursion in the worst window."""
    grid = _common_times(trace.time, trace.time, spans)
    if grid.size < 2:
        return 0.0
    curve = column_curve(trace, column, spans)
    worst = _worst_window(grid, curve.uncertainty(grid), curve.within(grid), spans, centred=False)
    return 0.0 if worst is None else worst.rms


def movement_bound(trace: Trace, spans: Array, column: str) -> float:
    """Largest movement distance, in any window, of a curve that is off by its own size (root mean square)."""
    value = trace.columns()[column]
    size = float(np.abs(value).max(initial=0.0))
    largest = 0.0
    for begin, end in spans:
        rows = value[(trace.time >= begin) & (trace.time <= end)]
        moved = max(float(np.ptp(rows)) if rows.size else 0.0, LEAST_EXCURSION * size)
        if moved > 0.0:
            longer = float(trace.time[-1] - trace.time[0]) / float(end - begin)
            largest = max(largest, float(np.sqrt(longer)) * size / moved)
    return largest


def parting_time(run: Trace, reference: Trace, tolerance: float, column: str = "force") -> float | None:
    """First time at which two runs differ by more than a tolerance, relative to the largest of the second.

    ``None`` if they never do, or share no interval of time.
    """
    grid = _common_times(run.time, reference.time)
    if grid.size < 2:
        return None
    second = column_curve(reference, column).within(grid)
    gap = np.abs(column_curve(run, column).within(grid) - second)
    apart = (gap > tolerance * float(np.abs(second).max())) & (_interval_lengths(grid) > 0.0)
    where = np.flatnonzero(apart.any(axis=0))
    if where.size == 0:
        return None
    i = int(where[0])
    return float(grid[i] + POINTS[np.argmax(apart[:, i])] * (grid[i + 1] - grid[i]))


def _common_times(first: Array, second: Array, spans: Array | None = None) -> Array:
    """Times of both runs and the ends of windows, rising, within what both cover."""
    if first.size < 2 or second.size < 2:
        return np.empty(0)
    begin, end = max(first[0], second[0]), min(first[-1], second[-1])
    times = np.concatenate((first, second) if spans is None else (first, second, spans.ravel()))
    times = np.unique(times)
    return times[(times >= begin) & (times <= end)]


def _interval_lengths(grid: Array) -> Array:
    """Lengths of the intervals between times; zero where two times of one jump differ by rounding."""
    lengths = np.diff(grid)
    return np.where(lengths > SHORTEST * (grid[-1] - grid[0]), lengths, 0.0)


def _mean_magnitude(apart: Array) -> Array:
    """Mean of ``|d|`` over every interval, ``d`` straight between its points; shape of ``apart`` (5, n)."""
    left, right = apart[:-1], apart[1:]
    total = np.abs(left) + np.abs(right)
    crossing = left * right < 0
    mean = np.where(crossing, (left**2 + right**2) / (2.0 * np.where(total > 0, total, 1.0)), 0.5 * total)
    return np.diff(POINTS) @ mean


def _worst_window(
    grid: Array, apart: Array, values: Array, spans: Array, centred: bool = True
) -> MovementDistance | None:
    """The window in which ``apart`` is largest, relative to the excursion of ``values``.

    Both are at the points of every interval, shape (5, n - 1). ``centred`` leaves the mean of ``apart`` out.
    """
    h = _interval_lengths(grid)
    first, square = (np.concatenate(([0.0], np.cumsum(h * (WEIGHTS @ part)))) for part in (apart, apart**2))
    least = LEAST_EXCURSION * float(np.abs(values).max())
    lowest, highest = values.min(axis=0), values.max(axis=0)
    worst: MovementDistance | None = None
    for begin, end in np.clip(np.searchsorted(grid, spans), 0, grid.size - 1):
        length = float(grid[end] - grid[begin])
        if length <= 0.0:
            continue
        mean = (first[end] - first[begin]) / length if centred else 0.0
        moved = max(float(highest[begin:end].max() - lowest[begin:end].min()), least)
        rms = float(np.sqrt(max((square[end] - square[begin]) / length - mean**2, 0.0)))
        relative = rms / moved if moved > 0.0 else (np.inf if rms > 0.0 else 0.0)
        if worst is None or relative > worst.rms:
            worst = MovementDistance(relative, float(grid[begin]), float(grid[end]))
    return worst


def _smooth(secant: Array, step: Array, lasting: NDArray[np.bool_], largest: float) -> NDArray[np.bool_]:
    """Whether the curve passes each row without jump or corner, shape (n,); false at both ends.

    Intervals that are not ``lasting`` are jumps, ``largest`` is the largest magnitude of the column.
    """
    smooth = np.zeros(step.size + 1, bool)
    if step.size < 2:
        return smooth
    inner = lasting[1:] & lasting[:-1]
    change = np.where(inner, np.abs(np.diff(secant)), 0.0)
    shortest = np.where(inner, np.minimum(step[1:], step[:-1]), 1.0)
    certain = np.maximum(change - 8.0 * np.finfo(float).eps * largest / shortest, 0.0)
    bend = certain / np.where(inner, 0.5 * (step[1:] + step[:-1]), 1.0)
    before, after = np.append(0.0, bend[:-1]), np.append(bend[1:], 0.0)
    smooth[1:-1] = inner & (change <= CORNER * 0.5 * (before * step[:-1] + after * step[1:]))
    return smooth


def _inner_slopes(secant: Array, step: Array) -> tuple[Array, Array]:
    """Three-point and harmonic slopes at every row, shape (n,); zero at both ends and at jumps."""
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
    least, most = _slope_limits(secant, step)
    three_point[1:-1] = np.clip((h1 * before + h0 * after) / total, least, most)
    return three_point, harmonic


def _slope_limits(secant: Array, step: Array) -> tuple[Array, Array]:
    """Range of the slopes at inner rows, shape (n - 2,), within the limits of the intervals on both sides.

    These are 0 and three times the secant, between which a curve rises or falls throughout; wider by what the
    smaller bend of both rows adds to the secant over the interval, if both bend the same way.
    """
    total = step[1:] + step[:-1]
    bend = np.where(total > 0.0, 2.0 * np.diff(secant) / np.where(total > 0.0, total, 1.0), 0.0)
    before, after = np.append(0.0, bend), np.append(bend, 0.0)
    more = np.where(before * after > 0.0, np.minimum(np.abs(before), np.abs(after)), 0.0) * step
    least, most = (
        pick(pick(3.0 * secant, 0.0), secant + sign * more)
        for pick, sign in ((np.minimum, -1.0), (np.maximum, 1.0))
    )
    return np.maximum(least[1:], least[:-1]), np.minimum(most[1:], most[:-1])


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
