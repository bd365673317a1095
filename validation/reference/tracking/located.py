"""How far off the extrema and limit points are that a run has located on its dense path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from contact_scene import Event
from validation.reference.tracking.limit_points import AT_LIMIT_POINT, PLACE_SHARE
from validation.reference.tracking.problem import FrontProblem
from validation.reference.tracking.recorder import FORCE_OF_ROW, RADIUS_OF_ROW
from validation.reference.tracking.state import FrontState

Array = NDArray[np.float64]


def extrema(columns: Mapping[str, Array], times: Sequence[float]) -> Iterator[Event]:
    """Extrema of the force, each a row between two from the polynomial of the same step.

    They are off by no more than what changes to these rows: the rest is a matter of the steps.
    """
    names = ("time", "penetration", "force", "contact_radius")
    time, force = columns["time"], columns["force"]
    for row in np.flatnonzero(np.isin(time[1:-1], times)) + 1:
        back, onward = force[row] - force[row - 1], force[row] - force[row + 1]
        if back * onward <= 0.0 or columns["contact_radius"][row + 1] == 0.0:
            continue
        off = [float(np.abs(np.diff(columns[name][row - 1 : row + 2])).max()) for name in names]
        kind = "largest force" if back > 0.0 else "largest tension"
        at, depth, force_there, radius = (float(columns[name][row]) for name in names)
        yield Event(kind, at, depth, force_there, radius, tuple(off))


def limit_point_uncertainty(problem: FrontProblem, state: FrontState) -> tuple[float, ...]:
    """How far off time, penetration, force and radius of the limit point are at which contact is lost.

    The time is stationary there, to second order. An edge that is at rest has no limit point.
    """
    before, last = state.recorded.rows[-2:] if len(state.recorded.rows) > 1 else (None, None)
    if before is None or last is None or before[RADIUS_OF_ROW] == last[RADIUS_OF_ROW]:
        return ()
    radius = AT_LIMIT_POINT * problem.longest_travel(state.surface.radius)
    radius += PLACE_SHARE * problem.fineness.deviation * state.largest_radius
    slope = (last[FORCE_OF_ROW] - before[FORCE_OF_ROW]) / (last[RADIUS_OF_ROW] - before[RADIUS_OF_ROW])
    return (0.0, 0.0, abs(slope) * radius, radius)
