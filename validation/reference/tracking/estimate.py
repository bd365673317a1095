"""Error estimates from two runs, one with twice the step of the other: a third of the difference (order two).

A curve that falls through a limit point has an infinite slope there, and the difference of two such curves at
equal times is no error; radius and force are therefore compared by the distance of the curves in a plane
where time and value both count relative to their ranges. The rows of the coarser run should lie so densely
that the polygon through them adds nothing.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

RICHARDSON = 1.0 / 3.0
"""Error of the finer of two runs over their difference, for order two and twice the step."""
FIRST_ORDER = 1.0
"""The same for order one: the moment at which contact is lost over a short zone, and the work until then."""
NO_TENSION = 1e-9
"""Tension, relative to the largest force, that is the rounding of a contact without adhesion when it ends."""
NEARBY = 48
"""Sides of the other polygon, before and after the corner at the same time and before and after the nearest
corner, among which the nearest is sought: where an edge collapses, a small shift in time is many rows."""


def estimated_errors(
    fine: Columns, coarse: Columns, detached: bool = False, over_zones: bool = False
) -> dict[str, float]:
    """Relative errors of the finer run.

    ``pull_off_force`` and ``loop_energy`` as they are (a loop that almost closes: relative to a thousandth of
    the work done to and fro), ``contact_radius`` and ``force`` largest over the run, relative to the largest.
    If contact is lost in steps over process zones, that moment and the loop are off by the whole difference:
    they converge with first order there.
    Of runs that both lose contact (``detached``) also ``detachment_time`` and ``detachment_penetration``,
    relative to the largest and no better than the loop energy: two such moments can agree by accident.

    Parameters
    ----------
    fine, coarse : mapping of str to ndarray
        Columns of the traces of both runs, by name.
    detached : bool
        Whether both runs lose contact.
    over_zones : bool
        Whether the last steps may pass over process zones.

    Returns
    -------
    dict of str to float
    """
    errors = {}
    share = FIRST_ORDER if detached and over_zones else RICHARDSON
    tension = [max(float(-run["force"].min()), 0.0) for run in (fine, coarse)]
    if tension[0] > NO_TENSION * float(np.abs(fine["force"]).max()):
        errors["pull_off_force"] = RICHARDSON * abs(tension[0] - tension[1]) / tension[0]
    loops = [float(run["external_work"][-1]) for run in (fine, coarse)]
    turnover = float(np.abs(np.diff(fine["external_work"])).sum())
    if turnover > 0.0:
        errors["loop_energy"] = share * abs(loops[0] - loops[1]) / max(abs(loops[0]), 1e-3 * turnover)
    if detached:
        ends = [int(np.flatnonzero(run["contact_radius"] > 0.0)[-1]) for run in (fine, coarse)]
        for name in ("time", "penetration"):
            values = [float(run[name][end]) for run, end in zip((fine, coarse), ends, strict=True)]
            largest = float(np.abs(fine[name]).max())
            if largest > 0.0:
                own = share * abs(values[0] - values[1]) / largest
                errors[f"detachment_{name}"] = max(own, errors.get("loop_energy", 0.0))
    for name in ("contact_radius", "force"):
        errors[name] = RICHARDSON * _curve_distance(fine, coarse, name)
    return errors


def _curve_distance(fine: Columns, coarse: Columns, name: str) -> float:
    """Largest distance of a row of the finer run from the polygon of the other, over nearby sides."""
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
