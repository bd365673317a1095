"""Single faults for the front tracking."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.faults.injection import by, changed, gives, rest, table, takes, times
from validation.reference.tracking.abel import PowerTransform

SHORT = "pdms-retraction-100nm"
"""Where steps pass over many process zones."""
PUNCH, RATED, SLOWEST = "punch-programme", "rated-edge-si", "cycle-v0.002"


def _times_swapped(true):
    def rheology(material):
        found = true(material)
        return replace(found, times=found.retardation, retardation=found.times)

    return rheology


def _energy_without_a_branch(true):
    def stored(self, branches, strain):
        return true(self, branches, strain) - 0.5 * (branches[:, :1] ** 2 / self.moduli[:1]).sum(axis=1)

    return stored


def _trapezoidal(true):
    def update(surface, body, depth):
        found, y = true(surface, body, depth), 0.5 * depth.duration / body.rheology.times
        return replace(found, decay=(1.0 - y) / (1.0 + y))

    return update


def _recovery(power):
    """The free surface recovers by another power of its factors."""
    return gives(changed(recovery=lambda factors: factors**power))


FAULTS = table("reference", "validation.reference.tracking", [
    ("the half of the closure dropped", "closure:closure_integral", times(2.0)),
    ("tension and compression swapped", "surface:Surface.edge_stress", times(-1.0), "adhesionless-cycle"),
    ("1 - nu^2 lost", "rheology:rheology", takes(material=changed(poisson=by(0.0)))),
    ("relaxation and retardation times swapped", "rheology:rheology", _times_swapped),
    ("a branch dropped", "rheology:rheology", takes(material=changed(branches=rest))),
    ("force of one side of the axis only", "surface:Surface.force", times(0.5)),
    ("energy without a branch", "rheology:Rheology.stored_in_contact", _energy_without_a_branch),
    ("the profile in place of its Abel transform", "abel:transform",
     lambda true: lambda indenter: PowerTransform(0.5 / indenter.radius, 2.0)),
    ("process zone half as long", "closure:closure_integral", takes(zone=by(0.5))),
    ("curvature of the closure's kernel left out", "closure:kernel_slope", times(0.0)),
    ("covered points without their glassy jump", "rheology:Rheology.cover",
     lambda true: lambda self, units, strain: units @ self.branches_of_units),
    ("released points forget their relaxation", "rheology:Rheology.release", takes(branches=by(0.0))),
    ("internal variables in contact not advanced", "surface_step:field_update",
     gives(changed(decay=np.ones_like, gain=np.zeros_like))),
    ("start with the other modulus", "equilibrium:elastic_surface", takes(glassy=lambda glassy: not glassy)),
    ("edge passes every point at the end of the step", "edge_path:ParabolicPath.passing",
     gives(np.ones_like)),
    ("surface energy of the wrong sign in the balance", "recorder:Recorder.columns",
     takes(self=changed(work=by(-1.0)))),
    ("closure 0.3 % too large", "closure:closure_integral", times(1.003), "elastic-glassy",
     "elastic-relaxed"),
    ("force 0.3 % too large", "surface:Surface.force", times(1.003), PUNCH),
    ("edge fields with a length of 1e-6", "closure:closure_integral", takes(zone=lambda zone: zone + 1e-6),
     "cycle-si-small"),
    ("internal variables by the trapezoidal rule", "surface_step:field_update", _trapezoidal, PUNCH),
    ("free surface recovers 3 % too slowly", "surface_step:field_update", _recovery(0.97),
     "repressed-profile", "cycle-v0.02"),
    ("the spring 2 % too soft in the balance", "control:balanced",
     takes(segment=changed(compliance=by(1.02))), "spring-elastic"),
    ("the wake recovers 1 % too slowly", "surface_step:field_update", _recovery(0.99), SLOWEST),
    ("the interface takes up 1 % more", "interface_work:taken_at", times(1.01), RATED),
    ("points of a step over zones released at its end", "edge_path:PolynomialPath.passing",
     gives(np.ones_like), SHORT),
    ("points of a step over zones released 1 % too early", "edge_path:PolynomialPath.passing", times(0.99),
     SHORT),
    ("wake of earlier steps over zones recovers half as fast", "surface_step:field_update", _recovery(0.5),
     SHORT),
])  # fmt: skip
