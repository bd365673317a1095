"""Single faults in what an instrument's scene says: spring, levels, hysteresis, rate, stress, temperature.

``scenes`` holds the check of :mod:`all_solvers.test_instrument_faults` that has to show the fault.
"""

from __future__ import annotations

from dataclasses import replace

from support.faults.injection import Fault

from bem_solver.trigger import Located

PATH, SHIFT = "validation.reference.path", "contact_scene.temperature_shift"


def _other_side(true):
    """The spring on the wrong side: ``X = D - F/k``."""
    return lambda self, step, time, penetration, force: true(self, step, time, penetration, -force)


def _without_stage_work(true):
    def columns(of, machine, events):
        return true(of, machine, events) | {"external_work": of["external_work"]}

    return columns


def _steeper(true):
    return lambda self, at_rest, speed: true(replace(self, exponent=1.1 * self.exponent), at_rest, speed)


FAULTS = [
    Fault("reference", "spring of the wrong sign", "contact_scene.loading:Loading.segment",
          _other_side, ("stage",)),
    Fault("reference", "work of the stage forgotten", "contact_scene.machine:machine_columns",
          _without_stage_work, ("work",)),
    Fault("reference", "a step ends at 1.001 of its level", "contact_scene.loading:Trigger.excess",
          lambda true: lambda self, *state: true(self, *state) - 1e-3 * self.level, ("level",)),
    Fault("reference", "closes at what it opens at", "contact_scene.adhesion:Adhesion.closing",
          lambda true: lambda self: self.work, ("hysteresis",)),
    Fault("reference", "opens at what it closes at", "contact_scene.adhesion:Adhesion.opening",
          lambda true: lambda self, speed: self.closing, ("hysteresis",)),
    Fault("reference", "exponent of the rate a tenth too large", "contact_scene.adhesion:PowerRate.work",
          _steeper, ("rate",)),
    Fault("reference", "zone of fixed stress twice as long", "contact_scene.adhesion:Adhesion.zone_for",
          lambda true: lambda self, squared: 2.0 * true(self, squared), ("stress",)),
    Fault("reference", "shift factor upside down (WLF)", f"{SHIFT}:WLF.log_factor",
          lambda true: lambda self, temperature: -true(self, temperature), ("temperature",)),
    Fault("reference", "shift factor upside down (Arrhenius)", f"{SHIFT}:Arrhenius.log_factor",
          lambda true: lambda self, temperature: -true(self, temperature), ("temperature",)),
    Fault("bem", "the step that passes a level is taken whole", "bem_solver.trigger:to_level",
          lambda true: lambda step, trigger, candidate: Located(
              candidate, true(step, trigger, candidate).reached), ("level",)),
    Fault("fem", "the step that passes a level is taken whole", "fem_solver.trigger:step_to_level",
          lambda true: lambda run, segment, trigger, dt, contact: (
              contact if true(run, segment, trigger, dt, contact) is not None else None), ("level",)),
    Fault("reference", "the step that passes a level is taken whole",
          f"{PATH}.events:to_level",
          lambda true: lambda tracker, planned, whole: (true(tracker, planned, whole), whole)[1], ("level",)),
]  # fmt: skip
