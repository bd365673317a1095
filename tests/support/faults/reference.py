"""Single faults for the front tracking."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.faults.injection import registry

from validation.reference.path.abel import PowerTransform

FAULTS, fault = registry("reference", "validation.reference")
SHORT = ("pdms-retraction-100nm",)
"""Where steps pass over many process zones."""


@fault("the half of the closure dropped", "tracking.closure:closure_integral")
def _(true):
    return lambda *given: 2.0 * true(*given)


@fault("tension and compression swapped", "tracking.surface:Surface.edge_stress", ("adhesionless-cycle",))
def _(true):
    return lambda *given: -true(*given)


@fault("1 - nu^2 lost", "path.rheology:rheology")
def _(true):
    return lambda material: true(replace(material, poisson=0.0))


@fault("relaxation and retardation times swapped", "path.rheology:rheology")
def _(true):
    def rheology(material):
        found = true(material)
        return replace(found, times=found.retardation, retardation=found.times)

    return rheology


@fault("a branch dropped", "path.rheology:rheology")
def _(true):
    return lambda material: true(replace(material, branches=material.branches[1:]))


@fault("force of one side of the axis only", "tracking.surface:Surface.force")
def _(true):
    return lambda *given: 0.5 * true(*given)


@fault("energy without a branch", "path.rheology:Rheology.stored_in_contact")
def _(true):
    def stored(self, branches, strain):
        return true(self, branches, strain) - 0.5 * (branches[:, :1] ** 2 / self.moduli[:1]).sum(axis=1)

    return stored


@fault("the profile in place of its Abel transform", "path.abel:transform")
def _(true):
    return lambda indenter: PowerTransform(0.5 / indenter.radius, 2.0)


@fault("process zone half as long", "tracking.closure:closure_integral")
def _(true):
    return lambda edge, zone, *given: true(edge, 0.5 * zone, *given)


@fault("curvature of the closure's kernel left out", "path.closure:kernel_slope")
def _(true):
    return lambda *given: 0.0 * true(*given)


@fault("covered points without their glassy jump", "path.rheology:Rheology.cover")
def _(true):
    return lambda self, units, strain: units @ self.branches_of_units


@fault("released points forget their relaxation", "path.rheology:Rheology.release")
def _(true):
    return lambda self, branches, strain: true(self, 0.0 * branches, strain)


@fault("internal variables in contact not advanced", "tracking.surface_step:field_update")
def _(true):
    def update(*given):
        found = true(*given)
        return replace(found, decay=np.ones_like(found.decay), gain=np.zeros_like(found.gain))

    return update


@fault("start with the other modulus", "tracking.equilibrium:elastic_surface")
def _(true):
    return lambda body, depth, radius, glassy: true(body, depth, radius, not glassy)


@fault("edge passes every point at the end of the step", "tracking.edge_path:ParabolicPath.passing")
def _(true):
    return lambda self, x: np.ones_like(x)


@fault("surface energy of the wrong sign in the balance", "tracking.recorder:Recorder.columns")
def _(true):
    return lambda self, whole=True: true(replace(self, work=-self.work), whole)


@fault("closure 0.3 % too large", "tracking.closure:closure_integral", ("elastic-glassy", "elastic-relaxed"))
def _(true):
    return lambda *given: 1.003 * true(*given)


@fault("force 0.3 % too large", "tracking.surface:Surface.force", ("punch-programme",))
def _(true):
    return lambda *given: 1.003 * true(*given)


@fault("edge fields with a length of 1e-6", "tracking.closure:closure_integral", ("cycle-si-small",))
def _(true):
    return lambda edge, zone, *given: true(edge, zone + 1e-6, *given)


@fault(
    "internal variables by the trapezoidal rule", "tracking.surface_step:field_update", ("punch-programme",)
)
def _(true):
    def update(surface, body, depth):
        found, y = true(surface, body, depth), 0.5 * depth.duration / body.rheology.times
        return replace(found, decay=(1.0 - y) / (1.0 + y))

    return update


@fault(
    "free surface recovers 3 % too slowly", "surface_step:field_update", ("repressed-profile", "cycle-v0.02")
)
def _(true):
    def update(*given):
        found = true(*given)
        return replace(found, recovery=found.recovery**0.97)

    return update


@fault("the spring 2 % too soft in the balance", "tracking.control:balanced", ("spring-elastic",))
def _(true):
    def balanced(surface, body, segment, *given, **more):
        return true(surface, body, replace(segment, compliance=1.02 * segment.compliance), *given, **more)

    return balanced


@fault("the wake recovers 1 % too slowly", "tracking.surface_step:field_update", ("cycle-v0.002",))
def _(true):
    def update(*given):
        found = true(*given)
        return replace(found, recovery=found.recovery**0.99)

    return update


@fault("the interface takes up 1 % more", "tracking.interface_work:taken_at", ("rated-edge-si",))
def _(true):
    return lambda *given: 1.01 * true(*given)


@fault("points of a step over zones released at its end", "tracking.edge_path:PolynomialPath.passing", SHORT)
def _(true):
    return lambda self, x: np.ones_like(x)


@fault(
    "points of a step over zones released 1 % too early", "tracking.edge_path:PolynomialPath.passing", SHORT
)
def _(true):
    return lambda self, x: 0.99 * true(self, x)


@fault("wake of earlier steps over zones recovers half as fast", "tracking.surface_step:field_update", SHORT)
def _(true):
    def update(*given):
        found = true(*given)
        return replace(found, recovery=found.recovery**0.5)

    return update
