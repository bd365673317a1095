"""The end of the approach: where the indenter is deepest.

A largest penetration that is a corner of the loading is a row of every run. Smooth crests, of an oscillation
or under a prescribed force, lie between rows, which miss each by more or less: of many crests of one height
chance tells which holds the largest row. The end of the approach is the first crest that may be the highest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from contact_scene import Loading, Trace
from validation.measure.missed_maximum import missed_maximum
from validation.measure.round_off import ROUND_OFF
from validation.measure.windows import corners

MOST_MISSED = 0.02
"""Part of the range of the penetration by which rows may miss a crest: a dozen even rows a cycle miss theirs
by 1.7 %. Bumps below it, rounding of rows at nearly the same time, are no crests that rows missed."""

CREPT = 1e-3
"""Part of the range of the penetration within which it all but rests, and of the run that this may last."""


def end_of_approach(trace: Trace) -> int:
    """Index of the row at the end of the approach.

    That is the first row that is no lower than its neighbours and at which the penetration may be, between
    the rows beside it, as large as anywhere in the run (:func:`~validation.measure.missed_maximum`).

    Parameters
    ----------
    trace : Trace
        With at least one row.

    Returns
    -------
    int
    """
    depth = trace.penetration
    range_of_depth = float(np.ptp(depth))
    largest = float(depth.max()) - ROUND_OFF * range_of_depth
    highest = depth >= largest
    beside = np.concatenate(([-math.inf], depth, [-math.inf]))
    crest = (depth >= beside[:-2]) & (depth >= beside[2:])
    missed = crest & (depth >= largest - MOST_MISSED * range_of_depth)
    return next(
        int(row)
        for row in np.flatnonzero(highest | missed)
        if highest[row] or _may_reach(trace, int(row)) >= largest
    )


def rests_after(trace: Trace, row: int) -> bool:
    """Whether the penetration stays what it is at a row, as in a hold."""
    later = np.flatnonzero(trace.time[row + 1 :] > trace.time[row])
    if not later.size:
        return False
    moved = abs(float(trace.penetration[row + 1 + later[0]] - trace.penetration[row]))
    return moved <= ROUND_OFF * float(np.ptp(trace.penetration))


def has_smooth_crests(loading: Loading) -> bool:
    """Whether the load may have smooth crests: a load step is not straight between its kinks."""
    return any(not segment.linear for _, segment in loading.segments())


def is_located(name: str, trace: Trace, loading: Loading) -> bool:
    """Whether an observable at the end of the approach is the same in all right runs.

    Where the approach ends at a smooth crest, time, force and contact radius are those of the row next to it,
    which lies where the steps of the run happen to end: right runs differ in them by the root of what their
    rows miss of the penetration. Such is that of a contact that creeps on after its force, or the stage, has
    turned. Where the penetration is found, under a force, on a spring or to a level, its last digits tell
    which of two crests is higher, and at which time it is that has all but ceased to creep.

    Parameters
    ----------
    name : str
        Name of the observable; any other than at the end of the approach, and of the largest force, is
        located.
    trace : Trace
    loading : Loading

    Returns
    -------
    bool
    """
    if name in ("peak_force", "peak_time") and has_smooth_crests(loading):
        return False
    if name == "peak_time":
        return _stands_alone(trace)
    if not name.startswith("approach"):
        return True
    if has_smooth_crests(loading):
        return False
    segments = (segment for _, segment in loading.segments())
    given = all(segment.control == "penetration" and segment.trigger is None for segment in segments)
    if given or name == "approach_penetration":
        return True
    depth, end = trace.penetration, end_of_approach(trace)
    if not np.isclose(corners(loading, trace), trace.time[end], rtol=ROUND_OFF, atol=0.0).any():
        return False
    highest = np.flatnonzero(depth >= depth[end] - CREPT * float(np.ptp(depth)))
    crests = np.split(highest, np.flatnonzero(np.diff(highest) > 1) + 1)
    if len(crests) > 1:
        return False
    rested = float(trace.time[end] - trace.time[highest[0]])
    return name != "approach_time" or rested <= CREPT * float(np.ptp(trace.time))


def _stands_alone(trace: Trace) -> bool:
    """Whether the force neither stays at its largest value nor comes back to it, to what runs differ by."""
    largest, every = float(trace.force.max()), float(np.ptp(trace.time))
    high = np.flatnonzero(trace.force >= (1.0 - MOST_MISSED) * largest)
    held = trace.time[np.abs(trace.force - largest) <= CREPT**2 * abs(largest)]
    return bool((np.diff(high) == 1).all()) and float(np.ptp(held)) <= CREPT * every


def _may_reach(trace: Trace, row: int) -> float:
    """The largest penetration there may be between the rows beside one.

    Two rows on either side tell a smooth crest from a corner; with fewer it is taken for a corner.
    """
    depth = float(trace.penetration[row])
    near = slice(max(row - 2, 0), row + 3)
    rising = len(trace.time[near]) == 5 and bool((np.diff(trace.time[near]) > 0.0).all())
    if not rising or not (trace.contact_radius[near] > 0.0).all():
        return depth
    return depth + missed_maximum(trace, trace.penetration, row).excess


def approach_ended(trace: Trace, loading: Loading | None = None) -> bool:
    """Whether a run that stopped on its way is past its largest penetration.

    A later row is no deeper, and what the loading prescribes after the end of the run, as far as it is known,
    is no deeper either.

    Parameters
    ----------
    trace : Trace
    loading : Loading, optional
        What was asked for.

    Returns
    -------
    bool
    """
    row = end_of_approach(trace)
    if not np.any(trace.time[row + 1 :] > trace.time[row]):
        return False
    if loading is None:
        return True
    deepest = max(float(trace.penetration.max()), _may_reach(trace, row))
    slack = ROUND_OFF * float(np.ptp(trace.penetration))
    return all(depth <= deepest + slack for depth in _prescribed_after(loading, float(trace.time[-1])))


def _prescribed_after(loading: Loading, time: float) -> Iterator[float]:
    """Penetrations at the ends, kinks and crests of the loading after a time; nan where not known."""
    for step, segment in loading.segments():
        if segment.end <= time:
            continue
        if segment.control != "penetration":
            yield math.nan
            continue
        yield from (segment.value(at) for at in (*segment.kinks, segment.end) if not at <= time)
        amplitude = getattr(step, "amplitude", 0.0)
        if amplitude != 0.0:
            sinking = max(-getattr(step, "drift", 0.0), 0.0) * (segment.end - segment.start)
            yield segment.value(segment.start) + abs(amplitude) + sinking
