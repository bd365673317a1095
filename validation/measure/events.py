"""Where a run is deepest, pressed and pulled most, and last in contact, and how far off its rows may be.

A solver that locates such an event on its dense path makes it a row and says how far it is off
(``Trace.located``, and the "pull-off" of ``Trace.events``). Of other solvers only rows are known, and one
rule serves: around its largest value a column is concave, and so between two rows below the lines through the
two rows before and through the two rows after. The event may be wherever this bound is no lower than the
largest row. A value that is a corner of the loading is a row of every run.

Before a limit point, where contact is lost, the time is a parabola over the radius: the last three rows tell
its vertex.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from contact_scene import Loading, OutcomeKind, Trace
from contact_scene.trace import Array
from validation.measure.scaling import ROUND_OFF
from validation.measure.windows import corners

SAFETY = 3.0
"""Safety factor on errors whose order is not observed: the difference of two grids (Roache 1994), and the
place of a limit point as the last rows tell it."""
PULLED_BACK = 1e-6
"""Part of the range of the penetration by which an indenter is pulled back: on a spring the penetration is
found with the edge, and rows at nearly the same time may go back by what neither is known."""
MOST_MISSED = 0.02
"""Part of the range of the penetration by which rows may miss a crest: a dozen even rows a cycle miss theirs
by 1.7 %. Bumps below it, rounding of rows at nearly the same time, are no crests that rows missed."""
CREPT = 1e-3
"""Part of the range of the penetration within which it counts as resting, and largest part of the run for
which it may do so with its time still well known."""
PARTS = 16
"""Parts of the time between two rows to which the place of an extremum between them is bounded."""
RUNAWAY = 1.0 / (math.sqrt(2.0) - 1.0)
"""Distance of the edge from where contact is lost over its last step, if it is lost within one more step of
that duration: before a limit point the edge moves as the root of the time that is left."""
STATE = ("time", "penetration", "force", "contact_radius")
"""Columns that make a state, in the order of the uncertainty of an event."""


@dataclass(frozen=True)
class ExtremeRow:
    """The ``row`` of a run at which a column, up to its sign its ``height``, is largest.

    Its observables begin with ``name``. Of a plateau it is the first row, or if not ``first`` the last. A
    ``corner`` is one of the loading.
    """

    name: str
    column: str
    height: Array
    row: int
    first: bool
    corner: bool

    @property
    def observable(self) -> str:
        """Name of the observable that is largest there."""
        return f"{self.name}_{self.column}"

    @property
    def size(self) -> float:
        """Its magnitude."""
        return abs(float(self.height[self.row]))


def end_of_approach(trace: Trace) -> int:
    """The row at the end of the approach: the first crest of the penetration that may be the highest.

    Smooth crests of one height lie between rows, which miss each by more or less: chance tells which of them
    holds the largest row. So it is the first row that is no lower than its neighbours and at which the
    penetration may be, between the rows beside it, as large as anywhere in the run.
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


def approach_ended(trace: Trace, loading: Loading | None = None) -> bool:
    """Whether a run that stopped on its way is past its largest penetration.

    A later row is no deeper, and what the loading prescribes after the end of the run, as far as it is known,
    is no deeper either.
    """
    row = end_of_approach(trace)
    if not np.any(trace.time[row + 1 :] > trace.time[row]):
        return False
    if loading is None:
        return True
    deepest = max(float(trace.penetration.max()), _may_reach(trace, row))
    slack = ROUND_OFF * float(np.ptp(trace.penetration))
    return all(depth <= deepest + slack for depth in _prescribed_after(loading, float(trace.time[-1])))


def peak_row(trace: Trace) -> int | None:
    """The first row at the largest compressive force; ``None`` without one beyond round-off."""
    slack = ROUND_OFF * float(np.abs(trace.force).max())
    largest = float(trace.force.max())
    rows = np.flatnonzero(trace.force >= largest - slack)
    return int(_located(trace, rows, "largest force")[0]) if largest > slack else None


def largest_tension(trace: Trace) -> int | None:
    """The last row at the largest tension; ``None`` without tension beyond round-off."""
    return _last_largest(trace, np.ones(len(trace), bool))


def pull_off_row(trace: Trace) -> int | None:
    """The last row at the largest tension, if that is the pull-off force.

    It is if the indenter pulls there (some earlier row is deeper), and if the run has passed the extremum:
    the tension falls afterwards, or contact is lost. Of a run that loses contact without ever being pulled
    back, such as during a hold, it is the largest tension after the first row. A contact that has shrunk to
    its process zone has passed the extremum only if its outcome says so.
    """
    depth, kind = trace.penetration, trace.outcome.kind
    if kind is OutcomeKind.BELOW_ZONE and not trace.outcome.past_extremum:
        return None
    pulled_back = depth < np.maximum.accumulate(depth) - PULLED_BACK * float(np.ptp(depth))
    row = _last_largest(trace, pulled_back)
    if row is None and kind is OutcomeKind.DETACHED:
        row = _last_largest(trace, np.arange(len(trace)) > 0)
    if row is None:
        return None
    slack = ROUND_OFF * float(np.abs(trace.force).max())
    falls = bool(np.any(trace.force[row + 1 :] > trace.force[row] + slack))
    return row if falls or kind is OutcomeKind.DETACHED else None


