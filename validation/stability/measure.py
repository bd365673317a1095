"""Errors of a run against each kind of expected answer, and what its energies leave unexplained."""

from __future__ import annotations

import math

import numpy as np

from contact_scene import COLUMNS, Material, Trace
from validation.measure.curves import distance
from validation.measure.difference import of_curves, of_numbers
from validation.measure.observables import observe
from validation.runs.run import Run
from validation.stability.case import EquivalentScene, ReferenceRuns, Value

CURVE = "force, RMS"
"""Name of the error of the curve ``F(t)``: root mean square over the largest force."""
RICHARDSON = 1.0 / 3.0
"""Error of the finer of two runs of second order over their difference, the coarser at twice the step."""
MISSING = math.inf
"""Error of an observable that a run should have and does not have."""


def against_values(trace: Trace, values: tuple[Value, ...]) -> dict[str, float]:
    """Relative error of every value."""
    measured = observe(trace).as_dict()
    return {value.name: _relative(measured[value.name], value.value, value.unit) for value in values}


def against_trace(trace: Trace, reference: Trace, observables: ReferenceRuns) -> dict[str, float]:
    """Relative difference of every observable of two runs, ``MISSING`` where only one has it."""
    run, base = (
        Run("", one.solver, one, measures=dict(observe(one).as_dict())) for one in (trace, reference)
    )
    numbers = of_numbers(run, base, observables.names, observables.of_largest)
    errors = dict.fromkeys(observables.names, 0.0) | {one.quantity: abs(one.error) for one in numbers}
    if CURVE in errors:
        errors[CURVE] = next(one.error for one in of_curves(run, base) if one.quantity == "force")
    return errors


def against_equivalent(trace: Trace, base: Trace, equivalent: EquivalentScene) -> dict[str, float]:
    """Largest difference of any row, relative to the column's largest magnitude.

    Runs that have not the same number of rows are compared as curves instead.

    Parameters
    ----------
    trace : Trace
    base : Trace
        Run on ``equivalent.scene``.
    equivalent : EquivalentScene
        Its factors turn the columns of ``base`` into those of ``trace``.

    Returns
    -------
    dict of str to float
        By column, or of the curve alone.
    """
    force, energy = equivalent.stress * equivalent.length**2, equivalent.stress * equivalent.length**3
    factors = (equivalent.time, equivalent.length, force, equivalent.length, energy, energy, energy)
    if len(trace) != len(base):
        apart = None
        if equivalent.length == equivalent.stress == equivalent.time == 1.0:
            apart = distance(trace, base)
        return {CURVE: MISSING if apart is None else apart.rms}
    largest_energy = energy * float(max(np.abs(base.stored_energy).max(), np.abs(base.external_work).max()))
    errors = {}
    for name, factor in zip(COLUMNS, factors, strict=True):
        expected = factor * getattr(base, name)
        unit = float(np.abs(expected).max())
        if name == "dissipated_energy":  # what a balance leaves is as exact as its largest term
            unit = max(unit, largest_energy)
        errors[name] = float(np.abs(getattr(trace, name) - expected).max()) / (unit or 1.0)
    return errors


def energy_residual(trace: Trace, material: Material) -> float | None:
    """What the energies of a run leave unexplained while in contact, relative to the largest of them.

    At a sharp edge ``W = dU + P_b - int K^2/(2 Einf*) dA``, with the stored energy ``U`` and the branch
    dissipation ``P_b`` from integrals of their own; the work of adhesion does not enter. A solver that knows
    no stress intensity factor keeps such a residual itself (``balance_residual``).
    """
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if touching.size < 2:
        return None
    rows = slice(0, int(touching[-1]) + 1)
    work, stored = trace.external_work[rows], trace.whole_stored_energy[rows]
    unit = max(float(np.abs(work).max()), float(stored.max())) or 1.0
    if "balance_residual" in trace.extra:
        return float(np.abs(trace.extra["balance_residual"][rows]).max()) / unit
    if not {"branch_dissipation", "stress_intensity_factor"} <= trace.extra.keys():
        return None
    release = trace.extra["stress_intensity_factor"][rows] ** 2 / (2.0 * material.glassy_plane_modulus)
    opened = -np.diff(np.pi * trace.contact_radius[rows] ** 2)
    released = np.concatenate(([0.0], np.cumsum(0.5 * (release[1:] + release[:-1]) * opened)))
    left = work - work[0] - (stored - stored[0]) - trace.extra["branch_dissipation"][rows] - released
    return float(np.abs(left).max()) / unit


def _relative(measured: float | None, value: float, unit: float) -> float:
    if measured is None:
        return MISSING
    return abs(measured - value) / (unit or 1.0)
