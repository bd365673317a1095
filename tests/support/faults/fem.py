"""Single faults for the finite elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from support.faults.injection import by, changed, constant, gives, rest, table, takes, times

from fem_solver.moduli import Prony

SHORT = "pdms-retraction-100nm"
"""Where the mesh follows the edge and steps pass over many process zones."""
PUNCH, GLASSY, RELAXED = "punch-programme", "elastic-glassy", "elastic-relaxed"


def _relaxation_for_retardation(true):
    def moduli(material):
        found = true(material)
        shear = found.shear
        slow = Prony(shear.relaxed, shear.moduli, shear.times * shear.glassy / shear.relaxed)
        return replace(found, shear=slow)

    return moduli


def _updated(left, gain):
    """Branches that keep ``left`` and gain ``gain`` of their moduli, by step over time."""

    def broken(true):
        def linear(self, v, b, dt, reached):
            y = dt / self._times
            return left(y) * b + gain(y) * self._moduli * (reached - v)

        return linear

    return broken


def _energy_without_a_branch(true):
    def stored(self, v, b):
        return true(self, v, np.concatenate([0.0 * b[:1], b[1:]]))

    return stored


def _zone_from_the_wrong_side(true):
    def shift(self, radii, zone):
        true(self, radii, -zone)
        self.zone = zone

    return shift


def _gap_from_the_other_kind_of_nodes(true):
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


def _one_node_short(true):
    def shift(self, radii, zone):
        true(self, radii, zone)
        self.low, self.high = np.maximum(self.low - 1, 0), self.high - 1

    return shift


def _surface_energy_of_the_wrong_sign(true):
    def add(self, state):
        true(self, state)
        row = list(self.rows[-1])
        row[6], row[8] = row[6] + 2.0 * row[10], row[8] - 2.0 * row[10]
        self.rows[-1] = tuple(row)

    return add


def _bulk_twice_as_fast(found):
    if found.bulk is None:
        return found
    return replace(found, bulk=Prony(found.bulk.relaxed, found.bulk.moduli, 0.5 * found.bulk.times))


def _narrower_surface(true):
    def ordered(self, *given):
        true(self, *given)
        self.radii = self.radii / 1.005

    return ordered


def _weighted(*weights):
    """Strains with factors on their components."""
    return gives(lambda strain: strain * np.array(weights)[:, None, None])


FAULTS = table("fem", "fem_solver", [
    ("the half of the closure dropped", "contact_problem:ContactProblem.closure", times(2.0)),
    ("tension and compression swapped", "placement:Placement.forces", times(-1.0)),
    ("pressure and tension at the edge swapped", "contact_problem:ContactProblem.pressed_in", times(-1.0)),
    ("1 + nu lost from the shear modulus", "setup:moduli",
     lambda true: lambda material: changed(shear=lambda g: g.scaled(1.0 + material.poisson))(true(material))),
    ("1 - nu lost from the contact radius", "moduli:Moduli.unit_plane_modulus", constant(2.0)),
    ("relaxation times taken for retardation times", "setup:moduli", _relaxation_for_retardation),
    ("a branch dropped", "setup:moduli", takes(material=changed(branches=rest))),
    ("backward Euler in place of the exact update", "components:Components.linear",
     _updated(lambda y: 1.0 / (1.0 + y), lambda y: 1.0 / (1.0 + y)), "layer-dwell", "dwell-10"),
    ("energy without a branch", "components:Components.stored", _energy_without_a_branch, PUNCH),
    ("dissipation without its cross term", "moduli:Prony.loss_weights",
     gives(lambda weights: weights * np.array([[1.0], [0.0], [1.0]])), PUNCH),
    ("2 pi missing from the stiffness", "forms:deviatoric_stiffness", times(0.5 / np.pi)),
    ("hoop strain missing", "forms:strain", _weighted(1.0, 1.0, 0.0, 1.0)),
    ("hoop strain missing from the volume strain", "forms:dilatation",
     lambda true: lambda u, radius: u.grad[0, 0] + u.grad[1, 1]),
    ("shear strain counted once", "forms:strain", _weighted(1.0, 1.0, 1.0, np.sqrt(0.5))),
    ("incompressible taken as nu = 0.45", "halfspace:HalfSpace.factorise",
     takes(ratio=lambda ratio: max(ratio, 0.103))),
    ("process zone measured from the wrong side", "closure:ZoneShift.__init__",
     _zone_from_the_wrong_side),
    ("gap beyond a vertex read from mid-side nodes, and the other way round",
     "closure:ZoneShift.__init__", _gap_from_the_other_kind_of_nodes, GLASSY),
    ("gap read one node short of the shifted point", "closure:ZoneShift.__init__", _one_node_short),
    ("force without 2 pi", "contact_problem:ContactProblem.force", times(0.5 / np.pi)),
    ("surface energy of the wrong sign in the balance", "recorder:SurfaceRecorder.add",
     _surface_energy_of_the_wrong_sign),
    ("closure 0.5 % too large", "contact_problem:ContactProblem.closure", times(1.005), RELAXED, GLASSY),
    ("bulk relaxes like shear", "setup:moduli", takes(material=changed(bulk=lambda _: None)), "bulk-punch"),
    ("relaxation of bulk twice as fast", "setup:moduli", gives(_bulk_twice_as_fast), "bulk-punch"),
    ("trapezoidal rule in place of the exact update", "components:Components.linear",
     _updated(lambda y: (1.0 - 0.5 * y) / (1.0 + 0.5 * y), lambda y: 1.0 / (1.0 + 0.5 * y))),
    ("2 pi 0.3 % too large", "forms:deviatoric_stiffness", times(1.003), GLASSY),
    ("the stage taken for the indenter", "contact_problem:ContactProblem.penetration",
     lambda true: lambda self, s: self.value if self.control == "stage" else true(self, s), "spring-elastic"),
    ("the edge 2 % too fast for its law", "state:ComponentState.opening_speed", times(1.02),
     "rated-edge-si"),
    ("the edge spends 1 % more", "edge:energy_spent", times(1.01), "hysteresis-si"),
    ("branches dissipate 2 % too much", "moduli:Prony.loss_weights", times(1.02), "adhesionless-cycle"),
    ("nodes of a step over zones released too early", "edge_path:EdgePolynomial.passed",
     gives(lambda share: share**1.2), SHORT),
    ("wake of earlier steps over zones recovers half as fast", "components:Components.recovered",
     takes(dt=by(0.5)), SHORT),
    ("closure over short zones told by a punch 3 % too soft", "placement:punch_closure",
     times(1.03), SHORT),
    ("heights over short zones 0.5 % too far out", "placement:height_stretch", times(1.005),
     SHORT),
    ("surface 0.5 % narrower than its mesh", "halfspace:HalfSpace._order_surface", _narrower_surface,
     "relaxed-equilibrium"),
])  # fmt: skip
