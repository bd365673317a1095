"""The last committed rows, and what they predict for the next step."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial

from validation.reference.tracking.row_extrapolation import RowExtrapolation
from validation.reference.tracking.zone_from_turn import RootExtrapolation

LENGTH = 4
"""Rows in the history: enough for a cubic extrapolation."""
FARTHEST = 1e3
"""Distance of a row from an interval, in its lengths, beyond which it says nothing about a curve there."""
TIME, RADIUS, FORCE, PENETRATION = range(4)
HistoryRow = tuple[float, float, float, float]


@dataclass
class StepHistory:
    """Rows since the last kink (time, radius, force, penetration), at most ``LENGTH``.

    ``before_root``: rows up to the last one at which the edge was one zone from its turn, while they matter.
    """

    rows: list[HistoryRow] = field(default_factory=list)
    before_root: list[HistoryRow] = field(default_factory=list)

    def add(self, row: HistoryRow) -> None:
        """Append a row; earlier rows at the same time give no rates and are dropped."""
        if self.rows and self.rows[-1][TIME] == row[TIME]:
            self.rows.clear()
            self.before_root.clear()
        self.rows.append(row)
        del self.rows[:-LENGTH]
        if self.before_root:
            first, last = (self.rows[i][TIME] - self.before_root[-1][TIME] for i in (0, -1))
            if first >= last - first:  # farther away than the rows reach: any polynomial follows
                self.before_root.clear()

    def kink(self) -> None:
        """Keep the present row only: rates jump here."""
        del self.rows[:-1]
        self.before_root.clear()

    def rates_follow_root(self) -> None:
        """From the present row on, rates change as the root of the time."""
        self.before_root = list(self.rows)

    @property
    def restarted(self) -> bool:
        """Whether there has been no step since the last kink."""
        return len(self.rows) < 2

    def extrapolation(self, column: int) -> RowExtrapolation:
        """Polynomial through the rows of a column."""
        now = self.rows[-1][TIME]
        return RowExtrapolation(
            tuple(row[TIME] - now for row in reversed(self.rows)),
            tuple(row[column] for row in reversed(self.rows)),
        )

    def expectation(self, column: int) -> RowExtrapolation | RootExtrapolation:
        """Extrapolation of a column, over the root of the time where that is the smooth variable."""
        if not self.before_root:
            return self.extrapolation(column)
        begin = self.before_root[-1][TIME]
        before = RowExtrapolation(
            tuple(row[TIME] - begin for row in reversed(self.before_root)),
            tuple(row[column] for row in reversed(self.before_root)),
        )
        roots, changes = [], []
        for row in reversed(self.rows):
            after = row[TIME] - begin
            if after <= 0.0:
                roots.append(0.0)
                changes.append(0.0)
                break
            roots.append(math.sqrt(after))
            changes.append((row[column] - before.value_after(after)) / after)
        since = self.rows[-1][TIME] - begin
        return RootExtrapolation(before, since, RowExtrapolation(tuple(roots), tuple(changes)))

    def time_missed(self, row: HistoryRow) -> float:
        """Distance in time of ``row`` from the parabola of the time over the radius; 0 if the edge turned."""
        if not self.continues_monotonically(row, RADIUS):
            return 0.0
        last = self.rows[-3:][::-1]
        radii = tuple(earlier[RADIUS] - last[0][RADIUS] for earlier in last)
        times = RowExtrapolation(radii, tuple(earlier[TIME] - last[0][TIME] for earlier in last))
        return abs(row[TIME] - last[0][TIME] - times.value_after(row[RADIUS] - last[0][RADIUS]))

    def time_over_radius(self) -> RowExtrapolation:
        """Time over the radius, both from the last row, by the rows since the edge last turned."""
        now, distances, times = self.rows[-1], [0.0], [0.0]
        for row in reversed(self.rows[:-1]):
            distance = row[RADIUS] - now[RADIUS]
            if (distance - distances[-1]) * (self.rows[-2][RADIUS] - now[RADIUS]) <= 0.0:
                break
            distances.append(distance)
            times.append(row[TIME] - now[TIME])
        return RowExtrapolation(tuple(distances), tuple(times))

    def rate_of_radius(self) -> float:
        """Rate of the radius at the last row."""
        return self._rate(RADIUS)

    def _rate(self, column: int) -> float:
        if self.restarted:
            return 0.0
        before, now = self.rows[-2:]
        h = now[TIME] - before[TIME]
        rate = (now[column] - before[column]) / h
        return rate + 0.5 * self._second_derivative(column, TIME) * h if len(self.rows) > 2 else rate

    def distance_to_extremum(self, column: int, along: int = TIME) -> float:
        """Signed distance from the last row to an extremum of a column, by a parabola; or infinite."""
        if len(self.rows) < 3 or not self._monotone(along):
            return math.inf
        before, now = self.rows[-2:]
        h, second = now[along] - before[along], self._second_derivative(column, along)
        return -(now[column] - before[column]) / h / second - 0.5 * h if second != 0.0 else math.inf

    def limited_to_extremum(self, h: float, noise: Mapping[int, float]) -> float:
        """A duration ``h`` cut to end at an extremum of the columns in ``noise``, one after the other.

        A column that changes by less than its noise until its extremum counts as constant: where that
        extremum lies is a matter of rounding.
        """
        for column, least in noise.items():
            extremum = self.distance_to_extremum(column)
            if 0.1 * h < extremum < h and abs(self._rate(column)) * extremum >= least:
                h = extremum
        return h

    def extremum_within(self, column: int, back: int, least: float) -> tuple[float, float] | None:
        """Time of an extremum of a column in one interval between rows, and the length of the interval.

        Zero of the derivative of the polynomial through the rows nearby.

        Parameters
        ----------
        column : int
        back : int
            Which interval, counted back from the last, which is 1.
        least : float
            Least distance of the extremum from the values at the ends of the interval.

        Returns
        -------
        tuple of float or None
            ``None`` if there is none, or none that far.
        """
        rises = [later[column] - earlier[column] for earlier, later in pairwise(self.rows)]
        if len(self.rows) <= back or min(rises) >= 0.0 or max(rises) <= 0.0:
            return None
        first, last = self.rows[-back - 1], self.rows[-back]
        h = last[TIME] - first[TIME]
        near = [row for row in self.rows if abs(row[TIME] - first[TIME]) <= FARTHEST * h]
        if len(near) < 3:
            return None
        shares = np.array([(row[TIME] - first[TIME]) / h for row in near])
        values = np.array([row[column] - first[column] for row in near])
        curve = Polynomial(np.linalg.solve(np.vander(shares, increasing=True), values))
        slope = curve.deriv()
        if float(slope(0.0)) * float(slope(1.0)) >= 0.0:
            return None
        share = float(min(np.real(slope.roots()), key=lambda root: abs(root - 0.5)))
        extremum = float(curve(share))
        if min(abs(extremum), abs(extremum - last[column] + first[column])) <= least:
            return None
        return first[TIME] + share * h, h

    def chord_deviation(self, row: HistoryRow, along: int = TIME) -> dict[int, float]:
        """Largest distance of radius, force and penetration from the straight line on the way to ``row``."""
        columns = (RADIUS, FORCE, PENETRATION)
        if not self.continues_monotonically(row, along):
            return dict.fromkeys(columns, 0.0)
        before, now = self.rows[-2:]
        h, last = row[along] - now[along], now[along] - before[along]
        share = 0.25 * h / (h + last)
        return {c: share * abs(row[c] - now[c] - (now[c] - before[c]) * h / last) for c in columns}

    def continues_monotonically(self, row: HistoryRow, along: int) -> bool:
        """Whether a column has risen, or fallen, throughout and goes on to do so in the step to ``row``."""
        if self.restarted or not self._monotone(along):
            return False
        before, now = self.rows[-2:]
        return (row[along] - now[along]) * (now[along] - before[along]) > 0.0

    def _monotone(self, along: int) -> bool:
        steps = [later[along] - earlier[along] for earlier, later in pairwise(self.rows[-3:])]
        return min(steps) > 0.0 or max(steps) < 0.0

    def _second_derivative(self, column: int, along: int) -> float:
        (t0, t1, t2), (y0, y1, y2) = ([row[i] for row in self.rows[-3:]] for i in (along, column))
        return 2.0 * ((y2 - y1) / (t2 - t1) - (y1 - y0) / (t1 - t0)) / (t2 - t0)
