"""The last committed rows: what they say about the step to come."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

MEMORY = 4
TIME, RADIUS, FORCE, PENETRATION = range(4)
Row = tuple[float, float, float, float]


@dataclass(frozen=True)
class Course:
    """A quantity at the last rows, newest first; ``times`` count from the newest and are not positive."""

    times: tuple[float, ...] = (0.0,)
    values: tuple[float, ...] = (0.0,)

    def ahead(self, duration: float) -> float:
        """Value after ``duration``, by the polynomial through all rows."""
        differences = list(self.values)
        for order in range(1, len(differences)):
            for i in range(len(differences) - 1, order - 1, -1):
                gap = self.times[i] - self.times[i - order]
                differences[i] = (differences[i] - differences[i - 1]) / gap
        value = differences[-1]
        for time, difference in zip(self.times[-2::-1], differences[-2::-1], strict=True):
            value = difference + value * (duration - time)
        return value

    def curvature(self, duration: float, end: float) -> float:
        """Second derivative in the middle of a step to ``end``, by the polynomial through it and three rows.

        Linear in ``end``; zero where there is only one row, right after a kink.
        """
        if len(self.times) < 2 or duration == 0.0:
            return 0.0
        first, one = self.values[0], self.times[1]
        rise = (end - first) / duration
        behind = (first - self.values[1]) / -one
        bend = (rise - behind) / (duration - one)
        if len(self.times) == 2:
            return 2.0 * bend
        two = self.times[2]
        earlier = (behind - (self.values[1] - self.values[2]) / (one - two)) / -two
        return 2.0 * bend + (bend - earlier) / (duration - two) * (duration - 2.0 * one)


@dataclass
class Trail:
    """Rows since the last kink (time, radius, force, penetration), at most ``MEMORY``."""

    rows: list[Row] = field(default_factory=list)

    def add(self, row: Row) -> None:
        """Append a row; rows of an earlier moment at the same time are of no use for rates."""
        if self.rows and self.rows[-1][TIME] == row[TIME]:
            self.rows.clear()
        self.rows.append(row)
        del self.rows[:-MEMORY]

    def kink(self) -> None:
        """Forget all but the present row: rates jump here."""
        del self.rows[:-1]

    @property
    def fresh(self) -> bool:
        """Whether there has been no step since the last kink."""
        return len(self.rows) < 2

    def course(self, column: int) -> Course:
        """How a column has run so far."""
        now = self.rows[-1][TIME]
        return Course(
            tuple(row[TIME] - now for row in reversed(self.rows)),
            tuple(row[column] for row in reversed(self.rows)),
        )

    def rate_of_radius(self) -> float:
        """Rate of the radius at the last row."""
        if self.fresh:
            return 0.0
        before, now = self.rows[-2:]
        h = now[TIME] - before[TIME]
        rate = (now[RADIUS] - before[RADIUS]) / h
        return rate + 0.5 * self._second(RADIUS, TIME) * h if len(self.rows) > 2 else rate

    def to_extremum(self, column: int, along: int = TIME) -> float:
        """Time (or signed distance) from the last row until a column turns, by a parabola; else infinite."""
        if len(self.rows) < 3 or not self._monotone(along):
            return math.inf
        before, now = self.rows[-2:]
        h, second = now[along] - before[along], self._second(column, along)
        return -(now[column] - before[column]) / h / second - 0.5 * h if second != 0.0 else math.inf

    def up_to_turn(self, h: float, noise: float) -> float:
        """``h``, but not beyond where the force is largest, nor where the edge turns round.

        A radius that moves by less than ``noise`` until then is at rest.
        """
        turn = self.to_extremum(FORCE)
        if 0.1 * h < turn < h:
            h = turn
        turn = self.to_extremum(RADIUS)
        if not 0.1 * h < turn < h or abs(self.rate_of_radius()) * turn < noise:
            return h
        return turn

    def turned(self, column: int) -> tuple[int, float] | None:
        """When a column was largest or smallest in the last two steps, and in which (-2 or -1), if it was."""
        if len(self.rows) < 3:
            return None
        one, two, now = self.rows[-3:]
        if (two[column] - one[column]) * (now[column] - two[column]) >= 0.0:
            return None
        h = two[TIME] - one[TIME]
        at = one[TIME] + 0.5 * h - (two[column] - one[column]) / h / self._second(column, TIME)
        return (-2 if at < two[TIME] else -1), at

    def sag(self, row: Row, along: int = TIME) -> dict[int, float]:
        """How far radius, force and penetration leave a straight line on the way to ``row``."""
        columns = (RADIUS, FORCE, PENETRATION)
        if not self.heads_for(row, along):
            return dict.fromkeys(columns, 0.0)
        before, now = self.rows[-2:]
        h, last = row[along] - now[along], now[along] - before[along]
        share = 0.25 * h / (h + last)
        return {c: share * abs(row[c] - now[c] - (now[c] - before[c]) * h / last) for c in columns}

    def heads_for(self, row: Row, along: int) -> bool:
        """Whether a column has been going, and goes on, one way."""
        if self.fresh or not self._monotone(along):
            return False
        before, now = self.rows[-2:]
        return (row[along] - now[along]) * (now[along] - before[along]) > 0.0

    def _monotone(self, along: int) -> bool:
        steps = [later[along] - earlier[along] for earlier, later in pairwise(self.rows[-3:])]
        return min(steps) > 0.0 or max(steps) < 0.0

    def _second(self, column: int, along: int) -> float:
        (t0, t1, t2), (y0, y1, y2) = ([row[i] for row in self.rows[-3:]] for i in (along, column))
        return 2.0 * ((y2 - y1) / (t2 - t1) - (y1 - y0) / (t1 - t0)) / (t2 - t0)
