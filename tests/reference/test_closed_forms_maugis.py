"""Maugis-Dugdale: its own conditions by direct integration."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.closed_forms.maugis_dugdale import MaugisDugdale

R, MODULUS, WORK = 1.3, 0.8, 4e-3


def contact(transition):
    unit = MaugisDugdale(R, MODULUS, WORK, 1.0).transition
    return MaugisDugdale(R, MODULUS, WORK, transition / unit)


@pytest.mark.parametrize("transition", [0.1, 1.0, 20.0])
def test_gap_and_stress_by_direct_integration(transition):
    """The three conditions behind the formulas, from the stresses in Sneddon's coordinate.

    Ring of tension ``s0`` on ``a < r < c``: ``q = -2 s0 sqrt(c^2 - x^2)`` there; finite stress at ``a`` makes
    ``q`` continuous, ``E* (D - a^2/R) = -2 s0 sqrt(c^2 - a^2)``; the gap at ``c`` is ``dg/s0``.
    """
    m = contact(transition)
    assert_allclose(m.transition, transition, rtol=1e-14)
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
