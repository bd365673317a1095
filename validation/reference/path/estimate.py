"""Error estimates: what a run differs by from a second one at ten times the tolerance.

The second run is the worse of the two, about by the ratio of the tolerances: the difference is its error, and
so bounds that of the first. Scalars of two runs can agree by accident; curves cannot. The pull-off is
therefore held to be no better than the curves are in the mean, and the loss of contact, at a limit point
where the time is stationary, no better than the force is at half the rows. A curve ends no better than when
contact is lost.

A curve that falls through a limit point has an infinite slope there, and the difference of two such curves at
equal times is no error. So curves are compared by their distance in a plane where time and value both count
relative to their ranges; the second run has a row at each time of the first.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

COARSER = 10.0
"""Tolerance of the second run, in that of the first."""
NO_TENSION = 1e-9
"""Tension, relative to the largest force, that is the rounding of a contact without adhesion when it ends."""
LEAST_LOOP = 1e-3
"""Work of a loop that almost closes, in the work done to and fro, to which errors are still relative."""
CHUNK = 64
"""Rows that are compared with all sides of the other polygon at once."""


def estimated_errors(fine: Columns, coarse: Columns, detached: bool = False) -> dict[str, float]:
    """Relative errors of the finer run.

    ``pull_off_force`` and ``loop_energy`` as they are, ``contact_radius`` and ``force`` the largest over the
    run, relative to the largest; of runs that both lose contact (``detached``) also ``detachment_time`` and
    ``detachment_penetration``, relative to the largest. Columns are those of the traces by name; times of
    ``fine`` are rows of ``coarse``, too.
    """
    errors = {}
    apart = {name: _distances(fine, coarse, name) for name in ("contact_radius", "force")}
    mean = max(float(np.sqrt(np.mean(each**2))) for each in apart.values())
    turnover = float(np.abs(np.diff(fine["external_work"])).sum())
    if turnover > 0.0:
        loop = abs(float(fine["external_work"][-1]))
        errors["loop_energy"] = _work_apart(fine, coarse) / max(loop, LEAST_LOOP * turnover)
    tension = [max(float(-run["force"].min()), 0.0) for run in (fine, coarse)]
    if tension[0] > NO_TENSION * float(np.abs(fine["force"]).max()):
        errors["pull_off_force"] = max(abs(tension[0] - tension[1]) / tension[0], mean)
    if detached:
        ends = [int(np.flatnonzero(run["contact_radius"] > 0.0)[-1]) for run in (fine, coarse)]
        for name in ("time", "penetration"):
            values = [float(run[name][end]) for run, end in zip((fine, coarse), ends, strict=True)]
            largest = float(np.abs(fine[name]).max())
            if largest > 0.0:
                errors[f"detachment_{name}"] = max(
                    abs(values[0] - values[1]) / largest, float(np.median(apart["force"]))
                )
    for name, each in apart.items():
        errors[name] = max(float(each.max()), errors.get("detachment_time", 0.0))
    return errors


def _work_apart(fine: Columns, coarse: Columns) -> float:
    """Most that the works of two runs differ by at times of both, and at the end."""
    _, here, there = np.intersect1d(fine["time"], coarse["time"], return_indices=True)
    here, there = np.append(here, -1), np.append(there, -1)
    return float(np.abs(fine["external_work"][here] - coarse["external_work"][there]).max())


def _distances(fine: Columns, coarse: Columns, name: str) -> Array:
    """Distances of the rows of the finer run from the polygon through those of the other."""
    scale, span = float(np.abs(fine[name]).max()) or 1.0, float(np.ptp(fine["time"])) or 1.0
    rows = np.column_stack((fine["time"] / span, fine[name] / scale))
    corners = np.column_stack((coarse["time"] / span, coarse[name] / scale))
    begin, side = corners[:-1], np.diff(corners, axis=0)
    length = (side**2).sum(axis=1)
    length[length == 0.0] = 1.0
    least = [np.abs(rows[:0, 0])]
    for chunk in np.array_split(rows, len(rows) // CHUNK + 1):
        off = chunk[:, None] - begin
        share = np.clip((off * side).sum(axis=2) / length, 0.0, 1.0)
        least.append(np.sqrt(((off - share[:, :, None] * side) ** 2).sum(axis=2).min(axis=1, initial=np.inf)))
    apart = np.concatenate(least)
    return apart if len(corners) > 1 else np.hypot(*(rows - corners).T)
