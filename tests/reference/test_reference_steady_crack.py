"""Small-scale viscoelasticity: enhancement read off slow runs against the steady-edge laws.

Opening is driven by the far stress, so ``G`` is read from the force, ``(F_Hertz(a) - F)^2/(8 pi a^3 E0*)``;
closing by the far displacement, so there it is read from the penetration, ``E0* (D - a^2/R)^2/(2 pi a)``.
Both carry the bias of a finite zone, which an elastic contact has too and at zero speed: it is taken from
:mod:`validation.reference.finite_zone` at the enhanced work and divided out.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.paper_scenes import ONE, THREE, WORK

import bem_solver
from contact_scene import Adhesion, Loading, Ramp, Scene, Sphere
from validation.reference import path as reference
from validation.reference import steady_crack
from validation.reference.finite_zone import FiniteZone
from validation.reference.jkr import JKR

LAW = JKR(Sphere(1.0), 1.0, WORK)


def measured(solver, material, zone, start, end, rate, resolution):
    """Edge speed, ``G/dg`` and the finite-zone bias where 40 to 90 per cent of the way is done."""
    scene = Scene(material, Sphere(1.0), Loading("relaxed", start, (Ramp(end, rate),)), Adhesion(WORK, zone))
    trace = solver.solve(scene, solver.Options(resolution=resolution))
    radius, opening = trace.contact_radius, end < start
    speed = np.abs(np.gradient(radius, trace.time))
    if opening:
        release = LAW.energy_release_rate_from_force(radius, trace.force) / WORK
    else:
        release = LAW.energy_release_rate(radius, trace.penetration) / WORK
    way = radius[0] + np.array([0.4, 0.5, 0.6, 0.7, 0.8, 0.9]) * (radius[-1] - radius[0])
    rows = [int(np.argmin(np.abs(radius - at))) for at in way]
    law = steady_crack.opening if opening else steady_crack.closing
    bias = []
    for row in rows:
        enhanced = WORK * float(law(material, zone, speed[row]))
        bias.append(FiniteZone(1.0, 1.0, enhanced, zone).energy_release_rate(radius[row]) / enhanced)
    return speed[rows], release[rows], np.array(bias)


@pytest.mark.parametrize(
    ("solver", "accuracy"),
    [pytest.param(reference, 3e-4, id="front-tracking"), pytest.param(bem_solver, 1e-3, id="bem")],
)
def test_slow_retraction_follows_the_opening_law(solver, accuracy):
    speed, release, bias = measured(solver, ONE, 5e-3, 0.08, 0.06, 1e-5, 12)
    formula = steady_crack.opening(ONE, 5e-3, speed)
    assert np.all(formula > 1.03)
    assert_allclose(release / formula / bias, 1.0, atol=accuracy)
    assert np.all(np.abs(release / formula - 1) < 0.014)


def test_slow_approach_follows_the_closing_law():
    speed, release, bias = measured(reference, ONE, 5e-3, 0.04, 0.06, 1e-5, 8)
    formula = steady_crack.closing(ONE, 5e-3, speed)
    assert np.all(formula < 0.98)
    assert_allclose(release / formula / bias, 1.0, atol=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("material", [ONE, THREE], ids=["one", "three"])
@pytest.mark.parametrize(
    ("rate", "tolerance"), [(1e-7, 2e-5), (1e-6, 2e-4), (1e-5, 5e-4), (1e-4, 1.5e-3), (1e-3, 2e-3)]
)
def test_opening_law_over_four_decades(material, rate, tolerance):
    """What is left after the bias grows with speed: the bulk relaxes at a finite rate too."""
    speed, release, bias = measured(reference, material, 2e-3, 0.25, 0.05, rate, 8)
    formula = steady_crack.opening(material, 2e-3, speed)
    assert_allclose(release / formula / bias, 1.0, atol=tolerance)


@pytest.mark.slow
@pytest.mark.parametrize("material", [ONE, THREE], ids=["one", "three"])
@pytest.mark.parametrize(
    ("rate", "tolerance"), [(1e-7, 2e-5), (1e-6, 2e-4), (1e-5, 1e-3), (1e-4, 1.5e-3), (1e-3, 1.5e-3)]
)
def test_closing_law_over_four_decades(material, rate, tolerance):
    speed, release, bias = measured(reference, material, 2e-3, 0.05, 0.15, rate, 8)
    formula = steady_crack.closing(material, 2e-3, speed)
    assert_allclose(release / formula / bias, 1.0, atol=tolerance)
