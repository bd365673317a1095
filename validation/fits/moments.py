"""When contact begins and ends in a record, what the force is without it, and its noise.

On the retraction contact is lost; on the approach, read backwards in time, it is lost too. Where the force
jumps there, its moment lies between two rows. All other rows without contact share one background.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validation.fits.background import FEWEST, background, loss_of_contact
from validation.fits.contact import Array, white_noise
from validation.fits.record import MeasuredCurve

JUMP = 8.0
"""Deviations of the noise from which the change between two rows may be a jump, and is not compared."""
OVER_NEIGHBOURS = 3.0
"""The same over the change beside it on the side in contact, from which it is one for certain: a smooth curve
has them about equal."""
OFF = 4.0
"""The same from which a row is off the background: one in 16 000 by chance."""
EXCLUDED, FEWEST_ROWS = 2, 6
"""Rows on both sides of a jump that are not compared, as the moment of the jump has a residual of its own;
and of an approach or a retraction in which a moment is looked for."""
LEAST_NOISE, MEDIAN_EFFICIENCY = 1e-6, 0.37
"""Noise over the range of the force, at least, so that weights remain finite; and variance of the standard
deviation over that of the median magnitude, both of as many normal numbers."""


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
        for jump in (self.snap_in, self.pull_off):
            if jump is not None:
                kept[max(jump.row + 1 - EXCLUDED, 0) : jump.row + 1 + EXCLUDED] = False
        return kept

    @property
    def contact(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which rows are in contact, and of which this is certain by a jump, shape (N,) each."""
        place, middle = np.arange(self.background.size), (self.first + self.last) // 2
        recorded = (place >= self.first) & (place < self.last)
        early, late = (jump is not None and jump.timed for jump in (self.snap_in, self.pull_off))
        return recorded, np.where(place <= middle, early, late)


def moments(curve: MeasuredCurve) -> Moments:
    """Read them off a curve."""
    cycle, force, rows = curve.cycle, curve.force, curve.time.size
    least = LEAST_NOISE * float(np.ptp(force))
    noise, source = max(white_noise(force), least), "differences of neighbouring rows"
    degrees = MEDIAN_EFFICIENCY * rows
    first, last = 0, rows
    if cycle.approach.size >= FEWEST_ROWS:
        inward = cycle.approach[::-1]
        begin = loss_of_contact(curve.position[inward], force[inward], noise).row
        first = 0 if begin is None else int(inward[begin]) + 1
    if cycle.retraction.size >= FEWEST_ROWS:
        outward = cycle.retraction
        end = loss_of_contact(curve.position[outward], force[outward], noise).row
        last = rows if end is None else int(outward[end])
    snap_in, pull_off = _jump(curve, first - 1, noise, 1), _jump(curve, last - 1, noise, -1)
    free = np.zeros(rows, bool)
    free[: first if snap_in else _free_rows(force[:first])] = True
    free[last if pull_off else rows - _free_rows(force[last:][::-1]) :] = True
    level = np.full(rows, float(np.median(force[free])) if free.any() else 0.0)
    if free.sum() > FEWEST:
        base = background(cycle, free)
        degrees = float(free.sum() - len(base.parts))
        noise = max(base.rough * float(np.sqrt(free.sum() / degrees)), least)
        level, source = base.force, f"baseline, {free.sum()} rows"
    if curve.noise is not None:
        noise, source, degrees = curve.noise, "stated", np.inf
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
