"""Maugis-Dugdale: JKR and DMT limits, its own conditions by direct integration, published fit."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.closed_forms.hertz import force as hertz_force
from support.closed_forms.maugis_dugdale import MaugisDugdale

from contact_scene import Sphere
from validation.reference.jkr import JKR

R, MODULUS, WORK = 1.3, 0.8, 4e-3


def contact(transition):
    unit = MaugisDugdale(R, MODULUS, WORK, 1.0).transition
    return MaugisDugdale(R, MODULUS, WORK, transition / unit)


def test_transition_parameter_is_reproduced():
    assert_allclose(contact(0.37).transition, 0.37, rtol=1e-14)


@pytest.mark.parametrize("transition", [0.1, 1.0, 20.0])
def test_gap_and_stress_by_direct_integration(transition):
    """The three conditions behind the formulas, from the stresses in Sneddon's coordinate.

    Ring of tension ``s0`` on ``a < r < c``: ``q = -2 s0 sqrt(c^2 - x^2)`` there; finite stress at ``a`` makes
    ``q`` continuous, ``E* (D - a^2/R) = -2 s0 sqrt(c^2 - a^2)``; the gap at ``c`` is ``dg/s0``.
    """
    m = contact(transition)
    a = 1.1 * m.radius_unit
    c, s0, depth = a * m.ring_ratio(a), m.strength, m.penetration(a)
    assert_allclose(MODULUS * (depth - a**2 / R), -2 * s0 * np.sqrt(c**2 - a**2), rtol=1e-10)
    # q inside is E* w plus nothing else, so the force is 2 int q dx over both parts.
    inner = 2 * MODULUS * (a * depth - a**3 / (3 * R))
    ring = 2 * quad(lambda x: -2 * s0 * np.sqrt(c**2 - x**2), a, c, epsrel=1e-12)[0]
    assert_allclose(m.force(a), inner + ring, rtol=1e-9, atol=1e-12 * m.force_unit)
    # u(c) = (2/pi) int_0^c w/sqrt(c^2 - x^2) dx with w = q/E*.
    shape = quad(lambda b: depth - (c * np.sin(b)) ** 2 / R, 0, np.arcsin(a / c), epsrel=1e-12)[0]
    displacement = 2 / np.pi * (shape - 2 * s0 / MODULUS * (c - a))
    gap = c**2 / (2 * R) - depth + displacement
    assert_allclose(s0 * gap, WORK, rtol=1e-7)


@pytest.mark.parametrize("scale", [0.3, 1.0, 3.0])
def test_large_parameter_is_jkr(scale):
    exact = JKR(Sphere(R), MODULUS, WORK)
    errors = []
    for transition in (30.0, 300.0):
        m = contact(transition)
        a = scale * m.radius_unit
        errors.append(abs(m.force(a) - float(exact.force(a))) / m.force_unit)
        assert abs(m.penetration(a) - float(exact.penetration(a))) < 0.2 / transition * m.radius_unit**2 / R
    assert errors[1] < 0.2 * errors[0]
    assert errors[1] < 2e-3
    assert_allclose(contact(3000.0).pull_off_force(), 1.5 * np.pi * WORK * R, rtol=1e-6)


@pytest.mark.parametrize("scale", [0.0, 0.5, 2.0])
def test_small_parameter_is_dmt(scale):
    m = contact(1e-4)
    a = scale * m.radius_unit
    dmt = float(hertz_force(a, R, MODULUS)) - 2 * np.pi * WORK * R
    assert abs(m.force(a) - dmt) < 3e-2 * m.force_unit
    closer = contact(1e-6)
    assert abs(closer.force(a) - dmt) < 0.15 * abs(m.force(a) - dmt) + 1e-9 * m.force_unit
    assert_allclose(m.pull_off_force(), 2 * np.pi * WORK * R, rtol=1e-5)


def test_pull_off_falls_from_dmt_to_jkr_as_in_the_published_fit():
    """R.W. Carpick, D.F. Ogletree, M. Salmeron, J. Colloid Interface Sci. 211, 395 (1999), good to 2 %."""
    transitions = np.geomspace(1e-3, 100.0, 16)
    exact = np.array([contact(t).pull_off_force() for t in transitions]) / (np.pi * WORK * R)
    assert np.all(np.diff(exact) < 0.0)
    power = 4.04 * transitions**1.4
    fit = 1.75 - 0.25 * (power - 1) / (power + 1)
    assert np.max(np.abs(exact / fit - 1)) < 0.02
