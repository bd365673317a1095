"""Wrong versions of what an edge takes up, and of a zone that opens steadily: check values show each."""

from __future__ import annotations

import numpy as np
import pytest
from support.faults.injection import by, changed, constant, found_wrong, gives, stale, table, takes, times

from validation.cases import load
from validation.compare.checks import check_run
from validation.runs.run import run
from validation.solvers import SOLVERS

HYSTERESIS, RATED, STRESS = "hysteresis-si", "rated-edge-si", "fixed-stress-si"
STEADY_RATE, STEADY_STRESS = "steady-rate-si", "steady-stress-si"


def closing_as_opening(true):
    return lambda adhesion, *given: true(adhesion, *given) if given[0] <= 0.0 else adhesion.work


def longer_by(factor):
    return lambda true: lambda *given: factor * (true(*given) or 0.0) or None


def timed(factor):
    """A half-space whose branches relax slower, or at once."""
    slower = changed(time=by(factor))
    return takes(material=changed(branches=lambda branches: tuple(map(slower, branches))))


SPEED, TAKEN = "speed twice too large", "energy taken up a tenth too large"
AT_REST, FORGOTTEN, TWICE = "zone as at rest", "enhancement forgotten", "enhancement at twice the speed"
FAULTS = table("reference", "validation.reference.path", [
    (SPEED, "trial:Arrival.speed", times(2.0), RATED),
    (f"{SPEED}, steadily", "trial:Arrival.speed", times(2.0), STEADY_RATE),
    (TAKEN, "edge_law:EdgeLaw.taken_up", times(1.1), RATED),
    ("zone a tenth too long", "closure:zone_length", times(1.1), STRESS),
    (AT_REST, "trial:Trial.zone_at_stress", lambda true: lambda self, *given: self.law.zone,
     STEADY_STRESS),
    (FORGOTTEN, "rheology:rheology", timed(1e-4), STEADY_RATE),
    (TWICE, "rheology:rheology", timed(2.0), STEADY_STRESS),
])  # fmt: skip
FAULTS += table("bem", "bem_solver", [
    ("closes at what it opens at", "problem:energy_taken", closing_as_opening, HYSTERESIS),
    ("always pinned", "problem:closure_of_departure", constant(None), HYSTERESIS),
    (SPEED, "problem:end_velocity", times(2.0), RATED),
    (f"{SPEED}, steadily", "problem:end_velocity", times(2.0), STEADY_RATE),
    ("energy spent too large", "recorder:energy_spent", times(1.1), HYSTERESIS),
    ("tension a tenth too large", "trial:forces_over", gives(lambda found: (found[0], 1.1 * found[1])),
     STRESS),
    (AT_REST, "trial:_zone", lambda true: lambda problem, surface: problem.zone, STEADY_STRESS),
    (FORGOTTEN, "creep:Chain.__init__", timed(1e-4), STEADY_RATE),
    (TWICE, "creep:Chain.__init__", timed(2.0), STEADY_STRESS),
])  # fmt: skip
FAULTS += table("fem", "fem_solver", [
    (SPEED, "state:ComponentState.opening_speed", times(2.0), RATED),
    (f"{SPEED}, steadily", "state:ComponentState.opening_speed", times(2.0), STEADY_RATE),
    ("energy spent too large", "edge:energy_spent", times(1.1), HYSTERESIS),
    ("zone twice too long", "closure:zone_length", longer_by(2.0), STRESS),
    (AT_REST, "contact_problem:ContactProblem.zone", lambda true: lambda self, s: self.geometry.zone,
     STEADY_STRESS),
    (FORGOTTEN, "setup:moduli", timed(1e-4), STEADY_RATE),
    (TWICE, "setup:moduli", timed(2.0), STEADY_STRESS),
])  # fmt: skip
FAULTS += table("fem", "contact_scene", [
    ("closes at what it opens at", "adhesion:Adhesion.closing", lambda true: lambda self: self.work,
     HYSTERESIS),
])  # fmt: skip


def wrong(solver, name):
    """What is missed on a scene: check values, and of an elastic half-space what goes into its interface."""
    case = load(name)
    found, adhesion = run(case, solver), case.scene.adhesion
    missed = [check.quantity.partition(" ")[0] for check in check_run(case, found) if not check.passed]
    if found.trace is None or not case.scene.material.is_elastic:
        return missed
    trace = found.trace
    opened = -np.pi * np.diff(trace.contact_radius**2)
    by_radius = np.sum(np.where(opened > 0.0, adhesion.work, adhesion.closing) * opened)
    if adhesion.rate is None and abs(trace.extra["separation_energy"][-1] / by_radius - 1.0) > 1e-6:
        missed.append("separation_energy")
    touching = trace.contact_radius > 0.0
    if np.abs(trace.dissipated_energy[touching]).max() > 0.1 * np.abs(trace.external_work).max():
        missed.append("balance")  # it loses what the finite zone takes, and no more
    return missed


def test_every_fault_has_its_function():
    assert stale(FAULTS) == []
    assert len({fault.key for fault in FAULTS}) == len(FAULTS)


@pytest.mark.exhaustive
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", [HYSTERESIS, RATED, STRESS, STEADY_RATE, STEADY_STRESS])
def test_the_true_solvers_miss_nothing(solver, name):
    assert wrong(solver, name) == []


@pytest.mark.slow
def test_what_a_rated_edge_takes_up_is_checked():
    """For the cheapest solver: a column of its own, which neither force nor radius depends on."""
    (fault,) = [fault for fault in FAULTS if fault.name == TAKEN]
    assert wrong("reference", RATED) == []
    calls, missed = found_wrong(fault, wrong, 30.0)
    assert calls > 0
    assert missed == ["separation_energy"]


@pytest.mark.exhaustive
@pytest.mark.parametrize("fault", FAULTS, ids=[fault.key for fault in FAULTS])
def test_a_fault_shows(fault):
    calls, missed = found_wrong(fault, wrong, 60.0)
    assert calls > 0
    assert missed != []
