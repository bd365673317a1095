"""Spring, level, hysteresis, rate, stress and temperature: numbers on paper, and faults that they show."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.faults.injection import by, changed, seeded, table, takes, time_limit, times

from contact_scene import (
    WLF,
    Adhesion,
    Arrhenius,
    Branch,
    FlatPunch,
    Loading,
    Machine,
    Material,
    PowerRate,
    Ramp,
    Scene,
    at_temperature,
)
from validation.solvers import SOLVERS

ACCURACY = {"reference": 1e-9, "bem": 1e-9, "fem": 1e-3}
LEVEL = 1e-9
"""A level is reached to rounding by every solver."""


def pressed(solver):
    """A punch of ``F = D`` on a spring of 2, so that ``F = X/1.5``; to the force 0.6, back to ``X = 0.2``."""
    steps = (Ramp(3.0, 1.0, until_force=0.6), Ramp(0.2, 1.0))
    scene = Scene(Material(0.75, 0.5), FlatPunch(0.5), Loading("relaxed", 0.1, steps, Machine(2.0)))
    return SOLVERS[solver].solve(scene, 4)


def stage(solver):
    trace = pressed(solver)
    found = trace.extra["stage"][0], trace.extra["stage"][-1], trace.force[-1], trace.time[-1]
    return found, (0.15, 0.2, 0.2 / 1.5, 0.75 + 0.7), ACCURACY[solver]


def work(solver):
    trace = pressed(solver)
    found = trace.external_work[-1], trace.extra["machine_energy"][-1]
    return found, ((0.2**2 - 0.15**2) / 3.0, (0.2 / 1.5) ** 2 / 4.0), ACCURACY[solver]


def level(solver):
    return pressed(solver).force.max(), 0.6, LEVEL


def hysteresis(solver):
    law = Adhesion(3.0, 1.0, 2.0, PowerRate(1.0, 1.0))
    return (law.closing, law.opening(0.0), law.opening(2.0)), (2.0, 3.0, 9.0), 1e-12


def rate(solver):
    return PowerRate(2.0, 3.0).work(5.0, 4.0), 5.0 * (1.0 + 2.0**3), 1e-12


def stress(solver):
    """Maugis' width ``pi E* w/(4 s^2)``."""
    return Adhesion(3.0, stress=2.0).at_rest_on(4.0).zone, math.pi * 4.0 * 3.0 / 16.0, 1e-12


def temperature(solver):
    """Warmer is faster: ``c1 T/(c2 + T)`` decades, and ``Q/R (1/T - 1/T0)``, at a unit of time."""
    material = Material(1.0, 0.5, (Branch(1.0, 1.0),))
    found = [
        at_temperature(material, law, at).branches[0].time
        for law, at in ((WLF(10.0, 50.0, 20.0), 70.0), (Arrhenius(8314.46261815324, 250.0), 500.0))
    ]
    return found, (1e-5, math.exp(1000.0 / 500.0 - 1000.0 / 250.0)), 1e-9


CHECKS = {check.__name__: check for check in (stage, work, level, hysteresis, rate, stress, temperature)}


def _without_stage_work(true):
    def columns(of, machine, events):
        return true(of, machine, events) | {"external_work": of["external_work"]}

    return columns


WHOLE = "the step that passes a level is taken whole"
FAULTS = table("reference", "contact_scene", [
    ("spring of the wrong sign", "loading:Loading.segment", takes(force=by(-1.0)), "stage"),
    ("work of the stage forgotten", "machine:machine_columns", _without_stage_work, "work"),
    ("a step ends at 1.001 of its level", "loading:Trigger.excess",
     lambda true: lambda self, *state: true(self, *state) - 1e-3 * self.level, "level"),
    ("closes at what it opens at", "adhesion:Adhesion.closing", lambda true: lambda self: self.work,
     "hysteresis"),
    ("opens at what it closes at", "adhesion:Adhesion.opening", lambda true: lambda self, speed: self.closing,
     "hysteresis"),
    ("exponent of the rate a tenth too large", "adhesion:PowerRate.work",
     takes(self=changed(exponent=by(1.1))), "rate"),
    ("zone of fixed stress twice as long", "adhesion:Adhesion.zone_for", times(2.0), "stress"),
    ("shift factor upside down (WLF)", "temperature_shift:WLF.log_factor", times(-1.0), "temperature"),
    ("shift factor upside down (Arrhenius)", "temperature_shift:Arrhenius.log_factor", times(-1.0),
     "temperature"),
])  # fmt: skip
FAULTS += table("bem", "bem_solver", [
    (WHOLE, "step:to_level", lambda true: lambda step, trigger, candidate: (
        candidate, true(step, trigger, candidate)[1]), "level"),
])  # fmt: skip
FAULTS += table("fem", "fem_solver", [
    (WHOLE, "time_step:step_to_level", lambda true: lambda run, segment, trigger, contact: (
        contact if true(run, segment, trigger, contact) is not None else None), "level"),
])  # fmt: skip
FAULTS += table("reference", "validation.reference.path", [
    (WHOLE, "continuation:Continuation._to_level", lambda true: lambda self, plan, correction: (
        true(self, plan, correction) and correction), "level"),
])  # fmt: skip
"""Each with the check that has to show it."""


def missed(name, solver):
    found, expected, accuracy = CHECKS[name](solver)
    return not np.allclose(found, expected, rtol=accuracy, atol=0.0)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", CHECKS)
def test_numbers_on_paper_hold(name, solver):
    assert not missed(name, solver)


def test_every_check_has_its_fault():
    assert {name for fault in FAULTS for name in fault.scenes} == set(CHECKS)


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.key)
def test_a_fault_shows(fault):
    (name,) = fault.scenes
    with seeded(fault) as calls, time_limit(10.0):
        shown = missed(name, fault.solver)
    assert calls.count > 0
    assert shown
