"""Single faults for the reference."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.faults.injection import by, changed, gives, rest, table, takes, times

from validation.reference.sneddon import PowerTransform

SHORT = "pdms-retraction-100nm"
"""Where steps pass over many process zones."""
PUNCH, RATED, SLOWEST = "punch-programme", "rated-edge-si", "cycle-v0.002"


def _times_swapped(true):
    def rheology(material):
        found = true(material)
        return replace(found, times=found.retardation, retardation=found.times)

    return rheology


def _energy_without_a_branch(true):
    def stored(body, state):
        return true(body, state) - float((state.held_squares / body.rheology.moduli)[:1].sum())

    return stored


def _trapezoidal(true):
    def end(self):
        y = 0.5 * float(self.clock.sum()) / self.times
        return (2.0 * y / (1.0 + y) * self.moduli * self.rate * self.times)[None], true(self)[1]

    return end


def _recovery(factor):
    """The free surface takes so many times as long to recover."""
    return gives(changed(retardation=by(factor)))


FAULTS = table("reference", "validation.reference.path", [
    ("the half of the closure dropped", "closure:Closure.between", times(2.0)),
    ("tension and compression swapped", "trial:Trial.stress", times(-1.0), PUNCH),
    ("1 - nu^2 lost", "rheology:rheology", takes(material=changed(poisson=by(0.0)))),
    ("relaxation and retardation times swapped", "rheology:rheology", _times_swapped),
    ("a branch dropped", "rheology:rheology", takes(material=changed(branches=rest))),
    ("force of one side of the axis only", "trial:Trial.force", times(0.5)),
    ("energy without a branch", "energies:stored_energy", _energy_without_a_branch),
    ("process zone half as long", "edge_law:EdgeLaw.zone", times(0.5)),
    ("curvature of the closure's kernel left out", "closure:kernel_slope", times(0.0)),
    ("covered points without their glassy jump", "rheology:Rheology.cover",
     lambda true: lambda self, units, strain: units @ self.branches_of_units),
    ("released points forget their relaxation", "rheology:Rheology.release", takes(branches=by(0.0))),
    ("internal variables in contact not advanced", "memory:ConstantRate.end",
     lambda true: lambda self: (0.0 * true(self)[0], true(self)[1])),
    ("start with the other modulus", "equilibrium:start_state", takes(glassy=lambda glassy: not glassy)),
    ("edge passes every point at the end of the step", "numerics:inverse",
     lambda true: lambda way, rise: np.ones_like(rise)),
    ("surface energy of the wrong sign in the balance", "energies:_separation", times(-1.0)),
    ("closure 0.3 % too large", "closure:Closure.between", times(1.003), "elastic-glassy",
     "elastic-relaxed"),
    ("force 0.3 % too large", "trial:Trial.force", times(1.003), PUNCH),
    ("edge fields with a length of 1e-6", "edge_law:EdgeLaw.zone", gives(lambda zone: zone + 1e-6),
     "cycle-si-small"),
    ("internal variables by the trapezoidal rule", "memory:ConstantRate.end", _trapezoidal, PUNCH),
    ("free surface recovers 3 % too slowly", "rheology:rheology", _recovery(1.03), "repressed-profile",
     "cycle-v0.02"),
    ("the spring 2 % too soft in the balance", "run:timed_legs",
     takes(segment=changed(compliance=by(1.02))), "spring-elastic"),
    ("the wake recovers 1 % too slowly", "rheology:rheology", _recovery(1.01), SLOWEST),
    ("the interface takes up 1 % more", "edge_law:EdgeLaw.taken_up", times(1.01), RATED),
    ("points of a step over zones released at its end", "numerics:inverse",
     lambda true: lambda way, rise: np.ones_like(rise), SHORT),
    ("points of a step over zones released 1 % too early", "numerics:inverse", times(0.99), SHORT),
    ("wake of earlier steps over zones recovers half as fast", "fields:Passages.at",
     takes(retardation=by(2.0)), SHORT),
])  # fmt: skip
FAULTS += table("reference", "validation.reference", [
    ("the profile in place of its Abel transform", "sneddon:transform",
     lambda true: lambda indenter: PowerTransform(0.5 / indenter.radius, 2.0)),
])  # fmt: skip
