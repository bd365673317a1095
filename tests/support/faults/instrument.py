"""Single faults in what an instrument's scene says: spring, levels, hysteresis, rate, stress, temperature.

``scenes`` holds the check of :mod:`all_solvers.test_instrument_faults` that has to show the fault.
"""

from __future__ import annotations

from support.faults.injection import by, changed, table, takes, times


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
