"""Jumps of the recorded force, where contact snaps in or is lost between two rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from validation.fits.record import MeasuredCurve

JUMP = 8.0
"""Deviations of the noise from which the change between two rows may be a jump, and is not compared."""
JUMP_OVER_NEIGHBOURS = 3.0
"""The same over the change beside it on the side in contact, from which it is one for certain: a smooth curve
has them about equal."""


@dataclass(frozen=True)
class Jump:
    """A jump of the force between two rows.

    Parameters
    ----------
    row : int
        The last row before it.
    time, deviation : float
        Middle of the interval, and standard deviation of a moment somewhere in it.
    timed : bool
        Whether contact begins or ends in this interval for certain: where the force is as steep beside it, it
        may have come to nothing on a continuous curve.
    """

    row: int
    time: float
    deviation: float
    timed: bool = True


def jump_behind(curve: MeasuredCurve, row: int, noise: float, inward: int) -> Jump | None:
    """The jump behind a row, if the force jumps there.

    Parameters
    ----------
    curve : MeasuredCurve
    row : int
        Last row before it.
    noise : float
    inward : int
        1 if contact lies behind the jump, -1 if before.

    Returns
    -------
    Jump or None
    """
    force, time = curve.force, curve.time
    beside = row + 1 if inward > 0 else row - 1
    if row < 0 or beside < 0 or max(row, beside) + 1 >= force.size:
        return None
    change, neighbour = abs(force[row + 1] - force[row]), abs(force[beside + 1] - force[beside])
    if change < JUMP * noise:
        return None
    width = float(time[row + 1] - time[row])
    timed = bool(change >= JUMP_OVER_NEIGHBOURS * (neighbour + noise))
    return Jump(row, float(0.5 * (time[row] + time[row + 1])), width / float(np.sqrt(12.0)), timed)
