"""Error estimates from two runs, one with twice the step of the other: a third of the difference (order two).

A curve that falls through a limit point has an infinite slope there, and the difference of two such curves at
equal times says nothing; radius and force are therefore compared by the distance of the curves in a plane
where time and value both count relative to their ranges.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Columns = Mapping[str, Array]

RICHARDSON = 1.0 / 3.0


def estimated_errors(fine: Columns, coarse: Columns) -> dict[str, float]:
    """Relative errors of the finer run.

    ``pull_off_force`` and ``loop_energy`` as they are (a loop that almost closes: relative to a thousandth of
    the work done to and fro), ``contact_radius`` and ``force`` largest over the run, relative to the largest.
    """
    errors = {}
    tension = [max(float(-run["force"].min()), 0.0) for run in (fine, coarse)]
    if tension[0] > 0.0:
        errors["pull_off_force"] = RICHARDSON * abs(tension[0] - tension[1]) / tension[0]
    loops = [_work(run) for run in (fine, coarse)]
    turnover = float(np.abs(_parts(fine)).sum())
    if turnover > 0.0:
        errors["loop_energy"] = RICHARDSON * abs(loops[0] - loops[1]) / max(abs(loops[0]), 1e-3 * turnover)
    for name in ("contact_radius", "force"):
        errors[name] = RICHARDSON * _curve_distance(fine, coarse, name)
    return errors


def _parts(run: Columns) -> Array:
    return 0.5 * (run["force"][1:] + run["force"][:-1]) * np.diff(run["penetration"])


def _work(run: Columns) -> float:
    return float(_parts(run).sum())


def _curve_distance(fine: Columns, coarse: Columns, name: str) -> float:
    time, value = fine["time"], fine[name]
    scale, span = float(np.abs(value).max()), float(time[-1] - time[0])
    if scale == 0.0 or span == 0.0:
        return abs(float(value[0] - coarse[name][0])) / (scale or 1.0)
    step = np.diff(time)
    smooth = step > 0.0
    steepness = np.zeros_like(time)
    rate = np.divide(np.diff(value), step, out=np.zeros_like(step), where=smooth) * span / scale
    steepness[1:] = np.abs(rate)
    steepness[:-1] = np.maximum(steepness[:-1], np.abs(rate))
    other_time, other = coarse["time"], coarse[name]
    jumps = np.union1d(time[1:][~smooth], other_time[1:][np.diff(other_time) == 0.0])
    inner = (time <= other_time[-1]) & ~np.isin(time, jumps)
    at = np.interp(time[inner], other_time, other)
    return float((np.abs(at - value[inner]) / np.hypot(1.0, steepness[inner])).max(initial=0.0) / scale)
