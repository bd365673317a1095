"""What a fit asks of a record: when contact begins and ends, noise and background, its motion as few lines.

On the retraction contact is lost; on the approach, read backwards in time, it is lost too. Where the force
jumps there, its moment lies between two rows. All other rows without contact share one background.

A solver follows the motion as straight lines: recorded positions have noise, and every row would be a kink of
the loading. The lines begin with the rows that Ramer (Comput. Graph. Image Process. 1, 244, 1972) keeps
within a tolerance; a corner between two straight stretches moves to where they meet, and all heights are then
those of least squares.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from contact_scene.errors import SceneError
from validation.fits.contact import Array, white_noise
from validation.fits.features import FEWEST, JUMP, background, loss_of_contact
from validation.fits.record import MeasuredCurve

OVER_NEIGHBOURS = 3.0
"""Change between two rows over that beside it on the side in contact, from which it is a jump for certain: a
smooth curve has them about equal."""
OFF = 4.0
"""Deviations of the noise from which a row is off the background: one in 16 000 by chance."""
EXCLUDED, FEWEST_ROWS = 2, 6
"""Rows on both sides of a jump that are not compared, as the moment of the jump has a residual of its own;
and of an approach or a retraction in which a moment is looked for."""
LEAST_NOISE, MEDIAN_EFFICIENCY = 1e-6, 0.37
"""Noise over the range of the force, at least, so that weights remain finite; and variance of the standard
deviation over that of the median magnitude, both of as many normal numbers."""

NOISE_WITHIN = 4.0
"""Deviations of the noise by which a row may miss its line: one in 16 000 by chance."""
SMALLEST = 1e-6
"""Tolerance over the range of the motion, at least: round-off of recorded numbers."""
CORNER_ROWS = 3
"""Rows between two straight stretches, at most, that belong to one corner; and rows inside a stretch, at
least, from which its direction is known well enough to find its corners."""
MOST_KNOTS = 400
"""Lines of a path; a motion that needs more is not resolved by its rows, or is all noise."""


@dataclass(frozen=True)
class Jump:
    """A jump of the force behind ``row``: the middle of its interval, the standard deviation of a moment in
    it, and whether contact begins or ends there for certain, or came to nothing on a steep, smooth curve."""

    row: int
    time: float
    deviation: float
    timed: bool = True


@dataclass(frozen=True)
class Moments:
    """What a record shows of itself: ``first`` row in contact, and the row after the ``last``; the force
    without contact of every row; degrees of freedom from which the noise is known, infinite if stated."""

    noise: float
    noise_degrees: float
    noise_source: str
    background: Array
    first: int
    last: int
    snap_in: Jump | None
    pull_off: Jump | None

    @property
    def has_free_rows(self) -> bool:
        """Whether contact is seen to begin or to end."""
        return self.first > 0 or self.last < self.background.size

    @property
    def compared(self) -> NDArray[np.bool_]:
        """Which rows are compared with a model, shape (N,): all but those around the jumps."""
        kept = np.ones(self.background.size, bool)
        for jump in filter(None, (self.snap_in, self.pull_off)):
            kept[max(jump.row + 1 - EXCLUDED, 0) : jump.row + 1 + EXCLUDED] = False
        return kept

    @property
    def timed(self) -> list[tuple[bool, Jump]]:
        """Jumps whose moments are compared, and whether contact begins there."""
        both = ((True, self.snap_in), (False, self.pull_off))
        return [(begins, jump) for begins, jump in both if jump is not None and jump.timed]

    @property
    def contact(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which rows are in contact, and of which this is certain by a jump, shape (N,) each."""
        place, begins = np.arange(self.background.size), [begins for begins, _ in self.timed]
        recorded = (place >= self.first) & (place < self.last)
        return recorded, np.where(2 * place <= self.first + self.last, True in begins, False in begins)


def moments(curve: MeasuredCurve) -> Moments:
    """Read them off a curve."""
    cycle, force, rows = curve.cycle, curve.force, curve.time.size
    least = LEAST_NOISE * float(np.ptp(force))
    noise, source = max(white_noise(force), least), "differences of neighbouring rows"
    degrees = MEDIAN_EFFICIENCY * rows

    def lost(part: NDArray[np.intp], never: int) -> int:
        enough = part.size >= FEWEST_ROWS
        row = loss_of_contact(curve.position[part], force[part], noise)[0] if enough else None
        return never if row is None else int(part[row])

    first, last = lost(cycle.approach[::-1], -1) + 1, lost(cycle.retraction, rows)
    snap_in, pull_off = _jump(curve, first - 1, noise, 1), _jump(curve, last - 1, noise, -1)
    free = np.zeros(rows, bool)
    free[: first if snap_in else _free_rows(force[:first])] = True
    free[last if pull_off else rows - _free_rows(force[last:][::-1]) :] = True
    base = background(cycle, free)
    if free.sum() > FEWEST:
        degrees = float(free.sum() - len(base.parts))
        noise = max(base.rough * float(np.sqrt(free.sum() / degrees)), least)
        source = f"baseline, {free.sum()} rows"
    if curve.noise is not None:
        noise, source, degrees = curve.noise, "stated", np.inf
    level = base.force if free.any() else np.zeros(rows)
    off = np.abs(force - level) > OFF * noise
    while snap_in is None and 0 < first < last and off[first - 1]:
        first -= 1
    while pull_off is None and first < last < rows and off[last]:
        last += 1
    return Moments(noise, degrees, source, level, first, last, snap_in, pull_off)


