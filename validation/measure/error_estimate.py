"""Error estimates of a run: within their sum two solvers agree.

The reference brings its own estimates (``Trace.errors``). Boundary and finite elements are run a second time,
everything coarser by a ratio ``r``, 2 where the resolution is even: half the resolution, four times the step
tolerance, and the finite elements' mesh grades by its root faster. A run that cannot be coarser is
compared with a finer one, ``r`` = 1/2. Two runs cannot prove an order, hence the factor 3 customary for two
grids (Roache 1994):

    ``estimate = 3 |other - run|/|r - 1|``,

as of first order. Both solvers converge faster, but not in every part of a run: annuli that resolve the layer
behind an advancing edge do not double with the resolution, a loop adds up the errors of steps that do not all
halve, an edge at rest up to a corner of the force begins to move within an element or a step, and at a limit
point, where contact is lost, the edge moves as the root of the load. With the second order estimates of the
finite elements fell short by up to 2.7 times in the paper's suite, those of the boundary elements by 1.7.

Curves are known at rows only: what they may do between is added (:mod:`validation.measure.curves`). The
difference of two runs can vanish by accident. So the estimate of a scalar is at least the mean error of the
curves of its run; that of a penetration at least the mean error of the
penetration, too; that of a square at least twice as much. (Not the root mean square, which a short time
dominates: the end, where an edge that runs away is a little early or late.) An energy is no better than
twice the RMS difference of the losses of both runs. The excess at the edge is the difference of two
energies, and has the errors of both.

An extremum (end of approach, largest force, pull-off) of a run with the error ``e(t)`` lies where
``F(t) + e(t)`` is largest: an error that is the same in all rows does not move it. It may be anywhere where
``F`` falls short by no more than ``|e - e_row|``, but at least by half of ``e_row``, since how two runs
differ from row to row may vanish by accident. To that comes what the rows leave open
(:mod:`validation.measure.events`), or what the solver says of an event that it has located.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contact_scene import Loading, Trace
from contact_scene.trace import Array
from validation.measure import curves
from validation.measure.events import SAFETY, after_last_contact, extrema, last_in_contact, left_open
from validation.measure.observables import at_last_contact, largest_fall
from validation.measure.scaling import column_of, scale
from validation.measure.windows import windows

OF_SQUARE = 2.0
"""Relative error of a square over that of what is squared."""
VARIED = 0.5
"""Least change of an error near an extremum, relative to that error: it may vanish by accident."""
IN_LAYERS = ("branch_dissipation", "zone_excess")
"""Squares of the stress in the layer at the edge."""
ENERGIES = ("loop_energy", "dissipated_energy", "loss_fall", "peak_cycle_loss", *IN_LAYERS)
Measures = Mapping[str, float | None]


def from_two_runs(
    run: Trace,
    other: Trace,
    measured: Measures,
    otherwise: Measures,
    ratio: float = 2.0,
    loading: Loading | None = None,
) -> dict[str, float]:
    """Relative errors of a run from its difference from a coarser or finer one of the same solver.

    By observable, of its curves by column, of their movement by column with ``MOVEMENT``. ``measured`` and
    ``otherwise`` are the scalars of either run; ``ratio``, not 1, is that of step and element sizes of the
    second run to those of the first. The loading divides the run into windows.
    """
    spans, factor = _spans(loading, run), SAFETY / abs(ratio - 1.0)
    apart = {column: curves.distance(other, run, column, spans) for column in (*curves.CURVES, "penetration")}
    errors, least = {}, 0.0
    for column in curves.CURVES:
        gap = apart[column]
        if gap is not None:
            between = curves.interpolation_error(run, column, spans)
            errors[column] = factor * gap.rms + between
            least = max(least, factor * gap.mean + between)
    depths = apart["penetration"]
    heat, loss = _losses_apart(run, other, spans)
    for name, value in measured.items():
        there = otherwise.get(name)
        if value is None or there is None or not _has_error(name):
            continue
        on_the_way = heat if name in IN_LAYERS else loss if name in ENERGIES else 0.0
        relative_to = scale(name, value, run)
        differs = max(abs(there - value), on_the_way) / relative_to if relative_to > 0.0 else 0.0
        errors[name] = max(factor * differs, (OF_SQUARE if name in IN_LAYERS else 1.0) * least)
        if column_of(name) == "penetration" and depths is not None:  # what a prescribed force leaves open
            errors[name] = max(errors[name], factor * depths.mean)
    _raise_to_balance(errors, run, measured)
    for column in curves.CURVES if len(spans) else ():
        moved = curves.movement_distance(other, run, spans, column)
        if moved is not None:
            unknown = curves.movement_interpolation_error(run, spans, column)
            errors[column + curves.MOVEMENT] = factor * moved.rms + unknown
    for event in extrema(run, spans.ravel()):
        if event.observable in errors:
            gap = apart[event.column]
            usually = gap.rms * event.size if gap is not None and event.column == "force" else 0.0
            moved_by = abs((measured[event.observable] or 0.0) - (otherwise[event.observable] or 0.0))
            level = factor * max(moved_by, usually)
            error, signed = np.full(len(run), level), factor * _rows_apart(run, other, event.column, spans)
            if np.isfinite(signed[event.row]):
                known = np.isfinite(signed)
                varied = np.abs(signed[known] - signed[event.row])
                error[known] = np.clip(varied, 0.0 if event.corner else VARIED * level, level)
            _add(errors, run, event.name, event.row, left_open(run, event, error), True, event.column)
    if measured.get("detachment_radius") != 0.0:
        _add(errors, run, "detachment", last_in_contact(run), after_last_contact(run), True)
    return errors


def from_own(trace: Trace, measured: Measures, loading: Loading | None = None) -> dict[str, float]:
    """The estimates of a solver that makes its own; a scalar it does not name has the largest of them.

    Where it names none for the movement of a curve, it is bounded by that of the curve. Arguments as of
    :func:`from_two_runs`.
    """
    largest = max(trace.errors.values(), default=0.0)
    spans = _spans(loading, trace)
    own = {column: trace.errors[column] for column in curves.CURVES if column in trace.errors}
    errors = {
        column: error + curves.interpolation_error(trace, column, spans) for column, error in own.items()
    }
    for name, value in measured.items():
        if value is not None and _has_error(name):
            errors[name] = trace.errors.get(name, largest)
    if "loss_fall" in errors:  # between the rows it may be larger, and its crest is no corner
        errors["loss_fall"] += curves.interpolation_error(trace, "dissipated_energy", spans)
        (fall, begin, end), loss = largest_fall(trace), trace.dissipated_energy
        errors["loss_fall"] += (fall - loss[begin] + loss[end]) / (scale("loss_fall", fall, trace) or 1.0)
    for column, error in own.items() if len(spans) else ():
        bound = curves.movement_bound(trace, spans, column) * error
        between = curves.movement_interpolation_error(trace, spans, column)
        errors[column + curves.MOVEMENT] = trace.errors.get(column + curves.MOVEMENT, bound) + between
    for event in extrema(trace, spans.ravel()):
        level = errors.get(event.observable, 0.0) * event.size if event.column == "force" else 0.0
        _add(errors, trace, event.name, event.row, left_open(trace, event, np.full(len(trace), level)))
    if measured.get("detachment_radius") != 0.0:
        _add(errors, trace, "detachment", last_in_contact(trace), after_last_contact(trace))
    return errors


def _has_error(name: str) -> bool:
    return bool(column_of(name)) or name in ENERGIES


def _add(
    errors: dict[str, float],
    trace: Trace,
    event: str,
    row: int,
    away: Mapping[str, float],
    compared: bool = False,
    located_by: str = "",
) -> None:
    """Raise the errors at an event by how far ``away`` from its row it may be, by column.

    ``compared``: the errors come from the difference of two runs, which holds that distance already but for
    the column that the event is ``located_by``; there the estimate is the larger of that difference and of
    the error of the curve with the distance.
    """
    for column, distance_away in away.items():
        key = f"{event}_{'radius' if column == 'contact_radius' else column}"
        relative_to = scale(key, float(trace.columns()[column][row]), trace)
        if key in errors and relative_to > 0.0:
            curve = errors.get("contact_radius" if column == "contact_radius" else "force", 0.0)
            at_row = curve if compared and column != located_by else errors[key]
            errors[key] = max(errors[key], at_row + distance_away / relative_to)


def _losses_apart(run: Trace, other: Trace, spans: Array) -> tuple[float, float]:
    """Twice the RMS difference of two runs in what the branches dissipate, and in all that is dissipated.

    Losses that differ on the way may agree at the end by accident. They count twice, as squares of a stress.
    Zero where nothing relaxes: there losses are jumps, at times that differ a little.
    """
    heat = run.columns().get("branch_dissipation", np.empty(0))
    if not heat.size or heat[-1] <= 0.0 or "branch_dissipation" not in other.columns():
        return 0.0, 0.0
    found = []
    for column in ("branch_dissipation", "dissipated_energy"):
        apart = curves.distance(other, run, column, spans)
        size = float(np.abs(run.columns()[column]).max())
        found.append(0.0 if apart is None else OF_SQUARE * apart.rms * size)
    return found[0], found[1]


def _raise_to_balance(errors: dict[str, float], run: Trace, measured: Measures) -> None:
    """Raise the errors of energies to what the run's own energies, each integrated alone, leave unexplained.

    The excess at the edge is the difference of two of them, and has the errors of both.
    """
    left = at_last_contact(run, "balance_residual")
    if left is not None and errors.get("dissipated_energy", 0.0) > 0.0:
        relative_to = scale("dissipated_energy", measured["dissipated_energy"] or 0.0, run)
        errors["dissipated_energy"] = max(errors["dissipated_energy"], abs(left) / relative_to)
    terms = ("branch_dissipation", "dissipated_energy")
    if "zone_excess" in errors and all(name in errors for name in terms):
        sizes = [scale(name, measured[name] or 0.0, run) for name in (*terms, "zone_excess")]
        both = sum(errors[name] * size for name, size in zip(terms, sizes, strict=False))
        errors["zone_excess"] = max(errors["zone_excess"], both / sizes[-1] if sizes[-1] > 0.0 else 0.0)


def _spans(loading: Loading | None, trace: Trace) -> Array:
    """Begin and end of every window, shape (k, 2); none without a loading or rows."""
    return windows(loading, trace) if loading is not None and len(trace) else np.empty((0, 2))


def _rows_apart(run: Trace, other: Trace, column: str, spans: Array) -> Array:
    """Difference of another run in every row, shape (n,); nan where it has ended."""
    if len(other) < 2:
        return np.full(len(run), np.nan)
    within = (run.time >= other.time[0]) & (run.time <= other.time[-1])
    there = curves.column_curve(other, column, spans).values(np.clip(run.time, other.time[0], other.time[-1]))
    return np.where(within, there, np.nan) - run.columns()[column]
