"""Error estimates of a run: within their sum two solvers agree.

The reference brings its own estimates (``Trace.errors``). Boundary and finite elements are run a second time,
everything coarser by a ratio ``r``, 2 where the resolution is even: half the resolution, four times the step
tolerance, and for the finite elements a mesh that grades twice as fast. A run that cannot be coarser is
compared with a finer one, ``r`` = 1/2. Two runs cannot prove an order, hence the factor 3 customary for two
grids (Roache 1994):

    ``estimate = 3 |other - run|/|r^p - 1|``.

``p`` is 2 for the finite elements. For the boundary elements it is 1: static states converge faster, but the
annuli that resolve the layer behind an advancing edge do not double with the resolution, and with 2 the
estimates of whole cycles fell short of the true error (by up to 1.7 times in the quick suite). What the
branches dissipate has p = 1 too, because it squares the stress in the layer at a sharp edge, and so has the
pull-off: an edge at rest up to a corner of the force begins to move within an element or a step. At a limit
point, where contact is lost, the edge moves as the root of the load: radius and force there have half the
order.

Curves are known at rows only: what they may do between is added (:mod:`row_interpolation`). Relative to its
excursion in the worst window a curve has an estimate of its own, so that a small oscillation is not lost in
the size of the contact.

The difference of two runs can vanish by accident, so no scalar is held to be better than the curves of its
run are in the mean at its order (root mean squares are those of the last moments, where an edge that runs
away is a little early or late); a square, than twice that. The excess at the edge is a difference, uncertain
by what its two terms are. The largest tension is a row of the trace: it is also uncertain by what the
tension between the rows beside it may exceed it. Its place is uncertain by that over which the tension falls
by the change of its error on the way, or by half the error, and by that between the rows over which it may
be larger. The edge may have gone on after the last row in contact, where it runs away.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from contact_scene import Loading, OutcomeKind, Trace
from contact_scene.trace import Array
from validation.measure.norms import (
    distance,
    interpolation_error,
    movement_bound,
    movement_distance,
    movement_interpolation_error,
)
from validation.measure.observables import ROUND_OFF, at_last_contact, end_of_approach, pull_off_row
from validation.measure.row_interpolation import column_curve
from validation.measure.scaling import column_of, scale
from validation.measure.windows import windows
from validation.solvers import solver

SAFETY = 3.0
"""Safety factor on the extrapolated error of two grids, whose order is not observed (Roache 1994)."""
IN_LAYERS = ("branch_dissipation", "zone_excess")
"""Quantities of first order: squares of the stress in the layer at the edge."""
OF_SQUARE = 2.0
"""Relative error of a square over that of what is squared."""
AT_LIMIT_POINTS = ("detachment_radius", "detachment_force")
"""Quantities of first order where others are of second: the edge runs away as the root of the load."""
RUNAWAY = 1.0 / (math.sqrt(2.0) - 1.0)
"""Distance of the edge from where contact is lost over its last step, if it is lost within one more step of
that duration: before a limit point the edge moves as the root of the time that is left."""
LEAST_VARIED = 0.5
"""Least change of the error of the force near its extremum, relative to that error: how two runs differ from
row to row may vanish by accident."""
ENERGIES = ("loop_energy", "dissipated_energy", "peak_cycle_loss", *IN_LAYERS)
CURVES = ("force", "contact_radius")
MOVEMENT = "_movement"
"""Ending of the name of an error of a curve relative to its excursion in the worst window."""
Measures = Mapping[str, float | None]


def from_two_runs(
    run: Trace,
    other: Trace,
    measured: Measures,
    otherwise: Measures,
    ratio: float = 2.0,
    loading: Loading | None = None,
) -> dict[str, float]:
    """Errors of a run from its difference from a coarser or finer one, ``3 |other - run|/|r^p - 1|``.

    Parameters
    ----------
    run, other : Trace
        Of one solver; the estimates are those of the first.
    measured, otherwise : mapping of str to float or None
        Scalars of either run by name.
    ratio : float
        Step and element sizes of the second run over those of the first; not 1.
    loading : Loading, optional
        Divides the run into windows, for the errors relative to the excursions of the curves.

    Returns
    -------
    dict of str to float
        Relative errors of the first run by observable, of its curves by column, and of their movement by
        column with ``MOVEMENT``.
    """
    usual = solver(run.solver).order
    errors = {}
    floors = {1.0: 0.0, usual: 0.0}
    for column in CURVES:
        apart = distance(other, run, column)
        if apart is not None:
            between = interpolation_error(run, column)
            errors[column] = _extrapolated(apart.rms, usual, ratio) + between
            for order, floor in floors.items():
                floors[order] = max(floor, _extrapolated(apart.mean, order, ratio) + between)
    for name, value in measured.items():
        there = otherwise.get(name)
        if value is None or there is None or not (column_of(name) or name in ENERGIES):
            continue
        relative_to = scale(name, value, run)
        first = name in (*IN_LAYERS, *AT_LIMIT_POINTS) or name.startswith("pull_off")
        order = 1.0 if first else usual
        own = _extrapolated(abs(there - value) / relative_to, order, ratio) if relative_to > 0.0 else 0.0
        errors[name] = max(own, (OF_SQUARE if name in IN_LAYERS else 1.0) * floors[order])
    left = at_last_contact(run, "balance_residual")
    if left is not None and errors.get("dissipated_energy", 0.0) > 0.0:
        # what a run's own energies, each integrated alone, leave unexplained is an error of one of them
        relative_to = scale("dissipated_energy", measured["dissipated_energy"] or 0.0, run)
        errors["dissipated_energy"] = max(errors["dissipated_energy"], abs(left) / relative_to)
    terms = ("branch_dissipation", "dissipated_energy")
    if "zone_excess" in errors and all(name in errors for name in terms):
        sizes = [scale(name, measured[name] or 0.0, run) for name in (*terms, "zone_excess")]
        both = sum(errors[name] * size for name, size in zip(terms, sizes, strict=False))
        errors["zone_excess"] = max(errors["zone_excess"], both / sizes[-1] if sizes[-1] > 0.0 else 0.0)
    spans = windows(loading, run) if loading is not None and len(run) else np.empty((0, 2))
    if len(spans):
        for column in CURVES:
            moved = movement_distance(other, run, spans, column)
            if moved is not None:
                between = movement_interpolation_error(run, spans, column)
                errors[column + MOVEMENT] = _extrapolated(moved.rms, usual, ratio) + between
    deepest, other_deepest = measured.get("approach_penetration"), otherwise.get("approach_penetration")
    change = 0.0 if deepest is None or other_deepest is None else abs(other_deepest - deepest)
    errors = _with_smooth_approach(errors, run, _extrapolated(change, usual, ratio), _turns(run, spans))
    apart = distance(other, run, "force")
    usually = 0.0 if apart is None else _extrapolated(apart.rms, 1.0, ratio)
    errors = _with_sampling(errors, run, _apart(run, other, 1.0, ratio), usually)
    return _with_last_step(errors, run, True)


def from_own(trace: Trace, measured: Measures, loading: Loading | None = None) -> dict[str, float]:
    """The estimates of a solver that makes its own; a scalar it does not name has the largest of them.

    Where it names none for the movement of a curve, it is bounded by that of the curve.

    Parameters
    ----------
    trace : Trace
    measured : mapping of str to float or None
        Scalars of the run by name.
    loading : Loading, optional
        As of :func:`from_two_runs`.

    Returns
    -------
    dict of str to float
    """
    largest = max(trace.errors.values(), default=0.0)
    own = {column: trace.errors[column] for column in CURVES if column in trace.errors}
    errors = {column: error + interpolation_error(trace, column) for column, error in own.items()}
    for name, value in measured.items():
        if value is not None and (column_of(name) or name in ENERGIES):
            errors[name] = trace.errors.get(name, largest)
    spans = windows(loading, trace) if loading is not None and len(trace) else np.empty((0, 2))
    if len(spans):
        for column, error in own.items():
            bound = movement_bound(trace, spans, column) * error
            between = movement_interpolation_error(trace, spans, column)
            errors[column + MOVEMENT] = trace.errors.get(column + MOVEMENT, bound) + between
    errors = _with_smooth_approach(errors, trace, 0.0, _turns(trace, spans))
    return _with_last_step(_with_sampling(errors, trace), trace)


def _extrapolated(difference: float, order: float, ratio: float) -> float:
    return SAFETY * difference / abs(ratio**order - 1.0)


def _apart(run: Trace, other: Trace, order: float, ratio: float) -> Array:
    """Estimated error of the force in every row, signed; nan where the other run has ended.

    Parameters
    ----------
    run, other : Trace
    order, ratio : float
        As of :func:`from_two_runs`.

    Returns
    -------
    ndarray, shape (n,)
    """
    if len(other) < 2:
        return np.full(len(run), np.nan)
    within = (run.time >= other.time[0]) & (run.time <= other.time[-1])
    curve = column_curve(other, "force")
    difference = np.array(
        [curve.at(float(time)) if here else np.nan for time, here in zip(run.time, within, strict=True)]
    )
    return (difference - run.force) * _extrapolated(1.0, order, ratio)


def _with_sampling(
    errors: dict[str, float], trace: Trace, apart: Array | None = None, usual: float = 0.0
) -> dict[str, float]:
    """Add to the errors of the pull-off what the rows leave open, between which the extremum may lie.

    Its place is anywhere where the tension may be as large as in its row. An error that is the same in all
    rows does not move it: where the errors of the rows are estimated their difference counts if it is less,
    but at least half the error itself.

    Parameters
    ----------
    errors : dict of str to float
    trace : Trace
    apart : ndarray, shape (n,), optional
        Estimated error of the force in every row, nan where there is none.
    usual : float
        Its root mean square over the run, relative.
    """
    row = pull_off_row(trace)
    if row is None or _on_plateau(trace, row):
        return errors
    tension = -trace.force
    missed = _missed_maximum(trace, tension, row)
    if "pull_off_force" in errors:
        errors["pull_off_force"] += missed.excess / scale("pull_off_force", float(trace.force[row]), trace)
    level = max(errors.get("pull_off_force", 0.0), usual) * float(tension[row])
    uncertain = np.full(len(trace), level)
    if apart is not None and np.isfinite(apart[row]):
        known = np.isfinite(apart)
        varied = np.abs(apart[known] - apart[row]) + missed.excess
        uncertain[known] = np.clip(varied, LEAST_VARIED * level, level)
    possible = tension + uncertain
    for name in ("penetration", "radius", "time"):
        column = trace.columns()[column_of(name)]
        relative_to = scale(f"pull_off_{name}", float(column[row]), trace)
        if f"pull_off_{name}" in errors and relative_to > 0.0:
            away = max(_reach(possible, column, row, float(tension[row])), missed.away(trace, column, row))
            errors[f"pull_off_{name}"] = _joined(
                errors, f"pull_off_{name}", away / relative_to, apart is not None
            )
    return errors


def _with_smooth_approach(
    errors: dict[str, float], trace: Trace, depth_error: float, turns: Array
) -> dict[str, float]:
    """Add to the errors at the end of approach how far the rest goes while the penetration hardly changes.

    The largest penetration is a corner where it is prescribed, and known exactly; where the force is, it is
    smooth, and the row at which it is largest is a matter of its error and of where the rows are. At the
    ``turns``, where load steps begin and end, it may have a corner as well.
    """
    if "approach_penetration" not in errors:
        return errors
    depth = trace.penetration
    row = end_of_approach(trace)
    missed = _Missed(0.0, float(trace.time[row]), float(trace.time[row]))
    if trace.contact_radius[row] > 0.0:
        corner = bool(
            np.isclose(turns, trace.time[row], rtol=0.0, atol=ROUND_OFF * float(np.ptp(trace.time))).any()
        )
        missed = _missed_maximum(trace, depth, row, corner)
    if missed.excess + depth_error <= ROUND_OFF * float(np.ptp(depth)):
        return errors
    for name in ("force", "radius", "time"):
        column = trace.columns()[column_of(name)]
        relative_to = scale(f"approach_{name}", float(column[row]), trace)
        if f"approach_{name}" in errors and relative_to > 0.0:
            away = _reach(depth, column, row, depth[row] - depth_error) if depth_error > 0.0 else 0.0
            errors[f"approach_{name}"] += (away + missed.away(trace, column, row)) / relative_to
    return errors


def _with_last_step(errors: dict[str, float], trace: Trace, compared: bool = False) -> dict[str, float]:
    """Add to the errors of radius and force at detachment what they may have lost after the last row.

    Time and penetration are those of an event, but the edge runs away there.
    """
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if trace.outcome.kind is not OutcomeKind.DETACHED or touching.size < 2:
        return errors
    before, last = touching[-2], touching[-1]
    if trace.contact_radius[before] == trace.contact_radius[last]:
        return errors  # the edge is at rest, and contact is lost all at once
    for name in ("force", "radius"):
        key, column = f"detachment_{name}", trace.columns()[column_of(name)]
        relative_to = scale(key, float(column[last]), trace)
        if key in errors and relative_to > 0.0:
            away = RUNAWAY * abs(float(column[last] - column[before]))
            errors[key] = _joined(errors, key, min(away, abs(float(column[last]))) / relative_to, compared)
    return errors


def _joined(errors: Mapping[str, float], name: str, away: float, compared: bool) -> float:
    """Error of a scalar whose place is uncertain: that at its place, and how far it goes ``away`` from it.

    The difference of two runs has both in it. Where they are ``compared`` the larger of that and of the way,
    with the error of the curve, is the estimate.
    """
    if not compared:
        return errors[name] + away
    curve = "contact_radius" if name.endswith("radius") else "force"
    return max(errors[name], errors.get(curve, 0.0) + away)


@dataclass(frozen=True)
class _Missed:
    """What a column may do between the rows beside its largest value.

    Parameters
    ----------
    excess : float
        By how much it may exceed that value; 0 where it is located to round-off.
    begin, end : float
        Times between which it may be larger.
    """

    excess: float
    begin: float
    end: float

    def away(self, trace: Trace, column: Array, row: int) -> float:
        """Farthest that a column goes from the row between these times, straight between rows."""
        time, distances = trace.time, [0.0]
        if self.begin < time[row]:
            share = (time[row] - self.begin) / (time[row] - time[row - 1])
            distances.append(share * abs(float(column[row] - column[row - 1])))
        if self.end > time[row]:
            share = (self.end - time[row]) / (time[row + 1] - time[row])
            distances.append(share * abs(float(column[row + 1] - column[row])))
        return max(distances)


def _missed_maximum(trace: Trace, values: Array, row: int, corner: bool = False) -> _Missed:
    """Where between the rows beside its largest value a column may exceed it, and by how much.

    Around its maximum it is a concave curve, smooth or with a corner: between two rows it lies below the
    straight lines through the two rows before and through the two rows after. Where the maximum is located,
    at a corner or at the end of the contact, these lines meet in it, to round-off. At a ``corner`` that is
    known to be one, the lines beyond it say nothing: on a side on which the slope, extrapolated to the
    corner, leads up to it, there is no larger value.
    """
    end = int(np.flatnonzero(trace.contact_radius > 0.0)[-1]) + 1
    time, values = trace.time[:end], values[:end]
    largest, most = float(values[row]), float(values[row])
    span = [float(time[row]), float(time[row])]

    def slope(first: int) -> float | None:
        if first < 0 or first + 1 >= end or time[first + 1] <= time[first]:
            return None
        return float((values[first + 1] - values[first]) / (time[first + 1] - time[first]))

    for side, first in enumerate((row - 1, row)):
        if slope(first) is None:
            continue
        h = float(time[first + 1] - time[first])
        left, right = float(values[first]), float(values[first + 1])
        before, after = slope(first - 1), slope(first + 1)
        top, reach = largest, h
        if corner and _leads_up(trace.time, values, row, first):
            continue
        if before is None and after is None:
            top = largest + 0.5 * abs(right - left)
        elif before is None or after is None:
            top = left + before * h if before is not None else right - (after or 0.0) * h
        elif before > after:
            at = min(max((right - left - after * h) / (before - after), 0.0), h)
            top = min(left + before * at, right - after * (h - at))
        if top <= largest + ROUND_OFF * abs(largest):
            continue
        rise = (before, -after if after is not None else None)[side]
        if rise is not None and rise > 0.0:
            reach = h - (largest - (left, right)[side]) / rise
        most = max(most, top)
        span[side] += (-1.0, 1.0)[side] * min(max(reach, 0.0), h)
    return _Missed(most - largest, *span)


def _turns(trace: Trace, spans: Array) -> Array:
    """Times at which load steps begin and end, and at which a stage turns, which may be where it has pressed
    the indenter to some force."""
    stage = trace.extra.get("stage")
    if stage is None:
        return spans.ravel()
    moved = np.sign(np.diff(stage))
    return np.concatenate((spans.ravel(), trace.time[1:-1][moved[1:] * moved[:-1] < 0.0]))


def _leads_up(time: Array, values: Array, row: int, first: int) -> bool:
    """Whether a column leads up to a row from the interval that starts at ``first``, by three rows."""
    near, far = (first, first - 1) if first < row else (first + 1, first + 2)
    if not (0 <= far < len(values) and time[near] != time[far]):
        return False
    inner = float(values[row] - values[near]) / float(time[row] - time[near])
    outer = float(values[near] - values[far]) / float(time[near] - time[far])
    slope = inner + (inner - outer) * float(time[row] - time[near]) / float(time[row] - time[far])
    return slope > 0.0 if first < row else slope < 0.0


def _on_plateau(trace: Trace, row: int) -> bool:
    """Whether the tension is prescribed up to this row: it ends at once, with the contact or in a jump."""
    before = trace.time[:row] < trace.time[row]
    later = row + 1 < len(trace) and trace.contact_radius[row + 1] > 0.0
    if not before.any() or (later and trace.time[row + 1] > trace.time[row]):
        return False
    last = int(np.flatnonzero(before)[-1])
    return bool(abs(trace.force[last] - trace.force[row]) <= ROUND_OFF * abs(trace.force[row]))


def _reach(height: Array, column: Array, row: int, least: float) -> float:
    """How far a column goes from the row at the largest height to where the height is ``least``.

    Another peak that is hardly lower counts too: the run does not resolve which of the two is larger.
    """
    farthest = float(np.abs(column[height >= least] - column[row]).max())
    for side in (slice(row, None, -1), slice(row, None)):
        heights, values = height[side], column[side]
        below = np.flatnonzero(heights < least)
        last = int(below[0]) if below.size else len(heights) - 1
        if last == 0:
            continue
        drop = heights[last - 1] - heights[last]
        share = min((heights[last - 1] - least) / drop, 1.0) if below.size and drop > 0.0 else 1.0
        end = values[last - 1] + share * (values[last] - values[last - 1])
        farthest = max(farthest, abs(float(end - column[row])))
    return farthest
