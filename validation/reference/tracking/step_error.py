"""Step error estimator: how far a new row is from the extrapolation of the rows before it.

In time the polynomial through the last rows is extrapolated and compared with the solution: where the fields
are smooth that error is of fourth order, and where they are not (the edge reverses, meets nodes it left
earlier, or releases what it has just covered) it shows the kink. Close to a limit point nothing is smooth in
time; there the step is accepted by how straight the force is over the radius.

Rows of the trace are read with straight lines between them: a curved step is given interpolated rows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from validation.reference.tracking.step_history import (
    FORCE,
    PENETRATION,
    RADIUS,
    TIME,
    HistoryRow,
    StepHistory,
)

RADIUS_SHARE = 1.0
"""Extrapolation error allowed in the radius, in allowed deviations."""
FORCE_SHARE = 8.0
"""The same for force and penetration; larger, because the force is an integral over the fields."""
CHORD_SHARE = 50.0
"""Largest distance of a step from its chord, in allowed deviations, however small its extrapolation error."""
TRAVEL_SHARE = 300.0
"""Extrapolation error allowed in the radius after a step over process zones, in allowed deviations of the
travel instead of the radius: an edge that sets out needs its speed, not its place, in good time."""
REJECTED_ABOVE = 2.0
"""Step error, in allowed deviations, above which a step is rejected."""
LEAST_ZONES = 0.1
"""Least travel for that, in process zones: below it an edge is at rest."""
LOAD_FACTOR = 30.0
"""Extrapolation error allowed in the load at which an edge arrives that is judged over the radius, relative,
over the allowed deviation to the power of 3/2: it is of third order in the step, the deviation of second. A
tenth of a deviation by default: the speed changes by a factor there within a few steps, all of whose errors
shift the loss of contact to the same side."""
MOST_INTERVALS = 32
"""Most intervals into which interpolated rows divide one step."""


@dataclass(frozen=True)
class StepErrorEstimator:
    """Deviations in units of the allowed one, which is ``deviation`` times the largest values so far.

    ``columns`` are the quantities that are not prescribed; ``scales`` the largest radius, force, penetration;
    ``zone`` the process zone if the step may pass over several, otherwise 0.
    """

    history: StepHistory
    deviation: float
    columns: tuple[int, ...]
    scales: dict[int, float]
    zone: float = 0.0

    def in_time(self, row: HistoryRow) -> float:
        """Deviation of a step to ``row`` from the extrapolation in time; acceptable up to about 1."""
        if self.history.restarted:
            return 0.0
        chord, duration = self.history.chord_deviation(row), row[TIME] - self.history.rows[-1][TIME]
        worst = 0.0
        for column in self.columns:
            if self.scales[column] > 0.0:
                missed = abs(row[column] - self.history.expectation(column).value_after(duration))
                share = RADIUS_SHARE if column == RADIUS else FORCE_SHARE
                worst = max(worst, max(missed / share, chord[column] / CHORD_SHARE) / self.scales[column])
                if column == RADIUS and self.zone > 0.0:
                    travel = max(abs(row[RADIUS] - self.history.rows[-1][RADIUS]), LEAST_ZONES * self.zone)
                    worst = max(worst, missed / (TRAVEL_SHARE * travel))
        return worst / self.deviation

    def along_edge(self, row: HistoryRow) -> float:
        """Deviation of a step to ``row`` from a straight line over the radius; 0 if the edge has reversed."""
        return self._chord(row, RADIUS) / self.deviation

    def of_load(self, row: HistoryRow, rate: float) -> float:
        """Deviation of the load at which the edge arrives, from its extrapolation over the radius.

        Near a limit point the edge takes most of its time on little of its way: a step that is straight
        there says nothing of when it ends. ``rate``: of the load, relative to its largest value.
        """
        return self.history.time_missed(row) * abs(rate) / (LOAD_FACTOR * self.deviation**1.5)

    def of_place(self, missed: float) -> float:
        """Deviation of the radius at a limit point by ``missed`` from its extrapolation."""
        return abs(missed) / (RADIUS_SHARE * self.scales[RADIUS] * self.deviation)

    def intervals(self, row: HistoryRow, allowed: float) -> int:
        """Number of intervals in which a step is straight within ``allowed`` deviations."""
        bent = self._chord(row, TIME)
        return min(math.ceil(math.sqrt(bent / (allowed * self.deviation))), MOST_INTERVALS) or 1

    def intervals_before_limit_point(self, row: HistoryRow, left: float, allowed: float) -> int:
        """The same for a step over the radius that ends shortly before a limit point.

        At a distance ``s`` from it the time goes as ``s^2``. A chord over ``ds`` is off by ``ds^2/(8 s)``: by
        the same everywhere if chords are even in the root of ``s``.

        Parameters
        ----------
        row : HistoryRow
            At its end.
        left : float
            Distance of the edge from the limit point there.
        allowed : float
            As of :meth:`intervals`.

        Returns
        -------
        int
        """
        before = self.history.rows[-1]
        travel = abs(row[RADIUS] - before[RADIUS])
        bent = travel / self.scales[RADIUS] if self.scales[RADIUS] > 0.0 else 0.0
        for column in self.columns:
            if self.scales[column] > 0.0:
                bent = max(bent, abs(row[column] - before[column]) / self.scales[column])
        roots = math.sqrt(1.0 + left / travel) - math.sqrt(left / travel)
        count = math.ceil(roots * math.sqrt(0.5 * bent / (allowed * self.deviation)))
        return min(max(count, 1), MOST_INTERVALS)

    def _chord(self, row: HistoryRow, along: int) -> float:
        chord = self.history.chord_deviation(row, along)
        return max((chord[c] / self.scales[c] for c in self.columns if self.scales[c] > 0.0), default=0.0)


def free_columns(control: str) -> tuple[int, ...]:
    """Columns that are not prescribed under a control."""
    return (RADIUS, FORCE) if control == "penetration" else (RADIUS, FORCE, PENETRATION)
