"""Single faults for the finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.faults.injection import registry

from fem_solver.prony import Increment, Prony

FAULTS, fault = registry("fem", "fem_solver")
SHORT = ("pdms-retraction-100nm",)
"""Where the mesh follows the edge and steps pass over many process zones."""


@fault("the half of the closure dropped", "release:ContactProblem.closure")
def _(true):
    return lambda *given: 2.0 * true(*given)


@fault("tension and compression swapped", "surface:SurfaceOperator.last_forces")
def _(true):
    return lambda *given: -true(*given)


@fault("pressure and tension at the edge swapped", "release:ContactProblem._intensity")
def _(true):
    return lambda *given: -true(*given)


@fault("1 + nu lost from the shear modulus", "setup:moduli")
def _(true):
    def moduli(material):
        found = true(material)
        return replace(found, shear=found.shear.scaled(1.0 + material.poisson))

    return moduli


@fault("1 - nu lost from the contact radius", "setup:Moduli.unit_plane_modulus")
def _(true):
    return lambda self: 2.0


@fault("relaxation times taken for retardation times", "setup:moduli")
def _(true):
    def moduli(material):
        found = true(material)
        shear = found.shear
        slow = Prony(shear.relaxed, shear.moduli, shear.times * shear.glassy / shear.relaxed)
        return replace(found, shear=slow)

    return moduli


@fault("a branch dropped", "setup:moduli")
def _(true):
    def moduli(material):
        return true(replace(material, branches=material.branches[1:]))

    return moduli


@fault("internal variables one step late", "prony:Increment.advance")
def _(true):
    last: dict[tuple[int, ...], object] = {}

    def advance(self, branches, dx):
        before = last.get(branches.shape, 0.0 * dx)
        last[branches.shape] = dx
        return true(self, branches, before)

    return advance


@fault("backward Euler in place of the exact update", "prony:Prony.increment")
def _(true):
    def increment(self, dt):
        left = 1.0 / (1.0 + dt / self.times)
        gain = self.moduli * left
        return Increment(self.relaxed + float(gain.sum()), left, gain)

    return increment


@fault("energy without a branch", "condensed:CondensedHistory.stored_energy")
def _(true):
    def stored(self):
        return true(self) - 0.5 * float((self.state.forms[:1] / self.shear.moduli[:1]).sum())

    return stored


@fault("dissipation without its cross term", "prony:Prony.loss_weights", ("punch-programme",))
def _(true):
    return lambda self, dt: true(self, dt) * np.array([[1.0], [0.0], [1.0]])


@fault("2 pi missing from the stiffness", "forms:deviatoric_stiffness")
def _(true):
    return lambda basis: true(basis) / (2.0 * np.pi)


@fault("hoop strain missing", "forms:strain")
def _(true):
    return lambda u, radius: true(u, radius) * np.array([1.0, 1.0, 0.0, 1.0])[:, None, None]


@fault("hoop strain missing from the volume strain", "forms:dilatation")
def _(true):
    return lambda u, radius: u.grad[0, 0] + u.grad[1, 1]


@fault("shear strain counted once", "forms:strain")
def _(true):
    return lambda u, radius: true(u, radius) * np.sqrt([1.0, 1.0, 1.0, 0.5])[:, None, None]


@fault("far field of the wrong sign", "halfspace:boussinesq_shapes")
def _(true):
    return lambda points: tuple(-shape for shape in true(points))


@fault("far boundary held", "halfspace:Factorisation.compliance")
def _(true):
    def compliance(self, weights=None):
        return true(self, np.zeros(self.count))

    return compliance


@fault("incompressible taken as nu = 0.45", "halfspace:HalfSpace.factorise")
def _(true):
    return lambda self, ratio, count: true(self, max(ratio, 0.103), count)


@fault("process zone measured from the wrong side", "process_zone:ZoneShift.__init__")
def _(true):
    def shift(self, radii, zone):
        true(self, radii, -zone)
        self.zone = zone

    return shift


@fault(
    "gap beyond a vertex read from mid-side nodes, and the other way round",
    "process_zone:ZoneShift.__init__",
    ("elastic-relaxed",),
)
def _(true):
    def shift(self, radii, zone):
        true(self, radii, zone)
        for kind in (0, 1):
            others = np.arange(1 - kind, len(radii), 2)
            targets = radii[kind::2] + zone
            right = np.clip(np.searchsorted(radii[others], targets), 1, len(others) - 1)
            low, high = others[right - 1], others[right]
            share = np.clip((targets - radii[low]) / (radii[high] - radii[low]), 0.0, 1.0)
            self.low[kind::2], self.high[kind::2], self.share[kind::2] = low, high, share
        self.first = np.searchsorted(np.maximum.accumulate(self.high), np.arange(len(radii)), side="right")

    return shift


@fault("gap read one node short of the shifted point", "process_zone:ZoneShift.__init__")
def _(true):
    def shift(self, radii, zone):
        true(self, radii, zone)
        self.low, self.high = np.maximum(self.low - 1, 0), self.high - 1

    return shift


@fault("force without 2 pi", "release:ContactProblem.force")
def _(true):
    return lambda self, s: true(self, s) / (2.0 * np.pi)


@fault("surface energy of the wrong sign in the balance", "recorder:SurfaceRecorder.add")
def _(true):
    def add(self, state):
        self.work_of_adhesion = -abs(self.work_of_adhesion)
        true(self, state)

    return add


@fault("closure 0.5 % too large", "release:ContactProblem.closure", ("elastic-relaxed", "elastic-glassy"))
def _(true):
    return lambda *given: 1.005 * true(*given)


@fault(
    "glassy state with the relaxed ratio of the moduli", "setup:Moduli.instantaneous_ratio", ("bulk-start",)
)
def _(true):
    return lambda self: self.ratio


@fault("bulk relaxes like shear", "setup:moduli", ("bulk-punch",))
def _(true):
    def moduli(material):
        return true(replace(material, bulk=None) if material.bulk is not None else material)

    return moduli


@fault("relaxation of bulk twice as fast", "setup:moduli", ("bulk-punch",))
def _(true):
    def moduli(material):
        found = true(material)
        if found.bulk is None or material.bulk is None:
            return found
        return replace(found, bulk=Prony(found.bulk.relaxed, found.bulk.moduli, 0.5 * found.bulk.times))

    return moduli


@fault("trapezoidal rule in place of the exact update", "prony:Prony.increment", ("punch-programme",))
def _(true):
    def increment(self, dt):
        left = (1.0 - 0.5 * dt / self.times) / (1.0 + 0.5 * dt / self.times)
        gain = self.moduli / (1.0 + 0.5 * dt / self.times)
        return Increment(self.relaxed + float(gain.sum()), left, gain)

    return increment


@fault("2 pi 0.3 % too large", "forms:deviatoric_stiffness", ("punch-programme", "elastic-glassy"))
def _(true):
    return lambda *given: 1.003 * true(*given)


@fault("the stage taken for the indenter", "release:ContactProblem.penetration", ("spring-elastic",))
def _(true):
    return lambda self, s: self.value if self.control == "stage" else true(self, s)


@fault("the edge 2 % too fast for its law", "release:EdgeOrigin.opening_speed", ("rated-edge-si",))
def _(true):
    return lambda *given: 1.02 * true(*given)


@fault("the edge spends 1 % more", "irreversible_edge:energy_spent", ("hysteresis-si",))
def _(true):
    return lambda *given: 1.01 * true(*given)


@fault("branches dissipate 2 % too much", "prony:Prony.loss_weights", ("adhesionless-cycle",))
def _(true):
    return lambda *given: 1.02 * true(*given)


@fault("nodes of a step over zones released too early", "following.path:EdgePolynomial.passed", SHORT)
def _(true):
    return lambda self, radii: true(self, radii) ** 1.2


@fault(
    "wake of earlier steps over zones recovers half as fast",
    "following.components:Components.recovered",
    SHORT,
)
def _(true):
    return lambda self, branches, time: true(self, branches, 0.5 * time)


@fault(
    "closure over short zones told by a punch 3 % too soft", "following.elastic_scales:punch_closure", SHORT
)
def _(true):
    return lambda *given: 1.03 * true(*given)


@fault("heights over short zones 0.5 % too far out", "following.elastic_scales:height_stretch", SHORT)
def _(true):
    return lambda *given: 1.005 * true(*given)


@fault("surface 0.5 % narrower than its mesh", "halfspace:HalfSpace._order_surface", ("relaxed-equilibrium",))
def _(true):
    def ordered(self, *given):
        true(self, *given)
        self.radii = self.radii / 1.005

    return ordered
