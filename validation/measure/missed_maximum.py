"""The largest value of a column, which rows locate roughly: by how much they miss it, and where it may be.

Around its maximum a column is a concave curve, smooth or with a corner; four rows bound what such a curve may
do between the two in the middle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contact_scene import Trace
from contact_scene.trace import Array
from validation.measure.round_off import ROUND_OFF


@dataclass(frozen=True)
class MissedMaximum:
    """What a column may do between the rows beside its largest value.

    Parameters
    ----------
    excess : float
        By how much it may exceed that value; 0 where it is located to round-off.
    begin, end : float
        Times between which it may be larger.
    """

    excess: float
    begin: float
    end: float

    def away(self, trace: Trace, column: Array, row: int) -> float:
        """Farthest that a column goes from the row between these times, straight between rows.

        Parameters
        ----------
        trace : Trace
        column : ndarray, shape (n,)
        row : int
            That of the largest value.

        Returns
        -------
        float
        """
        time, distances = trace.time, [0.0]
        if self.begin < time[row]:
            share = (time[row] - self.begin) / (time[row] - time[row - 1])
            distances.append(share * abs(float(column[row] - column[row - 1])))
        if self.end > time[row]:
            share = (self.end - time[row]) / (time[row + 1] - time[row])
            distances.append(share * abs(float(column[row + 1] - column[row])))
        return max(distances)


def missed_maximum(trace: Trace, values: Array, row: int, corner: bool = False) -> MissedMaximum:
    """Where between the rows beside its largest value a column may exceed it, and by how much.

    Between two rows a concave curve lies below the straight lines through the two rows before and through the
    two rows after. Where the maximum is located, at a corner or at the end of the contact, these lines meet
    in it, to round-off. At a corner that is known to be one, the lines beyond it say nothing: on a side on
    which the slope, extrapolated to the corner, leads up to it, there is no larger value.

    Parameters
    ----------
    trace : Trace
    values : ndarray, shape (n,)
        The column.
    row : int
        That of its largest value.
    corner : bool
        Whether the maximum is known to be a corner.

    Returns
    -------
    MissedMaximum
    """
    end = int(np.flatnonzero(trace.contact_radius > 0.0)[-1]) + 1
    time, values = trace.time[:end], values[:end]
    largest, most = float(values[row]), float(values[row])
    span = [float(time[row]), float(time[row])]

    def slope(first: int) -> float | None:
        if first < 0 or first + 1 >= end or time[first + 1] <= time[first]:
            return None
        return float((values[first + 1] - values[first]) / (time[first + 1] - time[first]))

    for side, first in enumerate((row - 1, row)):
        if slope(first) is None:
            continue
        h = float(time[first + 1] - time[first])
        left, right = float(values[first]), float(values[first + 1])
        before, after = slope(first - 1), slope(first + 1)
        top, reach = largest, h
        if corner and _leads_up(trace.time, values, row, first):
            continue
        if before is None and after is None:
            top = largest + 0.5 * abs(right - left)
        elif before is None or after is None:
            top = left + before * h if before is not None else right - (after or 0.0) * h
        elif before > after:
            at = min(max((right - left - after * h) / (before - after), 0.0), h)
            top = min(left + before * at, right - after * (h - at))
        if top <= largest + ROUND_OFF * abs(largest):
            continue
        rise = (before, -after if after is not None else None)[side]
        if rise is not None and rise > 0.0:
            reach = h - (largest - (left, right)[side]) / rise
        most = max(most, top)
        span[side] += (-1.0, 1.0)[side] * min(max(reach, 0.0), h)
    return MissedMaximum(most - largest, *span)


def reach_of_maximum(height: Array, column: Array, row: int, least: float) -> float:
    """How far a column goes from the row at the largest height to where the height is ``least``.

    Another peak that is hardly lower counts too: the run does not resolve which of the two is larger.

    Parameters
    ----------
    height, column : ndarray, shape (n,)
    row : int
    least : float

    Returns
    -------
    float
        In units of the column.
    """
    farthest = float(np.abs(column[height >= least] - column[row]).max())
    for side in (slice(row, None, -1), slice(row, None)):
        heights, values = height[side], column[side]
        below = np.flatnonzero(heights < least)
        last = int(below[0]) if below.size else len(heights) - 1
        if last == 0:
            continue
        drop = heights[last - 1] - heights[last]
        share = min((heights[last - 1] - least) / drop, 1.0) if below.size and drop > 0.0 else 1.0
        end = values[last - 1] + share * (values[last] - values[last - 1])
        farthest = max(farthest, abs(float(end - column[row])))
    return farthest


def _leads_up(time: Array, values: Array, row: int, first: int) -> bool:
    """Whether a column leads up to a row from the interval that starts at ``first``, by three rows."""
    near, far = (first, first - 1) if first < row else (first + 1, first + 2)
    if not (0 <= far < len(values) and time[near] != time[far]):
        return False
    inner = float(values[row] - values[near]) / float(time[row] - time[near])
    outer = float(values[near] - values[far]) / float(time[near] - time[far])
    slope = inner + (inner - outer) * float(time[row] - time[near]) / float(time[row] - time[far])
    return slope > 0.0 if first < row else slope < 0.0