def last_in_contact(trace: Trace, zone: float = 0.0) -> int:
    """Of a run that lost contact the last row in contact and no shorter than the zone, else the last row."""
    radius = trace.contact_radius
    if trace.outcome.kind is OutcomeKind.DETACHED:
        for touching in (np.flatnonzero((radius > 0.0) & (radius >= zone)), np.flatnonzero(radius > 0.0)):
            if touching.size:
                return int(touching[-1])
    return len(trace) - 1


def has_smooth_crests(loading: Loading) -> bool:
    """Whether the load may have smooth crests: a load step is not straight between its kinks."""
    return any(not segment.linear for _, segment in loading.segments())


def is_located(name: str, trace: Trace, loading: Loading) -> bool:
    """Whether an observable of the approach or of the largest force is the same in all right runs.

    It is not where

    - the approach ends at a smooth crest, also that of a contact which creeps on after its force, or the
      stage, has turned: time, force and radius are those of the row beside it, which is wherever a step of
      the run ends, and differ by the root of what the rows miss of the penetration;
    - the penetration is an answer (under a force, on a spring, to a level), and its last digits decide which
      of two crests is higher, or when a contact that hardly creeps is deepest.
    """
    if not name.startswith(("approach", "peak_force", "peak_time")):
        return True
    if has_smooth_crests(loading):
        return False
    if name.startswith("peak"):
        return name == "peak_force" or _stands_alone(trace)
    segments = (segment for _, segment in loading.segments())
    given = all(segment.control == "penetration" and segment.trigger is None for segment in segments)
    if given or name == "approach_penetration":
        return True
    depth, end = trace.penetration, end_of_approach(trace)
    if not np.isclose(corners(loading, trace), trace.time[end], rtol=ROUND_OFF, atol=0.0).any():
        return False
    highest = np.flatnonzero(depth >= depth[end] - CREPT * float(np.ptp(depth)))
    if np.any(np.diff(highest) > 1):
        return False
    rested = float(trace.time[end] - trace.time[highest[0]])
    return name != "approach_time" or rested <= CREPT * float(np.ptp(trace.time))


def extrema(trace: Trace, turns: Array) -> Iterator[ExtremeRow]:
    """End of the approach, largest force and pull-off, as far as a run has them.

    ``turns`` are times at which the loading may turn.
    """
    if len(trace) == 0:
        return
    near = ROUND_OFF * float(np.ptp(trace.time))

    def turned(row: int) -> bool:
        return bool(np.isclose(turns, trace.time[row], rtol=0.0, atol=near).any())

    deepest, peak, pulled = end_of_approach(trace), peak_row(trace), pull_off_row(trace)
    yield ExtremeRow("approach", "penetration", trace.penetration, deepest, True, turned(deepest))
    if peak is not None:
        yield ExtremeRow("peak", "force", trace.force, peak, True, turned(peak))
    if pulled is not None:
        yield ExtremeRow("pull_off", "force", -trace.force, pulled, False, False)


def left_open(trace: Trace, one: ExtremeRow, error: Array) -> dict[str, float]:
    """How far off each column of the state may be at an extremum; empty if it is located.

    It may be wherever its height, as far as it is known, is no lower than in its row; ``error`` is by how
    much that is off elsewhere, shape (n,), if it is right in its row.
    """
    row, index = one.row, np.arange(len(trace))
    columns = {name: getattr(trace, name) for name in STATE}
    place, bound = index.astype(float), one.height
    away: dict[str, float] = {}
    found = next((event for event in trace.located if event.time == trace.time[row]), None)
    if found is None and not one.corner and trace.contact_radius[row] > 0.0:
        place, bound = _upper_bound(trace, one.height, row)
    excess = float(bound.max()) - float(one.height[row])
    slack = ROUND_OFF * float(np.ptp(one.height))
    exact = float(error.max()) <= slack
    if excess > slack or not (exact or _is_plateau(trace, one)):
        possible = bound + np.interp(place, index, error) >= one.height[row]
        if exact:  # of two crests of one height the same is taken by every run
            possible &= np.abs(place - row) <= 1.0
        at = place[possible]
        away = {
            name: float(np.abs(np.interp(at, index, column) - column[row]).max(initial=0.0))
            for name, column in columns.items()
        } | {one.column: excess}
    if found is not None and found.uncertainty:
        away = {
            name: max(away.get(name, 0.0), own) for name, own in zip(STATE, found.uncertainty, strict=True)
        }
    return away