def _free_rows(force: Array) -> int:
    """Rows of a baseline in which the smooth contact that begins behind it cannot hide in the noise: not back
    to the last row on the other side of the level, nor as far again before that."""
    if force.size < FEWEST_ROWS:
        return 0
    over = force - float(np.median(force[: force.size // 2]))
    other = np.flatnonzero(over * over[-1] < 0.0)
    return max(2 * int(other[-1]) + 1 - force.size, 0) if other.size else 0


def _jump(curve: MeasuredCurve, row: int, noise: float, inward: int) -> Jump | None:
    """The jump behind a row, the last before it, if the force jumps there; contact lies ``inward``."""
    force, time = curve.force, curve.time
    if not 0 <= row < force.size - 1 or not 0 <= row + inward < force.size - 1:
        return None
    change, neighbour = (abs(force[at + 1] - force[at]) for at in (row, row + inward))
    if change < JUMP * noise:
        return None
    width = float(time[row + 1] - time[row])
    timed = bool(change >= OVER_NEIGHBOURS * (neighbour + noise))
    return Jump(row, float(0.5 * (time[row] + time[row + 1])), width / float(np.sqrt(12.0)), timed)


def straight_lines(time: Array, position: Array, tolerance: float) -> tuple[Array, Array]:
    """Times and heights of the corners of a path that no row misses by more than tolerance and noise."""
    noise = white_noise(position)
    within = max(tolerance, NOISE_WITHIN * noise, SMALLEST * float(np.ptp(position)))
    rows = _kept_rows(time, position, within)
    if rows.size > MOST_KNOTS:
        problem = f"the motion needs {rows.size} straight lines"
        raise SceneError("penetration", problem, f"at most {MOST_KNOTS}: smoother or finer rows")
    knots = _moved_corners(time, position, rows)
    return knots, _heights(time, position, knots)


def count_lines(time: Array, values: Array, share: float) -> int:
    """How many straight lines a column needs, within a share of its range and its noise."""
    within = max(share * float(np.ptp(values)), NOISE_WITHIN * white_noise(values))
    return _kept_rows(time, values, within).size - 1


def _kept_rows(time: Array, position: Array, within: float) -> np.ndarray:
    keep, stack = {0, time.size - 1}, [(0, time.size - 1)]
    while stack:
        begin, end = stack.pop()
        line = np.interp(time[begin:end], time[[begin, end]], position[[begin, end]])
        miss = np.abs(position[begin:end] - line)
        worst = begin + int(np.argmax(miss))
        if miss[worst - begin] > within:
            keep.add(worst)
            stack += [(begin, worst), (worst, end)]
    return np.array(sorted(keep))


def _moved_corners(time: Array, position: Array, rows: np.ndarray) -> Array:
    """Times of the corners: where two straight stretches meet, if that is among the rows between them."""
    stretches: list[tuple[int, int, float, float]] = []
    for begin, end in pairwise(rows.tolist()):
        inner = slice(begin + 1, end)
        if end - begin - 1 >= CORNER_ROWS:
            middle = float(time[inner].mean())
            rate, level = np.polyfit(time[inner] - middle, position[inner], 1)
            stretches.append((begin, end, float(rate), float(level) - float(rate) * middle))
    knots = dict.fromkeys(rows.tolist())
    moved = []
    for (_, left, rate, level), (right, _, next_rate, next_level) in pairwise(stretches):
        turn = rate - next_rate
        meeting = (next_level - level) / turn if turn else np.inf
        if right - left <= CORNER_ROWS and time[left - 1] <= meeting <= time[right + 1]:
            for row in range(left, right + 1):
                knots.pop(row, None)
            moved.append(meeting)
    return np.sort(np.concatenate([time[list(knots)], moved]))


def _heights(time: Array, position: Array, knots: Array) -> Array:
    """Heights at the knots with which the lines miss the rows least; as recorded where no row tells."""
    hats = np.array([np.interp(time, knots, hat) for hat in np.eye(knots.size)])
    recorded = np.interp(knots, time, position)
    moved = np.linalg.lstsq(hats @ hats.T, hats @ (position - recorded @ hats), rcond=None)[0]
    return np.asarray(recorded + moved, float)
