"""A power-law material at a temperature, expanded into branches, through every solver."""

from __future__ import annotations

import numpy as np
import pytest

import crosscontact as cc


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
