"""Single faults in what all solvers share: scene, observables. None of them differs from the reference then.

Each is shown with one solver, the cheapest that carries out the scene: only numbers that pass through no
solver can tell.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from support.faults.injection import Fault, registry

from contact_scene import Cone
from contact_scene.loading import Segment

FAULTS: list[Fault] = []
_, scene_fault = registry("reference", "contact_scene", FAULTS, shared=True)
_, measure_fault = registry("reference", "validation.measure", FAULTS, shared=True)
_, elements_fault = registry("fem", "contact_scene", FAULTS, shared=True)
PUNCH, CONE, SPRING = ("punch-programme",), ("cone-force-ramp",), ("spring-elastic",)
RATED, HYSTERESIS = ("rated-edge-si",), ("hysteresis-si",)


@scene_fault("holds half as long", "loading:Hold.segment", PUNCH)
def _(true):
    return lambda self, *given: true(replace(self, duration=0.5 * self.duration), *given)


@scene_fault("holds 1 % too long", "loading:Hold.segment", PUNCH)
def _(true):
    return lambda self, *given: true(replace(self, duration=1.01 * self.duration), *given)


@scene_fault("ramps at the speed of another unit of time", "loading:Ramp.segment", PUNCH)
def _(true):
    return lambda self, *given: true(replace(self, rate=1.003 * self.rate), *given)


@scene_fault("tables counted from the start of the run", "loading:Table.segment", PUNCH)
def _(true):
    return lambda self, time, *given: true(self, 0.5 * time, *given)


@scene_fault("tables by steps instead of straight lines", "loading:Table.segment", PUNCH)
def _(true):
    def segment(self, *given):
        found = true(self, *given)
        ends = (found.start, *found.kinks, found.end)

        def value(time):
            return found.value(max(end for end in ends if end <= time or end == ends[0]))

        return Segment(found.control, found.start, found.end, value, found.rate, found.kinks, found.linear)

    return segment


@scene_fault("drift of an oscillation the other way", "loading:Cyclic.segment", PUNCH)
def _(true):
    return lambda self, *given: true(replace(self, drift=-self.drift), *given)


@scene_fault("oscillations by the cosine", "loading:Cyclic.segment", PUNCH)
def _(true):
    def segment(self, time, penetration, force):
        found, shift = true(self, time, penetration, force), 0.5 * math.pi / self.angular_frequency
        return replace(
            found, value=lambda at: found.value(at + shift), rate=lambda at: found.rate(at + shift)
        )

    return segment


@scene_fault("oscillations 0.5 % too fast", "loading:Cyclic.segment", PUNCH)
def _(true):
    return lambda self, *given: true(replace(self, angular_frequency=1.005 * self.angular_frequency), *given)


@scene_fault("exponent of the rate 1 % too large", "adhesion:PowerRate.work", RATED)
def _(true):
    return lambda self, *given: true(replace(self, exponent=1.01 * self.exponent), *given)


@scene_fault("speed of the rate 3 % too large", "adhesion:PowerRate.work", RATED)
def _(true):
    return lambda self, *given: true(replace(self, speed=1.03 * self.speed), *given)


@scene_fault("closes at 2 % more than it should", "adhesion:Adhesion.closing", HYSTERESIS)
def _(true):
    return lambda self: min(1.02 * true(self), self.work)


@scene_fault("losses of instabilities 3 % too small", "machine:machine_columns", SPRING)
def _(true):
    def columns(of, machine, events):
        found = true(of, machine, events)
        return found | {"instability_loss": 0.97 * found["instability_loss"]}

    return columns


@scene_fault("forces 0.3 % too large", "loading:Force.segment", PUNCH)
def _(true):
    return lambda self, *given: true(replace(self, value=1.003 * self.value), *given)


@scene_fault("force ramps twice as fast", "loading:ForceRamp.segment", CONE)
def _(true):
    return lambda self, *given: true(replace(self, rate=2.0 * self.rate), *given)


@scene_fault("spring 1 % too soft", "machine:Machine.compliance", SPRING)
def _(true):
    return lambda self: 1.01 * true(self)


@scene_fault("a step ends at 1.001 of its level", "loading:Trigger.excess", SPRING)
def _(true):
    return lambda self, *given: true(self, *given) - 0.001 * self.level


@scene_fault("energy of the machine without its half", "machine:machine_columns", SPRING)
def _(true):
    def columns(of, machine, events):
        found = true(of, machine, events)
        energy = found["machine_energy"]
        work = found["external_work"] + energy - energy[:1]
        return found | {"machine_energy": 2.0 * energy, "external_work": work}

    return columns


@scene_fault("losses of instabilities left with the viscous ones", "machine:_row_of", SPRING)
def _(true):
    return lambda columns, event: None


@scene_fault("a cone's angle from the surface", "indenter:Cone.cotangent", CONE)
def _(true):
    return lambda self: true(Cone(90.0 - self.half_angle))


@scene_fault("a cone's angle as the whole", "indenter:Cone.cotangent", CONE)
def _(true):
    return lambda self: true(Cone(0.5 * self.half_angle))


@scene_fault("relaxation times close together joined", "material:Material.spectrum", PUNCH)
def _(true):
    def spectrum(self):
        moduli, times = true(self)
        if times.size == 0:
            return moduli, times
        first = np.concatenate(([0], np.flatnonzero(np.diff(times) > 0.25 * times[:-1]) + 1))
        return np.add.reduceat(moduli, first), times[first]

    return spectrum


@scene_fault(
    "plane stress instead of plane strain",
    "material:Material.relaxed_plane_modulus",
    ("relaxed-equilibrium",),
)
def _(true):
    return lambda self: self.modulus


@elements_fault(
    "heights of a table by straight lines", "indenter:TabulatedProfile.height", ("repressed-profile",)
)
def _(true):
    return lambda self, radius: np.interp(radius, self.radii[::3], np.array(self.heights)[::3])


@measure_fault("approach ends at the last of its deepest rows", "observables:end_of_approach", ("dwell-10",))
def _(true):
    return lambda trace, *given: int(np.flatnonzero(trace.penetration >= trace.penetration.max())[-1])


@measure_fault("a row of the start left out", "observables:observe", PUNCH)
def _(true):
    def observe(trace, *given):
        found = true(trace, *given)
        return replace(found, start_force=float(trace.force[1]), start_radius=float(trace.contact_radius[1]))

    return observe


@measure_fault("work by steps", "observables:loop_energy", ("cycle-si-small",))
def _(true):
    return lambda trace: float((trace.force[:-1] * np.diff(trace.penetration)).sum())


@measure_fault("contact lost half a zone too early", "observables:observe", ("elastic-relaxed",))
def _(true):
    def observe(trace, zone=0.0, *given):
        found = true(trace, zone, *given)
        return replace(found, detachment_radius=(found.detachment_radius or 0.0) + 0.5 * zone)

    return observe


@measure_fault("pull-off 2 % too far out", "observables:observe", ("elastic-glassy", "cycle-v0.002"))
def _(true):
    def observe(trace, *given):
        found = true(trace, *given)
        return replace(found, pull_off_radius=1.02 * (found.pull_off_radius or 0.0))

    return observe


@measure_fault("stage at detachment 1 % too high", "observables:observe", SPRING)
def _(true):
    def observe(trace, *given):
        found = true(trace, *given)
        return replace(found, stage_at_detachment=1.01 * (found.stage_at_detachment or 0.0))

    return observe


@measure_fault("units of an energy 1 % too large", "scaling:unit_sizes", ("cycle-si-small",))
def _(true):
    return lambda scene: {
        name: size * (1.01 if name == "energy" else 1.0) for name, size in true(scene).items()
    }


@measure_fault("cycles half a period late", "windows:cycle_times", PUNCH)
def _(true):
    def cycle_times(loading):
        times = np.array(true(loading))
        return tuple((times[:-1] + 0.5 * np.diff(times)).tolist()) + tuple((times[-1:] + 0.5).tolist())

    return cycle_times


@measure_fault("units of a force without pi", "scaling:unit_sizes", ("relaxed-equilibrium",))
def _(true):
    return lambda scene: {
        name: size / (math.pi if name == "force" else 1.0) for name, size in true(scene).items()
    }
