"""The last three committed rows: what they say about the step to come."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from itertools import pairwise

from validation.reference.tracking.attempt import Curvature

MEMORY = 3
TIME, RADIUS, FORCE, PENETRATION = range(4)
Row = tuple[float, float, float, float]


@dataclass
class Trail:
    """Rows since the last kink (time, radius, force, penetration), at most three."""

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

    def rate_of_radius(self) -> float:
        """Rate of the radius at the last row."""
        if self.fresh:
            return 0.0
        before, now = self.rows[-2:]
        h = now[TIME] - before[TIME]
        return (now[RADIUS] - before[RADIUS]) / h + 0.5 * self.curvature().radius * h

    def curvature(self) -> Curvature:
        """Second derivatives of radius and penetration."""
        if len(self.rows) < MEMORY:
            return Curvature()
        return Curvature(self._second(RADIUS, TIME), self._second(PENETRATION, TIME))

    def to_extremum(self, along: int = TIME) -> float:
        """Time (or signed distance) from the last row until the force turns, by a parabola; else infinite."""
        if len(self.rows) < MEMORY or not self._monotone(along):
            return math.inf
        before, now = self.rows[-2:]
        h, second = now[along] - before[along], self._second(FORCE, along)
        return -(now[FORCE] - before[FORCE]) / h / second - 0.5 * h if second != 0.0 else math.inf

    def sag(self, row: Row, along: int = TIME) -> tuple[float, float, float]:
        """How far radius, force and penetration leave a straight line on the way to ``row``."""
        none = (0.0, 0.0, 0.0)
        if self.fresh or not self._monotone(along):
            return none
        before, now = self.rows[-2:]
        h, last = row[along] - now[along], now[along] - before[along]
        if h * last <= 0.0:
            return none
        gaps = [z - y - (y - x) * h / last for x, y, z in zip(before, now, row, strict=True)]
        share = 0.25 * h / (h + last)
        return share * abs(gaps[RADIUS]), share * abs(gaps[FORCE]), share * abs(gaps[PENETRATION])

    def _monotone(self, along: int) -> bool:
        steps = [later[along] - earlier[along] for earlier, later in pairwise(self.rows)]
        return min(steps) > 0.0 or max(steps) < 0.0

    def _second(self, column: int, along: int) -> float:
        (t0, t1, t2), (y0, y1, y2) = ([row[i] for row in self.rows] for i in (along, column))
        return 2.0 * ((y2 - y1) / (t2 - t1) - (y1 - y0) / (t1 - t0)) / (t2 - t0)
