"""While the penetration does not fall, a contact without adhesion is as large as an elastic one (Ting).

From first touch, whatever has been pressed or held before: the surface ahead of the edge has crept, far
beyond the radius at which it was touched first. Held, its force follows the material (Lee and Radok).
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.invariants.coarse_solvers import SOLVERS

import crosscontact as cc
from contact_scene import Branch, Cone, Hold, Indenter, Loading, Material, PowerLaw, Ramp, Scene, Sphere

RUBBER = Material(1.5e6, 0.49, (Branch(1.5e7, 1.0),))
CONE = Cone(75.0)
RADII = {
    "cone": (CONE, lambda depth: 2.0 / math.pi * math.tan(math.radians(75.0)) * depth),
    "sphere": (Sphere(1e-4), lambda depth: (1e-4 * depth) ** 0.5),
    "power law": (PowerLaw(1.0, 0.3), lambda depth: 2.0 / (0.3 * math.pi) * depth),
}

ACCURACY = {"reference": 2e-6, "bem": 2e-3}
QUICK = {("bem", "cone"), ("reference", "sphere"), ("fem", "power law")}
"""Every solver and every shape once by default; a power law of exponent 1 is a cone: one is enough."""


@pytest.mark.parametrize(
    ("solver", "shape"),
    [
        pytest.param(*pair, marks=() if pair in QUICK else pytest.mark.slow)
        for pair in product(SOLVERS, RADII)
        if pair in QUICK or pair[1] != "power law"
    ],
)
def test_radius_of_a_contact_pressed_again(solver, shape):
    """Boundary elements of a cone were 20 % off: beyond a million times the first radius nothing crept."""
    indenter, radius = RADII[shape]
    assert isinstance(indenter, Indenter)
    steps = (Ramp(2e-6, 1e-6), Hold(1.0), Ramp(1e-5, 1e-6))
    scene = Scene(RUBBER, indenter, Loading("jump-in", 0.0, steps))
    trace = SOLVERS[solver].solve(scene)
    expected = radius(trace.penetration)
    accuracy = ACCURACY.get(solver) or max(SOLVERS[solver].declared(scene), 2e-3)
    assert_allclose(trace.contact_radius, expected, rtol=0.0, atol=accuracy * expected[-1])


@pytest.mark.parametrize("solver", ["reference", "bem", pytest.param("fem", marks=pytest.mark.slow)])
def test_force_of_a_sphere_held_in_follows_the_power_law(solver):
    """Lee and Radok: ``F = 4/3 sqrt(R) D^(3/2) E(t/a_T)/(1 - nu^2)`` after a step without adhesion."""
    law = cc.PowerLawRelaxation(exponent=0.3, modulus=2.0, time=1.0, range=(1e-2, 1e2), error=1e-5)
    warm = cc.at_temperature(law.material(0.5), cc.WLF(17.44, 51.6, 373.15), 375.0)
    scene = cc.Scene(warm, cc.Sphere(1.0), cc.Loading("jump-in", 0.01, (cc.Hold(10.0),)))
    trace = cc.solve(scene, solver=solver).trace
    time = trace.time * 10 ** (17.44 * 1.85 / (51.6 + 1.85))  # in units of the reference temperature
    inside = time >= 1e-2
    assert inside.sum() > 20
    assert time.max() > 10.0
    force = 4.0 / 3.0 * 0.01**1.5 / 0.75 * 2.0 * time[inside] ** -0.3
    np.testing.assert_allclose(trace.force[inside], force, rtol=1e-4)
