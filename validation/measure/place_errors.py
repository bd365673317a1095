"""Errors of what is read off where the rows do not locate the place: end of approach, pull-off, detachment.

The largest tension is a row of the trace: it is also uncertain by what the tension between the rows beside it
may exceed it. Its place is uncertain by that over which the tension falls by the change of its error on the
way, or by half the error, and by that between the rows over which it may be larger. The edge may have gone on
after the last row in contact, where it runs away.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from contact_scene import OutcomeKind, Trace
from contact_scene.trace import Array
from validation.measure.approach import end_of_approach, rests_after
from validation.measure.missed_maximum import MissedMaximum, missed_maximum, reach_of_maximum
from validation.measure.observables import peak_row, pull_off_row
from validation.measure.round_off import ROUND_OFF
from validation.measure.scaling import column_of, scale

RUNAWAY = 1.0 / (math.sqrt(2.0) - 1.0)
"""Distance of the edge from where contact is lost over its last step, if it is lost within one more step of
that duration: before a limit point the edge moves as the root of the time that is left."""
SAFETY = 3.0
"""Safety factor on errors whose order is not observed: the difference of two grids (Roache 1994), and the
place of a limit point as the last rows tell it."""
LEAST_VARIED = 0.5
"""Least change of the error of the force near its extremum, relative to that error: how two runs differ from
row to row may vanish by accident."""


def add_at_approach(
    errors: dict[str, float], trace: Trace, spans: Array, depth_error: float = 0.0, apart: Array | None = None
) -> None:
    """Add to the errors at the end of approach how far the rest goes while the penetration hardly changes.

    The largest penetration is a corner where it is prescribed, and known exactly; where the force is, it is
    smooth, and the row at which it is largest is a matter of its error and of where the rows are. Where load
    steps begin and end, it may have a corner as well: its place then is uncertain by where the error of the
    penetration changes by more than the penetration does, which may have all but ceased to creep. Where it
    rests from there on, as in a hold, that is the place.

    Parameters
    ----------
    errors : dict of str to float
        Relative, by observable; added to.
    trace : Trace
    spans : ndarray, shape (k, 2)
        Begin and end of every window of the run.
    depth_error : float
        Error of the largest penetration, a length; 0 if it is not known.
    apart : ndarray, shape (n,), optional
        Estimated error of the penetration in every row, nan where there is none.
    """
    if "approach_penetration" not in errors:
        return
    depth = trace.penetration
    row = end_of_approach(trace)
    missed, corner = MissedMaximum(0.0, float(trace.time[row]), float(trace.time[row])), False
    if trace.contact_radius[row] > 0.0:
        corner = _is_corner(trace, spans, row)
        missed = missed_maximum(trace, depth, row, corner)
    if missed.excess + depth_error <= ROUND_OFF * float(np.ptp(depth)) or rests_after(trace, row):
        return
    possible = depth + _uncertain(trace, row, depth_error, apart, 0.0 if corner else LEAST_VARIED)
    for name in ("force", "radius", "time"):
        column = trace.columns()[column_of(name)]
        relative_to = scale(f"approach_{name}", float(column[row]), trace)
        if f"approach_{name}" in errors and relative_to > 0.0:
            away = reach_of_maximum(possible, column, row, float(depth[row])) if depth_error > 0.0 else 0.0
            errors[f"approach_{name}"] += (away + missed.away(trace, column, row)) / relative_to


def add_at_pull_off(
    errors: dict[str, float], trace: Trace, apart: Array | None = None, usual: float = 0.0
) -> None:
    """Add to the errors of the pull-off what the rows leave open, between which the extremum may lie.

    Its place is anywhere where the tension may be as large as in its row. An error that is the same in all
    rows does not move it: where the errors of the rows are estimated their difference counts if it is less,
    but at least half the error itself.

    Parameters
    ----------
    errors : dict of str to float
        Relative, by observable; added to.
    trace : Trace
    apart : ndarray, shape (n,), optional
        Estimated error of the force in every row, nan where there is none; given if ``errors`` come from the
        difference of two runs, which has what the place adds in it.
    usual : float
        Its root mean square over the run, relative.
    """
    row = pull_off_row(trace)
    if row is not None and not _on_plateau(trace, row):
        _add_at_largest(errors, trace, -trace.force, row, "pull_off", False, apart, usual)


def add_at_peak(
    errors: dict[str, float], trace: Trace, spans: Array, apart: Array | None = None, usual: float = 0.0
) -> None:
    """Add to the errors of the largest force and of its time what the rows leave open, as at the pull-off.

    Parameters
    ----------
    errors : dict of str to float
        Relative, by observable; added to.
    trace : Trace
    spans : ndarray, shape (k, 2)
        Begin and end of every window of the run: there the largest force is a corner.
    apart, usual
        As of :func:`add_at_pull_off`.
    """
    row = peak_row(trace)
    if row is not None:
        corner = _is_corner(trace, spans, row)
        _add_at_largest(errors, trace, trace.force, row, "peak", corner, apart, usual)


def _add_at_largest(
    errors: dict[str, float],
    trace: Trace,
    force: Array,
    row: int,
    part: str,
    corner: bool,
    apart: Array | None,
    usual: float,
) -> None:
    """Add to the errors of the largest ``force``, and of the rest in its row, what the rows leave open."""
    missed = missed_maximum(trace, force, row, corner)
    if f"{part}_force" in errors:
        errors[f"{part}_force"] += missed.excess / scale(f"{part}_force", float(force[row]), trace)
    level = max(errors.get(f"{part}_force", 0.0), usual) * float(force[row])
    least = 0.0 if corner else LEAST_VARIED
    possible = force + _uncertain(trace, row, level, apart, least, missed.excess)
    for name in ("penetration", "radius", "time"):
        key, column = f"{part}_{name}", trace.columns()[column_of(name)]
        relative_to = scale(key, float(column[row]), trace)
        if key in errors and relative_to > 0.0:
            within_error = reach_of_maximum(possible, column, row, float(force[row]))
            away = max(within_error, missed.away(trace, column, row))
            errors[key] = _joined(errors, key, away / relative_to, apart is not None)


def add_at_detachment(
    errors: dict[str, float], trace: Trace, radius: float | None, compared: bool = False
) -> None:
    """Add to the errors of radius and force at detachment what they may have lost after the last row.

    Time and penetration are those of an event, but the edge runs away there. The last step tells how far, and
    the one before where that is short by chance; the last rows tell it closer, but nothing of what their
    point is off by, which the difference of two runs has in it. A contact that ends in a point has lost
    nothing.

    Parameters
    ----------
    errors : dict of str to float
        Relative, by observable; added to.
    trace : Trace
    radius : float or None
        Contact radius at detachment, as it was measured.
    compared : bool
        Whether they come from the difference of two runs, which has what the place adds in it.
    """
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if trace.outcome.kind is not OutcomeKind.DETACHED or radius == 0.0 or touching.size < 2:
        return
    before, last = touching[-2], touching[-1]
    if trace.contact_radius[before] == trace.contact_radius[last]:
        return  # the edge is at rest, and contact is lost all at once
    steps, rows = RUNAWAY, touching[-4:]
    if compared:
        steps = _steps_to_limit_point(trace.time[rows], trace.contact_radius[rows])
    for name in ("force", "radius"):
        key, column = f"detachment_{name}", trace.columns()[column_of(name)]
        relative_to = scale(key, float(column[last]), trace)
        if key in errors and relative_to > 0.0:
            away = steps * float(np.abs(np.diff(column[touching[-3:]])).max())
            errors[key] = _joined(errors, key, min(away, abs(float(column[last]))) / relative_to, compared)


def _steps_to_limit_point(time: Array, radius: Array) -> float:
    """How far the edge may have gone on after the last row, in the longer of its last two steps.

    Before a limit point it moves as the root of the time that is left: three rows tell the point, and how
    well, its distance from the one that the three rows before tell. The last row may be on it. Where rows do
    not tell, contact may be lost within one more step of the last one's duration.

    Parameters
    ----------
    time, radius : ndarray, shape (n,)
        Of the last rows in contact, at most four.

    Returns
    -------
    float
    """
    if len(time) < 4:
        return RUNAWAY
    way, way_before = _way_to_limit_point(time[1:], radius[1:]), _way_to_limit_point(time[:3], radius[:3])
    moved = abs((radius[3] - way) - (radius[2] - way_before))
    longest = float(np.abs(np.diff(radius[1:])).max())
    known = SAFETY * (abs(way) + moved) / longest if longest > 0.0 else math.inf
    return min(known, RUNAWAY) if math.isfinite(known) else RUNAWAY


def _way_to_limit_point(time: Array, radius: Array) -> float:
    """Distance ``d`` of the last of three rows from the limit point; nan where the edge does not run away.

    With ``u``, ``w`` the distances of the earlier rows from the last, and ``h``, ``g`` the times between:
    ``(u + d)^2/(h + t) = (w + d)^2/(g + t) = d^2/t``.
    """
    (w, u), (g, h) = radius[:2] - radius[2], time[2] - time[:2]
    if not (h > 0.0 and 0.0 < u < w and w / g < u / h):
        return math.nan
    return float(0.5 * (u * u / h - w * w / g) / (w / g - u / h))


def _uncertain(
    trace: Trace, row: int, level: float, apart: Array | None, least: float, excess: float = 0.0
) -> Array:
    """By how much an extremum at a row may be missed at the others: what its error changes by on the way.

    Parameters
    ----------
    trace : Trace
    row : int
    level : float
        Error at the row, which is taken for all where those of the rows are not known.
    apart : ndarray, shape (n,), optional
        Estimated error in every row, nan where there is none.
    least : float
        Least change, relative to ``level``.
    excess : float
        What the rows miss of the extremum.

    Returns
    -------
    ndarray, shape (n,)
    """
    uncertain = np.full(len(trace), level)
    if apart is not None and np.isfinite(apart[row]):
        known = np.isfinite(apart)
        uncertain[known] = np.clip(np.abs(apart[known] - apart[row]) + excess, least * level, level)
    return uncertain


def _joined(errors: Mapping[str, float], name: str, away: float, compared: bool) -> float:
    """Error of a scalar whose place is uncertain: that at its place, and how far it goes ``away`` from it.

    The difference of two runs has both in it. Where they are ``compared`` the larger of that and of the way,
    with the error of the curve, is the estimate.
    """
    if not compared:
        return errors[name] + away
    curve = "contact_radius" if name.endswith("radius") else "force"
    return max(errors[name], errors.get(curve, 0.0) + away)


def _on_plateau(trace: Trace, row: int) -> bool:
    """Whether the tension is prescribed up to this row: it ends at once, with the contact or in a jump."""
    before = trace.time[:row] < trace.time[row]
    later = row + 1 < len(trace) and trace.contact_radius[row + 1] > 0.0
    if not before.any() or (later and trace.time[row + 1] > trace.time[row]):
        return False
    last = int(np.flatnonzero(before)[-1])
    return bool(abs(trace.force[last] - trace.force[row]) <= ROUND_OFF * abs(trace.force[row]))


def _is_corner(trace: Trace, spans: Array, row: int) -> bool:
    """Whether the load turns at a row."""
    near = ROUND_OFF * float(np.ptp(trace.time))
    return bool(np.isclose(_turns(trace, spans), trace.time[row], rtol=0.0, atol=near).any())


def _turns(trace: Trace, spans: Array) -> Array:
    """Times at which load steps begin and end, and at which a stage turns, which may be where it has pressed
    the indenter to some force."""
    stage = trace.extra.get("stage")
    if stage is None:
        return spans.ravel()
    moved = np.sign(np.diff(stage))
    return np.concatenate((spans.ravel(), trace.time[1:-1][moved[1:] * moved[:-1] < 0.0]))
