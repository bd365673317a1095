"""Error estimates of a run: within their sum two solvers agree.

The reference brings its own estimates (``Trace.errors``). Boundary and finite elements are run a second time,
everything coarser by a ratio ``r``, 2 where the resolution is even: half the resolution, four times the step
tolerance, and for the finite elements a mesh that grades twice as fast. A run that cannot be coarser is
compared with a finer one, ``r`` = 1/2. Two runs cannot prove an order, hence the factor 3 customary for two
grids (Roache 1994):

    ``estimate = 3 |other - run|/|r^p - 1|``.

``p`` is 2 for the finite elements. For the boundary elements it is 1: static states converge faster, but the
annuli that resolve the layer behind an advancing edge do not double with the resolution, and with 2 the
estimates of whole cycles fell short of the true error (by up to 1.7 times in the quick suite). Energies have
p = 1 too: what the branches dissipate squares the stress in the layer at a sharp edge, and a loop adds up the
errors of steps that do not all halve from one run to the other. So has the pull-off: an edge at rest up to a
corner of the force begins to move within an element or a step. At a limit point, where contact is lost, the
edge moves as the root of the load: radius and force there have half the order.

Curves are known at rows only: what they may do between is added (:mod:`row_interpolation`). Relative to its
excursion in the worst window a curve has an estimate of its own, so that a small oscillation is not lost in
the size of the contact.

The difference of two runs can vanish by accident, so no scalar is held to be better than the curves of its
run are in the mean at its order, a penetration than that of the penetrations too (root mean squares are those
of the last moments, where an edge that runs away is a little early or late); a square, than twice that. An
energy is no better than the losses of both runs on the way to it. The excess at the edge is a difference,
uncertain by what its two terms are. What the rows leave open of the end of approach, the pull-off and the
detachment is added (:mod:`place_errors`).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contact_scene import Loading, Trace
from contact_scene.trace import Array
from validation.measure.movement_norms import movement_bound, movement_distance, movement_interpolation_error
from validation.measure.norms import CURVES, distance, interpolation_error
from validation.measure.observables import at_last_contact
from validation.measure.place_errors import (
    SAFETY,
    add_at_approach,
    add_at_detachment,
    add_at_peak,
    add_at_pull_off,
)
from validation.measure.row_interpolation import column_curve
from validation.measure.scaling import column_of, scale
from validation.measure.windows import load_step_ends, windows
from validation.solvers import solver

IN_LAYERS = ("branch_dissipation", "zone_excess")
"""Quantities of first order: squares of the stress in the layer at the edge."""
OF_SQUARE = 2.0
"""Relative error of a square over that of what is squared."""
AT_LIMIT_POINTS = ("detachment_radius", "detachment_force")
"""Quantities of first order where others are of second: the edge runs away as the root of the load."""
ENERGIES = ("loop_energy", "dissipated_energy", "loss_fall", "peak_cycle_loss", *IN_LAYERS)
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
    spans = _spans(loading, run)
    errors, floors = _of_curves(run, other, usual, ratio, spans)
    heat, loss = _losses_apart(run, other, spans)
    depths = distance(other, run, "penetration", spans)
    mean_depth = 0.0 if depths is None else depths.mean
    for name, value in measured.items():
        there = otherwise.get(name)
        if value is None or there is None or not (column_of(name) or name in ENERGIES):
            continue
        relative_to = scale(name, value, run)
        first = name in (*ENERGIES, *AT_LIMIT_POINTS) or name.startswith("pull_off")
        order = 1.0 if first else usual
        on_the_way = heat if name in IN_LAYERS else loss if name in ENERGIES else 0.0
        differs = max(abs(there - value), on_the_way)
        own = _extrapolated(differs / relative_to, order, ratio) if relative_to > 0.0 else 0.0
        errors[name] = max(own, (OF_SQUARE if name in IN_LAYERS else 1.0) * floors[order])
        if column_of(name) == "penetration":  # what a prescribed force leaves to be found
            errors[name] = max(errors[name], _extrapolated(mean_depth, order, ratio))
    _raise_to_balance(errors, run, measured)
    if len(spans):
        for column in CURVES:
            moved = movement_distance(other, run, spans, column)
            if moved is not None:
                between = movement_interpolation_error(run, spans, column)
                errors[column + MOVEMENT] = _extrapolated(moved.rms, usual, ratio) + between
    deepest, other_deepest = measured.get("approach_penetration"), otherwise.get("approach_penetration")
    change = 0.0 if deepest is None or other_deepest is None else abs(other_deepest - deepest)
    of_depth = _apart(run, other, "penetration", usual, ratio, spans)
    add_at_approach(errors, run, spans, _extrapolated(change, usual, ratio), of_depth)
    apart = distance(other, run, "force", spans)
    usually = 0.0 if apart is None else _extrapolated(apart.rms, 1.0, ratio)
    of_force = _apart(run, other, "force", 1.0, ratio, spans)
    add_at_peak(errors, run, spans, of_force, usually)
    add_at_pull_off(errors, run, of_force, usually)
    add_at_detachment(errors, run, measured.get("detachment_radius"), compared=True)
    return errors


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
    spans = _spans(loading, trace)
    own = {column: trace.errors[column] for column in CURVES if column in trace.errors}
    errors = {column: error + interpolation_error(trace, column, spans) for column, error in own.items()}
    for name, value in measured.items():
        if value is not None and (column_of(name) or name in ENERGIES):
            errors[name] = trace.errors.get(name, largest)
    if len(spans):
        for column, error in own.items():
            bound = movement_bound(trace, spans, column) * error
            between = movement_interpolation_error(trace, spans, column)
            errors[column + MOVEMENT] = trace.errors.get(column + MOVEMENT, bound) + between
    add_at_approach(errors, trace, spans)
    add_at_peak(errors, trace, spans)
    add_at_pull_off(errors, trace)
    add_at_detachment(errors, trace, measured.get("detachment_radius"))
    return errors


def _of_curves(
    run: Trace, other: Trace, usual: float, ratio: float, spans: Array
) -> tuple[dict[str, float], dict[float, float]]:
    """Errors of the curves by column, and the least error of a scalar by the order that it converges with."""
    errors = {}
    floors = {1.0: 0.0, usual: 0.0}
    for column in CURVES:
        apart = distance(other, run, column, spans)
        if apart is not None:
            between = interpolation_error(run, column, spans)
            errors[column] = _extrapolated(apart.rms, usual, ratio) + between
            for order, floor in floors.items():
                floors[order] = max(floor, _extrapolated(apart.mean, order, ratio) + between)
    return errors, floors


def _losses_apart(run: Trace, other: Trace, spans: Array) -> tuple[float, float]:
    """How far what two runs dissipate in branches, and in all, lies apart on the way: root mean square.

    What differs to and fro may agree at the end by accident. The heat in the layer at the edge is a square.
    Where nothing relaxes a contact loses in jumps, at the time of which two runs differ: no such difference.
    """
    heat = run.columns().get("branch_dissipation", np.empty(0))
    if not heat.size or heat[-1] <= 0.0 or "branch_dissipation" not in other.columns():
        return 0.0, 0.0
    found = []
    for column in ("branch_dissipation", "dissipated_energy"):
        apart = distance(other, run, column, spans)
        size = float(np.abs(run.columns()[column]).max())
        found.append(0.0 if apart is None else apart.rms * size)
    return OF_SQUARE * found[0], found[1]


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


def _extrapolated(difference: float, order: float, ratio: float) -> float:
    return SAFETY * difference / abs(ratio**order - 1.0)


def _apart(run: Trace, other: Trace, column: str, order: float, ratio: float, spans: Array) -> Array:
    """Estimated error of a column in every row, signed; nan where the other run has ended.

    Parameters
    ----------
    run, other : Trace
    column : str
        Name of the column.
    order, ratio : float
        As of :func:`from_two_runs`.
    spans : ndarray, shape (k, 2)
        Windows of the run.

    Returns
    -------
    ndarray, shape (n,)
    """
    if len(other) < 2:
        return np.full(len(run), np.nan)
    within = (run.time >= other.time[0]) & (run.time <= other.time[-1])
    curve = column_curve(other, column, load_step_ends(spans))
    difference = np.array(
        [curve.at(float(time)) if here else np.nan for time, here in zip(run.time, within, strict=True)]
    )
    return (difference - run.columns()[column]) * _extrapolated(1.0, order, ratio)
