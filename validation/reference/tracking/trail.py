"""The last three committed rows: what they say about the step to come."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from validation.reference.tracking.attempt import Curvature

MEMORY = 3


@dataclass
class Trail:
    """Rows since the last kink (time, radius, force, penetration), at most three."""

    rows: list[tuple[float, float, float, float]] = field(default_factory=list)

    def add(self, time: float, radius: float, force: float, penetration: float) -> None:
        """Append a row; rows of an earlier moment at the same time are of no use for rates."""
        if self.rows and self.rows[-1][0] == time:
            self.rows.clear()
        self.rows.append((time, radius, force, penetration))
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
        (t1, a1, _, _), (t2, a2, _, _) = self.rows[-2:]
        return (a2 - a1) / (t2 - t1) + 0.5 * self.curvature().radius * (t2 - t1)

    def curvature(self) -> Curvature:
        """Second derivatives of radius and penetration."""
        if len(self.rows) < MEMORY:
            return Curvature()
        return Curvature(self._second(1), self._second(3))

    def time_to_extremum(self) -> float:
        """Time from the last row until the force turns, by a parabola; infinite if unknown."""
        if len(self.rows) < MEMORY:
            return math.inf
        (t1, _, f1, _), (t2, _, f2, _) = self.rows[-2:]
        second = self._second(2)
        return -(f2 - f1) / (t2 - t1) / second - 0.5 * (t2 - t1) if second != 0.0 else math.inf

    def sag(self, h: float, *row: float) -> tuple[float, ...]:
        """How far radius, force and penetration leave a straight line within a step of length ``h``."""
        if self.fresh:
            return 0.0, 0.0, 0.0
        (t1, *before), (t2, *now) = self.rows[-2:]
        share, along = 0.25 * h / (h + t2 - t1), h / (t2 - t1)
        return tuple(share * abs(z - y - (y - x) * along) for x, y, z in zip(before, now, row, strict=True))

    def _second(self, column: int) -> float:
        (t0, t1, t2), (y0, y1, y2) = ([row[i] for row in self.rows] for i in (0, column))
        return 2.0 * ((y2 - y1) / (t2 - t1) - (y1 - y0) / (t1 - t0)) / (t2 - t0)
