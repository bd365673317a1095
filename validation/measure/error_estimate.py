"""Error estimates of a run: within their sum two solvers agree.

The reference brings its own estimates (``Trace.errors``). Boundary and finite elements are run a second time,
everything twice as coarse: half the resolution, four times the step tolerance, and for the finite elements a
mesh that grades twice as fast. Two runs cannot prove an order, hence the factor 3 customary for two grids
(Roache 1994):

    ``estimate = 3 |coarse - fine|/(2^p - 1)``.

``p`` is 2 for the finite elements. For the boundary elements it is 1: static states converge faster, but the
annuli that resolve the layer behind an advancing edge do not double with the resolution, and with 2 the
estimates of whole cycles fell short of the true error (by up to 1.7 times in the quick suite). What the
branches dissipate has p = 1 too, because it squares the stress in the layer at a sharp edge.

The difference of two runs can vanish by accident, so no scalar is held to be better than the curves of its
run. The excess at the edge is a difference, uncertain by what its two terms are. The largest tension is a row
of the trace: it is also uncertain by half the distance to the neighbouring rows. Its place is uncertain by
the whole distance, since it lies anywhere between them, and by that over which the tension falls by its own
error.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from contact_scene import Trace
from contact_scene.trace import Array
from validation.measure.norms import distance
from validation.measure.observables import pull_off_row
from validation.measure.scaling import column_of, scale
from validation.solvers import solver

SAFETY = 3.0
"""Safety factor on the extrapolated error of two grids, whose order is not observed (Roache 1994)."""
IN_LAYERS = ("branch_dissipation", "zone_excess")
"""Quantities of first order: squares of the stress in the layer at the edge."""
ENERGIES = ("loop_energy", "dissipated_energy", "peak_cycle_loss", *IN_LAYERS)
CURVES = ("force", "contact_radius")
Measures = Mapping[str, float | None]


def from_two_runs(fine: Trace, coarse: Trace, measured: Measures, coarsely: Measures) -> dict[str, float]:
    """Errors of the finer of two runs, ``3 |coarse - fine|/(2^p - 1)``.

    Parameters
    ----------
    fine, coarse : Trace
        Of one solver, the second twice as coarse.
    measured, coarsely : mapping of str to float or None
        Scalars of either run by name.

    Returns
    -------
    dict of str to float
        Relative errors of the finer run by observable, and of its curves by column.
    """
    usual = solver(fine.solver).order
    errors = {}
    for column in CURVES:
        apart = distance(coarse, fine, column)
        if apart is not None:
            errors[column] = _extrapolated(apart.rms, usual)
    floor = max(errors.values(), default=0.0)
    for name, value in measured.items():
        other = coarsely.get(name)
        if value is None or other is None or not (column_of(name) or name in ENERGIES):
            continue
        relative_to = scale(name, value, fine)
        order = 1.0 if name in IN_LAYERS else usual
        own = _extrapolated(abs(other - value) / relative_to, order) if relative_to > 0.0 else 0.0
        errors[name] = max(own, floor)
    terms = ("branch_dissipation", "dissipated_energy")
    if "zone_excess" in errors and all(name in errors for name in terms):
        sizes = [scale(name, measured[name] or 0.0, fine) for name in (*terms, "zone_excess")]
        both = sum(errors[name] * size for name, size in zip(terms, sizes, strict=False))
        errors["zone_excess"] = max(errors["zone_excess"], both / sizes[-1] if sizes[-1] > 0.0 else 0.0)
    return _with_sampling(errors, fine)


def from_own(trace: Trace, measured: Measures) -> dict[str, float]:
    """The estimates of a solver that makes its own; a scalar it does not name has the largest of them."""
    largest = max(trace.errors.values(), default=0.0)
    errors = {column: trace.errors[column] for column in CURVES if column in trace.errors}
    for name, value in measured.items():
        if value is not None and (column_of(name) or name in ENERGIES):
            errors[name] = trace.errors.get(name, largest)
    return _with_sampling(errors, trace)


def _extrapolated(difference: float, order: float) -> float:
    return SAFETY * difference / (2.0**order - 1.0)


def _with_sampling(errors: dict[str, float], trace: Trace) -> dict[str, float]:
    row = pull_off_row(trace)
    if row is None:
        return errors
    near = [i for i in (row - 1, row + 1) if 0 <= i < len(trace) and trace.contact_radius[i] > 0.0]
    for name in ("force", "penetration", "radius", "time"):
        column = trace.columns()[column_of(name)]
        relative_to = scale(f"pull_off_{name}", float(column[row]), trace)
        if f"pull_off_{name}" in errors and near and relative_to > 0.0:
            away = max(abs(float(column[i] - column[row])) for i in near)
            if name == "force":
                away *= 0.5
            else:
                away += _reach(trace, column, row, errors.get("pull_off_force", 0.0))
            errors[f"pull_off_{name}"] += away / relative_to
    return errors


def _reach(trace: Trace, column: Array, row: int, error: float) -> float:
    """How far a column goes from the largest tension to where tension is less by a relative error.

    Another peak that is hardly lower counts too: the run does not resolve which of the two is larger.
    """
    least = (1.0 - error) * -trace.force[row]
    farthest = float(np.abs(column[-trace.force >= least] - column[row]).max())
    for side in (slice(row, None, -1), slice(row, None)):
        tension, values = -trace.force[side], column[side]
        below = np.flatnonzero(tension < least)
        last = int(below[0]) if below.size else len(tension) - 1
        if last == 0:
            continue
        drop = tension[last - 1] - tension[last]
        share = min((tension[last - 1] - least) / drop, 1.0) if below.size and drop > 0.0 else 1.0
        end = values[last - 1] + share * (values[last] - values[last - 1])
        farthest = max(farthest, abs(float(end - column[row])))
    return farthest
