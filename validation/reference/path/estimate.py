"""Error estimates from two runs: the difference over ``r^p - 1``, ``r`` the ratio of their numbers of steps.

The coarser run may take twice the step, but between the rows of a table, after a kink, or where the
deviation from an extrapolation of fourth order limits it, it does not: the difference is then a smaller
part of the error. Curves and the moment at which contact is lost have p = 2. Pull-off and work have p = 1:
they add up the errors of steps of which some are the same in both runs, and differences of either sign; so
has the moment at which contact without adhesion has shrunk to a point, which the rows run into.
What the work differs by at the end may vanish by accident: what it differs by at kinks of the load on the
way counts as well.

A curve that falls through a limit point has an infinite slope there, and the difference of two such curves at
equal times is no error; radius and force are therefore compared by the distance of the curves in a plane
where time and value both count relative to their ranges. The rows of the coarser run should lie so densely
that the polygon through them adds nothing.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

COARSER = 10.0
"""Tolerance of the second run, in that of the first."""
LEAST_RATIO = 1.05
"""Least ratio of steps: of runs with nearly the same steps only what differs by rounding is left."""
NO_TENSION = 1e-9
"""Tension, relative to the largest force, that is the rounding of a contact without adhesion when it ends."""
NEARBY = 48
"""Sides of the other polygon, before and after the corner at the same time and before and after the nearest
corner, among which the nearest is sought: where an edge collapses, a small shift in time is many rows."""


def estimated_errors(
    fine: Columns, coarse: Columns, detached: bool = False, ratio: float = 2.0, in_a_point: bool = False
) -> dict[str, float]:
    """Relative errors of the finer run.

    ``pull_off_force`` and ``loop_energy`` as they are (a loop that almost closes: relative to a thousandth of
    the work done to and fro), ``contact_radius`` and ``force`` largest over the run, relative to the largest.
    Of runs that both lose contact (``detached``) also ``detachment_time`` and ``detachment_penetration``,
    relative to the largest. Neither they nor the pull-off are better than the loop energy: two such moments
    can agree by accident.

    Parameters
    ----------
    fine, coarse : mapping of str to ndarray
        Columns of the traces of both runs, by name.
    ratio : float
        Steps of the finer run over those of the other.
    detached : bool
        Whether both runs lose contact.
    in_a_point : bool
        Whether contact shrinks to a point before: the moment is then of first order.

    Returns
    -------
    dict of str to float
    """
    errors = {}
    first, second = (1.0 / (max(ratio, LEAST_RATIO) ** order - 1.0) for order in (1, 2))
    turnover = float(np.abs(np.diff(fine["external_work"])).sum())
    if turnover > 0.0:
        loop = abs(float(fine["external_work"][-1]))
        errors["loop_energy"] = first * _work_apart(fine, coarse) / max(loop, 1e-3 * turnover)
    least = errors.get("loop_energy", 0.0)
    tension = [max(float(-run["force"].min()), 0.0) for run in (fine, coarse)]
    if tension[0] > NO_TENSION * float(np.abs(fine["force"]).max()):
        errors["pull_off_force"] = max(first * abs(tension[0] - tension[1]) / tension[0], least)
    if detached:
        ends = [int(np.flatnonzero(run["contact_radius"] > 0.0)[-1]) for run in (fine, coarse)]
        for name in ("time", "penetration"):
            values = [float(run[name][end]) for run, end in zip((fine, coarse), ends, strict=True)]
            largest = float(np.abs(fine[name]).max())
            if largest > 0.0:
                apart = (first if in_a_point else second) * abs(values[0] - values[1])
                errors[f"detachment_{name}"] = max(apart / largest, least)
    for name in ("contact_radius", "force"):
        errors[name] = second * _curve_distance(fine, coarse, name)
    return errors


def _work_apart(fine: Columns, coarse: Columns) -> float:
    """Most that the works of two runs differ by: at the end, and at the kinks that both have stepped onto."""
    _, here, there = np.intersect1d(fine["time"], coarse["time"], return_indices=True)
    here, there = np.append(here, -1), np.append(there, -1)
    return float(np.abs(fine["external_work"][here] - coarse["external_work"][there]).max())


def _curve_distance(fine: Columns, coarse: Columns, name: str) -> float:
    """Largest distance of a row of the finer run from the polygon of the other, over nearby sides."""
    from scipy.spatial import KDTree

    scale, span = float(np.abs(fine[name]).max()) or 1.0, float(np.ptp(fine["time"])) or 1.0
    time, value = fine["time"] / span, fine[name] / scale
    corner_time, corner = coarse["time"] / span, coarse[name] / scale
    if len(corner) < 2:
        return float(np.abs(value - corner[0]).max())
    places = KDTree(np.column_stack((corner_time, corner)))
    by_time = corner_time.searchsorted(time)
    by_place = places.query(np.column_stack((time, value)))[1]
    near = np.arange(-NEARBY, NEARBY + 1)
    side = np.hstack([nearest[:, None] + near for nearest in (by_time, by_place)])
    side = np.clip(side, 0, len(corner) - 2)
    along_time, along = np.diff(corner_time)[side], np.diff(corner)[side]
    off_time, off = time[:, None] - corner_time[side], value[:, None] - corner[side]
    length = along_time**2 + along**2
    share = (off_time * along_time + off * along) / np.where(length > 0.0, length, 1.0)
    share = np.clip(share, 0.0, 1.0)
    return float(np.hypot(off_time - share * along_time, off - share * along).min(axis=1).max())
