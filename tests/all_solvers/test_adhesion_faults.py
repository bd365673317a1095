"""Wrong versions of what the edge takes up, one at a time: check values of the built-in scenes show each."""

from __future__ import annotations

import numpy as np
import pytest
from support.faults.injection import constant, found_wrong, stale, table, times

from validation.cases import load
from validation.measure.observables import observe
from validation.measure.scaling import unit_sizes
from validation.solvers import SOLVERS

HYSTERESIS, RATED, STRESS = "hysteresis-si", "rated-edge-si", "fixed-stress-si"


def closing_as_opening(true):
    return lambda adhesion, *given: true(adhesion, *given) if given[0] <= 0.0 else adhesion.work


def longer_by(factor):
    return lambda true: lambda *given: factor * (true(*given) or 0.0) or None


FAULTS = table("reference", "validation.reference.tracking", [
    ("speed twice too large", "edge_path:PolynomialPath.end_slope", times(2.0), RATED),
    ("energy taken up a tenth too large", "interface_work:taken_at", times(1.1), RATED),
    ("zone a tenth too long", "cohesive_zone:zone_at", times(1.1), STRESS),
])  # fmt: skip
FAULTS += table("bem", "bem_solver", [
    ("closes at what it opens at", "edge_energy:energy_taken", closing_as_opening, HYSTERESIS),
    ("always pinned", "edge_energy:closure_of_departure", constant(None), HYSTERESIS),
    ("speed twice too large", "edge_energy:end_velocity", times(2.0), RATED),
    ("energy spent too large", "edge_energy:energy_spent", times(1.1), HYSTERESIS),
    ("tension a tenth too large", "cohesive_zone:tension_over", times(1.1), STRESS),
])  # fmt: skip
FAULTS += table("fem", "fem_solver", [
    ("speed twice too large", "release:EdgeOrigin.opening_speed", times(2.0), RATED),
    ("energy spent too large", "irreversible_edge:energy_spent", times(1.1), HYSTERESIS),
    ("zone twice too long", "process_zone:zone_length", longer_by(2.0), STRESS),
])  # fmt: skip
FAULTS += table("fem", "contact_scene", [
    ("closes at what it opens at", "adhesion:Adhesion.closing", lambda true: lambda self: self.work,
     HYSTERESIS),
])  # fmt: skip


def spent_by_radius(scene, trace):
    """What an interface without a rate takes up, from the contact area alone."""
    opened = -np.pi * np.diff(trace.contact_radius**2)
    return float(np.sum(np.where(opened > 0.0, scene.adhesion.work, scene.adhesion.closing) * opened))


def wrong(solver, name):
    """Check values that a solver misses on a scene, and balances that do not close; empty if all is well."""
    case = load(name)
    scene = case.scene
    trace = SOLVERS[solver].solve(scene, 6 if solver == "fem" else None)
    found = observe(trace, scene.adhesion.zone, scene.loading).as_dict()
    units = unit_sizes(scene)
    missed = [] if trace.outcome.kind == case.outcome else ["outcome"]
    for expected in case.expected:
        value = expected.value * units[expected.unit]
        scale = max(abs(value), 0.02 * scene.indenter.radius if "penetration" in expected.observable else 0.0)
        measured = found.get(expected.observable)
        if expected.at_time is not None:
            measured = float(np.interp(expected.at_time, trace.time, trace.columns()[expected.observable]))
        if measured is None or abs(measured - value) > expected.tolerance[solver] * scale:
            missed.append(expected.observable)
    spent = trace.extra["separation_energy"]
    if scene.adhesion.rate is None and abs(spent[-1] / spent_by_radius(scene, trace) - 1.0) > 1e-6:
        missed.append("separation_energy")
    touching = trace.contact_radius > 0.0
    if np.abs(trace.dissipated_energy[touching]).max() > 0.1 * np.abs(trace.external_work).max():
        missed.append("balance")  # an elastic half-space loses what the finite zone takes, and no more
    return missed


def test_every_fault_has_its_function():
    assert stale(FAULTS) == []


@pytest.mark.exhaustive
@pytest.mark.parametrize("solver", ["reference", "bem", "fem"])
@pytest.mark.parametrize("name", [HYSTERESIS, RATED, STRESS])
def test_the_true_solvers_miss_nothing(solver, name):
    assert wrong(solver, name) == []


@pytest.mark.slow
def test_what_a_rated_edge_takes_up_is_checked():
    """For the cheapest solver: a column of its own, which neither force nor radius depends on."""
    (fault,) = [fault for fault in FAULTS if "taken_at" in fault.target]
    assert wrong("reference", RATED) == []
    calls, missed = found_wrong(fault, wrong, 30.0)
    assert calls > 0
    assert missed == ["separation_energy"]


@pytest.mark.exhaustive
@pytest.mark.parametrize("fault", FAULTS, ids=[fault.key for fault in FAULTS])
def test_a_fault_shows(fault):
    calls, missed = found_wrong(fault, wrong, 30.0)
    assert calls > 0
    assert missed != []
