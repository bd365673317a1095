"""What a record shows before any model: beginning and end of contact, baseline, noise, jumps of the force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.fits.contact import white_noise
from validation.fits.jumps import JUMP, Jump, jump_behind
from validation.fits.record import Array, MeasuredCurve

CONTACT = 6.0
"""Deviations of the noise from which a row lies off the baseline: below one in 10^8 rows by chance."""
IN_A_ROW = 3
"""Rows off the baseline, one after the other, with which contact begins: one alone may be a disturbance."""
ENOUGH_ROWS = 20
"""Rows of a baseline from which its standard deviation is known to a sixth."""
EXCLUDED = 2
"""Rows on both sides of a jump that are not compared: between them the force tells the moment of the jump
only, for which there is a residual of its own, and the force would make misfit a step function of it."""
LEAST_NOISE = 1e-6
"""Noise over the range of the force, at least: of records without noise, so that weights remain finite."""
JUMP_SHARE, LEFT = 0.25, 0.15
"""A jump behind the least force is the loss of contact if it takes a quarter of it, and leaves less than
15 %, which rings down or creeps away without contact."""
MEDIAN_EFFICIENCY = 0.37
"""Variance of the standard deviation over that of the median magnitude, both of as many normal numbers."""


@dataclass(frozen=True)
class CurveFeatures:
    """What a record shows of itself.

    Parameters
    ----------
    noise : float
        Standard deviation of the force.
    noise_degrees : float
        Degrees of freedom from which it is known; infinite if it was stated.
    noise_source : str
        Where it comes from, in words.
    baseline, drift : float
        Force without contact at the first row, and its change over time.
    first, last : int
        First row in contact, and the row after the last; ``last`` is the number of rows if contact is not
        seen to end, ``first`` equals ``last`` if there is no contact.
    snap_in, pull_off : Jump or None
    """

    noise: float
    noise_degrees: float
    noise_source: str
    baseline: float
    drift: float
    first: int
    last: int
    snap_in: Jump | None
    pull_off: Jump | None

    def compared(self, rows: int) -> NDArray[np.bool_]:
        """Which rows are compared with a model, shape (rows,): all but those around the jumps."""
        kept = np.ones(rows, bool)
        for jump in (self.snap_in, self.pull_off):
            if jump is not None:
                kept[max(jump.row + 1 - EXCLUDED, 0) : jump.row + 1 + EXCLUDED] = False
        return kept

    def contact(self, rows: int) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which rows are in contact, and of which this is certain by a jump, shape (rows,) each."""
        place = np.arange(rows)
        recorded = (place >= self.first) & (place < self.last)
        known = np.zeros(rows, bool)
        if self.snap_in is not None and self.snap_in.timed:
            known |= place <= (self.first + self.last) // 2
        if self.pull_off is not None and self.pull_off.timed:
            known |= place > (self.first + self.last) // 2
        return recorded, known


