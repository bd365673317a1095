"""How good a step is: how far the new row misses where the rows before it pointed.

In time the polynomial through the last rows, carried on, is compared with what was found: where the fields
are smooth that error is of fourth order, and where they are not (the edge turns round, meets its own tracks,
or frees what it has just covered) it is what tells. Close to a limit point nothing is smooth in time; there
the step is judged by how straight the force is over the radius.

Rows of the trace are read as straight between each other: a step that bends is given rows in between.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from validation.reference.tracking.step_history import FORCE, PENETRATION, RADIUS, TIME, Row, Trail

RADIUS_SHARE = 1.0  # of the deviation: how far the radius may be from where its course pointed
FORCE_SHARE = 8.0  # the same for the force, an integral over the fields
STRAIGHT = 50.0  # times the deviation: how far a step may leave a straight line, however smooth
MOST = 32  # parts of a step


@dataclass(frozen=True)
class Judge:
    """Deviations relative to what is allowed, ``deviation`` of the largest values so far.

    ``columns`` are the quantities that are not prescribed; ``scales`` go with radius, force, penetration.
    """

    trail: Trail
    deviation: float
    columns: tuple[int, ...]
    scales: dict[int, float]

    def in_time(self, row: Row) -> float:
        """A step to ``row`` judged over time."""
        if self.trail.fresh:
            return 0.0
        sags, duration, worst = self.trail.sag(row), row[TIME] - self.trail.rows[-1][TIME], 0.0
        for column in self.columns:
            if self.scales[column] > 0.0:
                missed = abs(row[column] - self.trail.course(column).ahead(duration))
                share = RADIUS_SHARE if column == RADIUS else FORCE_SHARE
                worst = max(worst, max(missed / share, sags[column] / STRAIGHT) / self.scales[column])
        return worst / self.deviation

    def along_edge(self, row: Row) -> float:
        """A step to ``row`` judged over the radius; 0 if the edge has not been going that way."""
        sags = self.trail.sag(row, RADIUS)
        parts = [sags[c] / self.scales[c] for c in self.columns if self.scales[c] > 0.0]
        return max(parts, default=0.0) / self.deviation

    def parts(self, row: Row, allowed: float) -> int:
        """In how many parts a step is straight within ``allowed`` deviations."""
        sags = self.trail.sag(row)
        bent = max((sags[c] / self.scales[c] for c in self.columns if self.scales[c] > 0.0), default=0.0)
        return min(math.ceil(math.sqrt(bent / (allowed * self.deviation))), MOST) or 1


def judged(control: str) -> tuple[int, ...]:
    """What is not prescribed under a control."""
    return (RADIUS, FORCE, PENETRATION) if control == "force" else (RADIUS, FORCE)
