"""Influence coefficients of discs and annuli (paper, Eqs. Kernel and Ghq)."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import dblquad

from bem_solver.annuli import annulus_influence, disc_displacement


def test_centre_and_edge_of_a_disc():
    assert_allclose(disc_displacement(0.0, 0.7), 2.0 * 0.7, rtol=1e-15)
    assert_allclose(disc_displacement(0.7, 0.7), 4.0 * 0.7 / np.pi, rtol=1e-14)


def test_far_away_a_disc_is_a_point_force():
    """``u = F/(pi E* r)`` with ``F = pi c^2``: ``c^2/r``, the next term ``c^4/(8 r^3)``."""
    distance = np.array([10.0, 100.0, 3e3])  # as far as annuli are ever asked
    beyond = disc_displacement(distance, 1.0) * distance - 1.0
    assert_allclose(beyond, 1.0 / (8.0 * distance**2), rtol=0.01, atol=3e-9)


@pytest.mark.parametrize("r", [0.3, 0.95, 1.05, 2.0])
def test_disc_is_boussinesqs_point_force_summed(r):
    """``u(r) = (1/pi) int p/distance dA``, in polar coordinates about the observer."""
    if r < 1.0:

        def reach(t):
            return -r * np.cos(t) + np.sqrt(1.0 - (r * np.sin(t)) ** 2)

        value, _ = dblquad(lambda rho, t: 1.0, 0.0, 2.0 * np.pi, 0.0, reach)
    else:
        widest = np.arcsin(1.0 / r)

        def half(t):
            return np.sqrt(max(1.0 - (r * np.sin(t)) ** 2, 0.0))

        value, _ = dblquad(
            lambda rho, t: 1.0,
            -widest,
            widest,
            lambda t: r * np.cos(t) - half(t),
            lambda t: r * np.cos(t) + half(t),
        )
    assert_allclose(disc_displacement(r, 1.0), value / np.pi, rtol=1e-7)


def test_broadcasts_and_has_no_disc_of_radius_zero():
    assert disc_displacement(np.ones((3, 1)), np.ones(4)).shape == (3, 4)
    assert_allclose(disc_displacement([0.0, 0.5, 2.0], 0.0), 0.0)


def test_annuli_add_up_to_the_disc():
    radius, borders = np.linspace(0.0, 3.0, 7), np.array([0.0, 0.2, 0.3, 1.0])
    influence = annulus_influence(radius, borders)
    assert influence.shape == (7, 3)
    assert_allclose(influence.sum(axis=1), disc_displacement(radius, 1.0), rtol=1e-14)
    ring = disc_displacement(radius, 0.3) - disc_displacement(radius, 0.2)
    assert_allclose(influence[:, 1], ring, rtol=1e-14)
