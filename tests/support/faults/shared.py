"""Single faults in what all solvers share: scene, observables. None of them differs from the reference then.

Each is shown with one solver, the cheapest that carries out the scene: only numbers that pass through no
solver can tell.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from support.faults.injection import by, changed, constant, gives, table, takes, times

from contact_scene import Cone
from contact_scene.loading import Segment

PUNCH, CONE, SPRING = "punch-programme", "cone-force-ramp", "spring-elastic"
RATED, HYSTERESIS, SMALL = "rated-edge-si", "hysteresis-si", "cycle-si-small"


def of_self(**factors):
    """Some fields of the object of a method are so many times as large."""
    return takes(self=changed(**{name: by(factor) for name, factor in factors.items()}))


def _by_steps(true):
    def segment(self, *given):
        found = true(self, *given)
        ends = (found.start, *found.kinks, found.end)

        def value(time):
            return found.value(max(end for end in ends if end <= time or end == ends[0]))

        return Segment(found.control, found.start, found.end, value, found.rate, found.kinks, found.linear)

    return segment


def _by_the_cosine(true):
    def segment(self, time, penetration, force):
        found, shift = true(self, time, penetration, force), 0.5 * math.pi / self.angular_frequency
        return replace(
            found, value=lambda at: found.value(at + shift), rate=lambda at: found.rate(at + shift)
        )

    return segment


def _without_a_half(found):
    energy = found["machine_energy"]
    work = found["external_work"] + energy - energy[:1]
    return found | {"machine_energy": 2.0 * energy, "external_work": work}


def _joined(spectrum):
    """Branches whose times are within a quarter of each other, as one."""
    moduli, at = spectrum
    if at.size == 0:
        return moduli, at
    first = np.concatenate(([0], np.flatnonzero(np.diff(at) > 0.25 * at[:-1]) + 1))
    return np.add.reduceat(moduli, first), at[first]


def _last_of_the_deepest(true):
    return lambda trace, *_: int(np.flatnonzero(trace.penetration >= trace.penetration.max())[-1])


def _without_the_first_row(true):
    def observe(trace, *given):
        found = true(trace, *given)
        return replace(found, start_force=float(trace.force[1]), start_radius=float(trace.contact_radius[1]))

    return observe


def _lost_early(true):
    def observe(trace, zone=0.0, *given):
        found = true(trace, zone, *given)
        return replace(found, detachment_radius=(found.detachment_radius or 0.0) + 0.5 * zone)

    return observe


def _more(name, factor):
    """One observable so many times as large."""
    return gives(changed(**{name: lambda value: factor * (value or 0.0)}))


def _unit(name, factor):
    """One unit so many times as large."""
    return gives(lambda sizes: sizes | {name: factor * sizes[name]} if name in sizes else sizes)


def _half_a_period_late(found):
    at = np.array(found)
    return (*(at[:-1] + 0.5 * np.diff(at)).tolist(), *(at[-1:] + 0.5).tolist())


FAULTS = table("reference", "contact_scene", [
    ("holds half as long", "loading:Hold.segment", of_self(duration=0.5), PUNCH),
    ("holds 1 % too long", "loading:Hold.segment", of_self(duration=1.01), PUNCH),
    ("ramps at the speed of another unit of time", "loading:Ramp.segment", of_self(rate=1.003), PUNCH),
    ("tables counted from the start of the run", "loading:Table.segment", takes(time=by(0.5)), PUNCH),
    ("tables by steps instead of straight lines", "loading:Table.segment", _by_steps, PUNCH),
    ("drift of an oscillation the other way", "loading:Cyclic.segment", of_self(drift=-1.0), PUNCH),
    ("oscillations by the cosine", "loading:Cyclic.segment", _by_the_cosine, PUNCH),
    ("oscillations 0.5 % too fast", "loading:Cyclic.segment", of_self(angular_frequency=1.005), PUNCH),
    ("exponent of the rate 1 % too large", "adhesion:PowerRate.work", of_self(exponent=1.01), RATED),
    ("speed of the rate 3 % too large", "adhesion:PowerRate.work", of_self(speed=1.03), RATED),
    ("closes at 2 % more than it should", "adhesion:Adhesion.closing",
     lambda true: lambda self: min(1.02 * true(self), self.work), HYSTERESIS),
    ("losses of instabilities 3 % too small", "machine:machine_columns",
     gives(lambda found: found | {"instability_loss": 0.97 * found["instability_loss"]}), SPRING),
    ("forces 0.3 % too large", "loading:Force.segment", of_self(value=1.003), PUNCH),
    ("force ramps twice as fast", "loading:ForceRamp.segment", of_self(rate=2.0), CONE),
    ("spring 1 % too soft", "machine:Machine.compliance", times(1.01), SPRING),
    ("a step ends at 1.001 of its level", "loading:Trigger.excess",
     lambda true: lambda self, *given: true(self, *given) - 0.001 * self.level, SPRING),
    ("energy of the machine without its half", "machine:machine_columns", gives(_without_a_half), SPRING),
    ("losses of instabilities left with the viscous ones", "machine:_row_of", constant(None), SPRING),
    ("a cone's angle from the surface", "indenter:Cone.cotangent",
     takes(self=lambda cone: Cone(90.0 - cone.half_angle)), CONE),
    ("a cone's angle as the whole", "indenter:Cone.cotangent", of_self(half_angle=0.5), CONE),
    ("relaxation times close together joined", "material:Material.spectrum", gives(_joined), PUNCH),
    ("plane stress instead of plane strain", "material:Material.relaxed_plane_modulus",
     lambda true: lambda self: self.modulus, "relaxed-equilibrium"),
], shared=True)  # fmt: skip
FAULTS += table("fem", "contact_scene", [
    ("heights of a table by straight lines", "indenter:TabulatedProfile.height",
     lambda true: lambda self, radius: np.interp(radius, self.radii[::3], np.array(self.heights)[::3]),
     "repressed-profile"),
], shared=True)  # fmt: skip
FAULTS += table("reference", "validation.measure", [
    ("approach ends at the last of its deepest rows", "observables:end_of_approach", _last_of_the_deepest,
     "dwell-10"),
    ("a row of the start left out", "observables:observe", _without_the_first_row, PUNCH),
    ("work by steps", "observables:loop_energy",
     lambda true: lambda trace: float((trace.force[:-1] * np.diff(trace.penetration)).sum()), SMALL),
    ("contact lost half a zone too early", "observables:observe", _lost_early, "elastic-relaxed"),
    ("pull-off 2 % too far out", "observables:observe", _more("pull_off_radius", 1.02), "elastic-glassy",
     "cycle-v0.002"),
    ("stage at detachment 1 % too high", "observables:observe", _more("stage_at_detachment", 1.01), SPRING),
    ("units of an energy 1 % too large", "scaling:unit_sizes", _unit("energy", 1.01), SMALL),
    ("cycles half a period late", "windows:cycle_times", gives(_half_a_period_late), PUNCH),
    ("units of a force without pi", "scaling:unit_sizes", _unit("force", 1.0 / math.pi),
     "relaxed-equilibrium"),
], shared=True)  # fmt: skip
