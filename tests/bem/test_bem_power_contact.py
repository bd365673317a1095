"""The contact under a power of the radius, by quadrature of its discs and the closed forms of two.

Unit contact, unit plane modulus: discs of the weights ``G t^n`` press ``(2/pi) G t^n/sqrt(x^2 - t^2)`` out.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from bem_solver.annuli import PowerContact

EXPONENTS = [1.0, 1.3, 2.0, 4.0, 10.0]


def test_cone_and_sphere():
    """Love's cone ``pi x/2`` to the unit slope, and the parabola."""
    assert_allclose(PowerContact(1.0).kappa, 0.5 * np.pi)
    assert_allclose(PowerContact(1.0).force, 0.5 * np.pi)
    assert_allclose(PowerContact(2.0).kappa, 2.0)
    assert_allclose(PowerContact(2.0).force, 4.0 / 3.0)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_displacement_inside(exponent):
    """The discs press ``x^n`` in: ``(2/pi) int_0^x G t^n/sqrt(x^2 - t^2) dt``."""
    kappa = PowerContact(exponent).kappa
    for x in (0.2, 0.9):
        value, _ = quad(lambda angle, x=x: (x * np.sin(angle)) ** exponent, 0.0, 0.5 * np.pi, epsabs=1e-13)
        assert_allclose(2.0 / np.pi * kappa * value, x**exponent, rtol=1e-9)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_density_and_displacement_outside(exponent):
    contact = PowerContact(exponent)
    kappa = contact.kappa
    for x in (0.05, 0.5, 0.999):
        rise, _ = quad(
            lambda s, x=x: exponent * (x * x + s * s) ** (0.5 * exponent - 1.0),
            0.0,
            np.sqrt(1.0 - x * x),
            epsabs=1e-13,
        )
        wanted = kappa / np.pi * (1.0 - np.sqrt(1.0 - x * x) * rise)
        assert_allclose(contact.density(np.array([x])), wanted, rtol=1e-9)
    for x in (1.0, 1.001, 2.0, 50.0):

        def pressed_out(angle, x=x):
            return np.sin(angle) ** exponent * np.cos(angle) / np.sqrt(x * x - np.sin(angle) ** 2)

        wanted = 2.0 / np.pi * kappa * quad(pressed_out, 0.0, 0.5 * np.pi, epsabs=1e-13)[0]
        assert_allclose(contact.outside(np.array([x])), wanted, rtol=1e-8)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_force_is_that_of_the_pressure(exponent):
    contact = PowerContact(exponent)

    def share(angle):  # 2 pi x p dx with x = sin(angle)
        return 2.0 * np.pi * np.sin(angle) * contact.density(np.array([np.sin(angle)]))[0]

    assert_allclose(quad(share, 1e-9, 0.5 * np.pi)[0], contact.force, rtol=1e-7)