def features(curve: MeasuredCurve) -> CurveFeatures:
    """Read them off a curve."""
    force, time = curve.force, curve.time
    least = LEAST_NOISE * float(np.ptp(force))
    noise = max(white_noise(force), least)
    level = float(np.median(force[: max(IN_A_ROW, force.size // 50)]))
    first = _leaves(np.abs(force - level) > CONTACT * noise)
    leading = np.arange(_free_rows(force - level, first))
    if leading.size < IN_A_ROW:  # in contact from the first row on: the end tells the level, or nothing does
        end = float(np.median(force[-max(IN_A_ROW, force.size // 50) :]))
        flat = float(np.abs(force[-IN_A_ROW:] - end).max()) <= CONTACT * noise
        level, first = (end, 0) if flat else (0.0, 0)
    last = force.size - _leaves((np.abs(force - level) > CONTACT * noise)[::-1])
    last = max(last, first)
    free = _free_rows((force - level)[::-1], force.size - last)
    trailing = np.arange(force.size - free, force.size)
    outside = np.concatenate([_undisturbed(force, leading, noise), _undisturbed(force, trailing, noise)])
    baseline, drift, source = level, 0.0, "differences of neighbouring rows"
    degrees = MEDIAN_EFFICIENCY * force.size
    if outside.size >= ENOUGH_ROWS:
        baseline, drift, spread = _line(time[outside] - time[0], force[outside])
        noise, source = max(spread, least), f"baseline, {outside.size} rows"
        degrees = outside.size - 2.0
    if curve.noise is not None:
        noise, source, degrees = curve.noise, "stated", np.inf
    if first < last < force.size:
        last = _before_ring_down(force - baseline, first, last, noise)
    snap_in = jump_behind(curve, first - 1, noise, 1) if first > 0 else None
    pull_off = jump_behind(curve, last - 1, noise, -1) if last < force.size else None
    return CurveFeatures(noise, degrees, source, baseline, drift, first, last, snap_in, pull_off)


def _before_ring_down(excess: Array, first: int, last: int, noise: float) -> int:
    """The row after the last in contact: where the force over the baseline jumps up behind its least, unless
    a sizeable share of that is left behind the jump."""
    lowest = first + int(np.argmin(excess[first:last]))
    rises = np.diff(excess[lowest : last + 1])
    behind = lowest + int(np.argmax(rises)) + 1
    jumps = rises.max() > max(JUMP * noise, -JUMP_SHARE * excess[lowest])
    rings = np.abs(excess[behind:last]).max(initial=0.0) < -LEFT * excess[lowest]
    return behind if jumps and rings else last


def _leaves(off: NDArray[np.bool_]) -> int:
    """The first of ``IN_A_ROW`` rows off the baseline; the number of rows if there are none."""
    run = np.convolve(off, np.ones(IN_A_ROW, int), mode="valid") == IN_A_ROW
    return int(np.argmax(run)) if run.any() else off.size


def _undisturbed(force: Array, rows: NDArray[np.intp], noise: float) -> NDArray[np.intp]:
    """The rows but for those where the mean of ``IN_A_ROW`` shows a contact too weak for a single row.

    A tip may snap in softly and come through zero force soon after; the mean of n rows has the noise over
    the root of n.
    """
    if rows.size < ENOUGH_ROWS:
        return rows
    excess = force[rows] - np.median(force[rows])
    means = np.convolve(excess, np.full(IN_A_ROW, 1.0 / IN_A_ROW), mode="valid")
    off = np.abs(means) > CONTACT * noise / np.sqrt(IN_A_ROW)
    return rows[np.convolve(off, np.ones(IN_A_ROW), mode="full") == 0.0]


def _free_rows(excess: Array, first: int) -> int:
    """Rows before contact in which its beginning cannot be seen yet, nor hide in the noise.

    From the first row off the baseline back to the last one on its other side contact may have been; and, as
    its force grows from nothing, as far again before that.

    Parameters
    ----------
    excess : ndarray, shape (N,)
        Force over the baseline.
    first : int
        First row off it.

    Returns
    -------
    int
    """
    if not 0 < first < excess.size:
        return first
    other = np.flatnonzero(excess[:first] * np.sign(excess[first]) < 0.0)
    flip = int(other[-1]) if other.size else 0
    return max(2 * flip + 1 - first, 0)


def _line(time: Array, force: Array) -> tuple[float, float, float]:
    """Level at time zero, slope and standard deviation about the line."""
    slope, level = np.polyfit(time, force, 1)
    spread = force - level - slope * time
    deviation = float(np.sqrt(np.sum(spread**2) / (force.size - 2)))
    middle = time - time.mean()
    if abs(slope) < 3.0 * deviation / float(np.sqrt(np.sum(middle**2))):  # no slope that can be seen
        return float(force.mean()), 0.0, float(np.std(force, ddof=1))
    return float(level), float(slope), deviation