def after_last_contact(trace: Trace) -> dict[str, float]:
    """How far force and radius may have gone on after the last row before contact is lost.

    As far as the solver says; else to the limit point as the last three rows tell it, which is as far off as
    from what the three rows before tell. Where they do not tell, contact may be lost within one more step.
    A contact that is lost at rest has lost nothing before.
    """
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if trace.outcome.kind is not OutcomeKind.DETACHED or touching.size < 2:
        return {}
    time, radius = trace.time[touching[-4:]], trace.contact_radius[touching[-4:]]
    step = {name: abs(float(np.diff(getattr(trace, name)[touching[-2:]])[0])) for name in STATE[2:]}
    if step["contact_radius"] == 0.0:
        return {}
    lost = next((event for event in reversed(trace.events) if event.kind == "pull-off"), None)
    if lost is not None and lost.uncertainty:
        own = dict(zip(STATE, lost.uncertainty, strict=True))
        return {name: own[name] for name in step}
    vertex, before = (_limit_point(time[rows], radius[rows]) for rows in (slice(-3, None), slice(-4, -1)))
    away = SAFETY * (abs(vertex - radius[-1]) + abs(vertex - before)) / step["contact_radius"]
    steps = min(away, RUNAWAY) if math.isfinite(away) else RUNAWAY
    return {name: steps * moved for name, moved in step.items()}


def _limit_point(time: Array, radius: Array) -> float:
    """Radius at the vertex of the parabola of time over radius through three rows; nan without one."""
    if time.size < 3:
        return math.nan
    (w, u), (g, h) = radius[:2] - radius[2], time[2] - time[:2]
    if not (h > 0.0 and 0.0 < u < w and w / g < u / h):
        return math.nan
    return float(radius[2] - 0.5 * (u * u / h - w * w / g) / (w / g - u / h))


def _is_plateau(trace: Trace, one: ExtremeRow) -> bool:
    """Whether the load holds the column at its largest value: from its row on, or until contact is lost."""
    row, radius = one.row, trace.contact_radius
    if one.first:
        beside = np.flatnonzero(trace.time > trace.time[row])[: int(one.corner)]
    else:
        goes_on = row + 1 < len(trace) and radius[row + 1] > 0.0 and trace.time[row + 1] > trace.time[row]
        beside = np.flatnonzero(trace.time < trace.time[row])[-1:] if not goes_on else np.arange(0)
    near = ROUND_OFF * float(np.ptp(one.height))
    return any(abs(float(one.height[at] - one.height[row])) <= near for at in beside)


def _upper_bound(trace: Trace, values: Array, row: int) -> tuple[Array, Array]:
    """Places between rows, as shares of their numbers, and at most how large a column may be there.

    Straight between rows, but beside its largest ``row``, where it is concave: below the lines through the
    two rows before and the two rows after; where neither exists, by half of what it changes by, at most.
    """
    end = int(np.flatnonzero(trace.contact_radius > 0.0)[-1]) + 1
    time, index = trace.time, np.arange(len(trace))
    place = np.linspace(0.0, len(trace) - 1.0, PARTS * (len(trace) - 1) + 1)
    bound = np.interp(place, index, values)

    def slope(first: int) -> float | None:
        if first < 0 or first + 1 >= end or time[first + 1] <= time[first]:
            return None
        return float((values[first + 1] - values[first]) / (time[first + 1] - time[first]))

    for first in (row - 1, row):
        if slope(first) is None:
            continue
        inside = slice(PARTS * first, PARTS * (first + 1) + 1)
        share, h = place[inside] - first, time[first + 1] - time[first]
        before, after = slope(first - 1), slope(first + 1)
        half = values[row] + 0.5 * abs(values[first + 1] - values[first])
        lines = [np.full_like(share, half if before is None and after is None else np.inf)]
        if before is not None:
            lines.append(values[first] + before * h * share)
        if after is not None:
            lines.append(values[first + 1] - after * h * (1.0 - share))
        bound[inside] = np.maximum(bound[inside], np.min(lines, axis=0))
    return place, bound


def _last_largest(trace: Trace, among: NDArray[np.bool_]) -> int | None:
    """The last of some rows at their largest tension; ``None`` without tension beyond round-off."""
    tension = -trace.force
    slack = ROUND_OFF * float(np.abs(trace.force).max())
    pulling = np.flatnonzero(among & (tension > slack))
    if pulling.size == 0:
        return None
    rows = pulling[tension[pulling] >= float(tension[pulling].max()) - slack]
    return int(_located(trace, rows, "largest tension")[-1])


def _located(trace: Trace, rows: NDArray[np.int_], kind: str) -> NDArray[np.int_]:
    """Of rows of one height those at which the solver has located the extremum; all where it has not."""
    known = rows[np.isin(trace.time[rows], [event.time for event in trace.located if event.kind == kind])]
    return known if known.size else rows


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
    return max(depth, float(_upper_bound(trace, trace.penetration, row)[1].max()))


def _prescribed_after(loading: Loading, time: float) -> Iterator[float]:
    """Penetrations at the ends and kinks of the loading after a time; nan where not known.

    Of a load step that is not straight between its kinks the largest, wherever in it that is.
    """
    for step, segment in loading.segments():
        if segment.end <= time:
            continue
        if segment.control != "penetration":
            yield math.nan
            continue
        yield from (segment.value(at) for at in (*segment.kinks, segment.end) if not at <= time)
        if not segment.linear:
            yield step.largest(segment)
