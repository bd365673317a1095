"""Single faults for the reference."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.faults.injection import registry

from validation.reference.path.abel import PowerTransform

FAULTS, fault = registry("reference", "validation.reference.path")
SHORT = ("pdms-retraction-100nm",)
"""Where steps pass over many process zones."""


@fault("the half of the closure dropped", "closure:Closure.integral")
def _(true):
    return lambda *given: 2.0 * true(*given)


@fault("tension and compression swapped", "trial:Trial.stress", ("adhesionless-cycle",))
def _(true):
    return lambda *given: -true(*given)


@fault("1 - nu^2 lost", "rheology:rheology")
def _(true):
    return lambda material: true(replace(material, poisson=0.0))


@fault("relaxation and retardation times swapped", "rheology:rheology")
def _(true):
    def rheology(material):
        found = true(material)
        return replace(found, times=found.retardation, retardation=found.times)

    return rheology


@fault("a branch dropped", "rheology:rheology")
def _(true):
    return lambda material: true(replace(material, branches=material.branches[1:]))


@fault("force of one side of the axis only", "trial:Trial.force")
def _(true):
    return lambda *given: 0.5 * true(*given)


@fault("energy without a branch", "energies:stored_energy")
def _(true):
    def stored(body, state):
        return true(body, state) - float((state.held_squares / body.rheology.moduli)[:1].sum())

    return stored


@fault("the profile in place of its Abel transform", "abel:transform")
def _(true):
    return lambda indenter: PowerTransform(0.5 / indenter.radius, 2.0)


@fault("process zone half as long", "edge_law:EdgeLaw.zone")
def _(true):
    return lambda self: 0.5 * true(self)


@fault("curvature of the closure's kernel left out", "closure:kernel_slope")
def _(true):
    return lambda *given: 0.0 * true(*given)


@fault("covered points without their glassy jump", "rheology:Rheology.cover")
def _(true):
    return lambda self, units, strain: units @ self.branches_of_units


@fault("released points forget their relaxation", "rheology:Rheology.release")
def _(true):
    return lambda self, branches, strain: true(self, 0.0 * branches, strain)


@fault("internal variables in contact not advanced", "memory:Ramp.end")
def _(true):
    return lambda self: (self.memory, true(self)[1])


@fault("start with the other modulus", "state:start_state")
def _(true):
    return lambda body, depth, radius, glassy: true(body, depth, radius, not glassy)


@fault("edge passes every point at the end of the step", "polynomials:inverse")
def _(true):
    return lambda way, rise: np.ones_like(rise)


@fault("surface energy of the wrong sign in the balance", "energies:_separation")
def _(true):
    return lambda *given: -true(*given)


@fault("closure 0.3 % too large", "closure:Closure.integral", ("elastic-glassy", "elastic-relaxed"))
def _(true):
    return lambda *given: 1.003 * true(*given)


@fault("force 0.3 % too large", "trial:Trial.force", ("punch-programme",))
def _(true):
    return lambda *given: 1.003 * true(*given)


@fault("edge fields with a length of 1e-6", "edge_law:EdgeLaw.zone", ("cycle-si-small",))
def _(true):
    return lambda self: true(self) + 1e-6


@fault("internal variables by the trapezoidal rule", "memory:Ramp.end", ("punch-programme",))
def _(true):
    def end(self):
        y = 0.5 * float(self.clock.sum()) / self.times
        decay = (1.0 - y) / (1.0 + y)
        return decay * self.memory + (1.0 - decay) * self.rate * self.times, true(self)[1]

    return end


@fault("free surface recovers 3 % too slowly", "fields:Passages.at", ("repressed-profile", "cycle-v0.02"))
def _(true):
    return lambda self, x, G, time, times, retardation: true(self, x, G, time, times, retardation / 0.97)
