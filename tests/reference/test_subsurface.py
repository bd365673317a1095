"""Closed-form fields in the body: equilibrium, Hooke's law, surface and axis, textbook numbers, limits."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.closed_forms import hertz, punch

from contact_scene import Cone, FlatPunch, PowerLaw, Sphere
from validation.reference import jkr, sneddon
from validation.reference.subsurface import contact

A, R, MODULUS, WORK = 0.3, 0.7, 3.0, 2e-3
PEAK = 2.0 * MODULUS * A / (np.pi * R)
#: indenter and penetration at contact radius A
CONTACTS = {
    "punch": (FlatPunch(A), 0.1),
    "hertz": (Sphere(R), A**2 / R),
    "jkr": (Sphere(R), float(jkr.JKR(Sphere(R), MODULUS, WORK).penetration(A))),
    "cone": (Cone(65.0), float(sneddon.depth(Cone(65.0), A))),
    "power-law": (PowerLaw(1.5, 0.3), 0.05),
}
POISSON = [0.0, 0.3, 0.5]


def at(name, r, z, poisson=0.3):
    indenter, depth = CONTACTS[name]
    return contact(r, z, indenter, A, depth, MODULUS, poisson)


def sphere_field(r, z, poisson=0.3):
    return contact(r, z, Sphere(R), A, A**2 / R, MODULUS, poisson)


def total_force(name):
    indenter, depth = CONTACTS[name]
    return MODULUS * float(sneddon.unit_force(indenter, A, depth))


def pressure(name, r):
    indenter, depth = CONTACTS[name]
    lack = depth - float(sneddon.depth(indenter, A))
    rest = 0.0 if name == "punch" else sneddon.pressure(indenter, r, A, MODULUS)
    return rest + punch.pressure(r, lack, A, MODULUS)


@pytest.mark.parametrize("poisson", POISSON)
@pytest.mark.parametrize("name", CONTACTS)
def test_fields_are_in_equilibrium_and_obey_hookes_law(name, poisson):
    r, z = (g.ravel() for g in np.meshgrid([0.06, 0.25, 0.33, 0.9], [-0.04, -0.2, -0.7]))
    h = 2e-4
    steps = np.array([[0, 0], [1, 0], [-1, 0], [2, 0], [-2, 0], [0, 1], [0, -1], [0, 2], [0, -2]])
    field = at(name, r + h * steps[:, :1], z + h * steps[:, 1:], poisson)

    def slope(values, first):
        return (8 * (values[first] - values[first + 1]) - values[first + 2] + values[first + 3]) / (12 * h)

    rr, zz, tt, rz = field.stress
    scale = np.abs(field.stress).max()
    radial = slope(rr, 1) + slope(rz, 5) + (rr - tt)[0] / r
    axial = slope(rz, 1) + slope(zz, 5) + rz[0] / r
    assert np.abs(np.stack([radial, axial])).max() < 1e-6 * scale / A

    ur, uz = field.displacement
    young, trace = MODULUS * (1.0 - poisson**2), (rr + zz + tt)[0]
    strain = np.stack([slope(ur, 1), slope(uz, 5), ur[0] / r, 0.5 * (slope(ur, 5) + slope(uz, 1))])
    hooke = (1.0 + poisson) * field.stress[:, 0] - poisson * trace * np.array([[1], [1], [1], [0]])
    assert_allclose(young * strain, hooke, atol=1e-7 * scale)


@pytest.mark.parametrize("name", CONTACTS)
def test_every_plane_carries_the_force(name):
    node, weight = np.polynomial.legendre.leggauss(200)
    reach = 100.0
    angle = 0.5 * np.arctan(reach / A) * (node + 1.0)
    r = A * np.tan(angle)
    ring = 0.5 * np.arctan(reach / A) * weight * 2 * np.pi * r * A / np.cos(angle) ** 2
    for depth in (0.05, 0.3, 2.0):
        beyond = (depth / np.hypot(depth, reach)) ** 3  # of a point force
        carried = ring @ at(name, r, -depth).stress[1]
        assert_allclose(carried, -total_force(name) * (1.0 - beyond), rtol=1e-6)


@pytest.mark.parametrize("poisson", POISSON)
def test_surface_carries_the_pressure_and_has_the_shape_of_the_indenter(poisson):
    inside, outside = np.linspace(0.0, 0.29, 9), np.array([0.31, 0.5, 2.0])
    for name, (indenter, depth) in CONTACTS.items():
        field = at(name, inside[1:], 0.0, poisson)
        assert_allclose(field.stress[1], -pressure(name, inside[1:]), atol=1e-5 * PEAK)
        assert_allclose(field.displacement[1], indenter.height(inside[1:]) - depth, atol=1e-7 * A)
        away = at(name, outside, 0.0, poisson)
        assert_allclose(away.stress[[1, 3]], 0.0, atol=1e-9 * PEAK)
        # nothing presses there: a plane state of stress with rr = -tt
        assert_allclose(away.stress[0], -away.stress[2], atol=1e-9 * PEAK)
        expected = (1.0 - 2.0 * poisson) * total_force(name) / (2.0 * np.pi * outside**2)
        assert_allclose(away.stress[0], expected, atol=1e-9 * PEAK)
    sphere = sphere_field(outside, 0.0, poisson)
    assert_allclose(sphere.displacement[1], -hertz.displacement(outside, A, R), rtol=1e-10)


def test_interpolated_shapes_agree_with_exact_ones():
    r, z = np.meshgrid([0.0, 0.15, 0.29, 0.4], [0.0, -0.003, -0.1, -1.0])
    exact = sphere_field(r, z, 0.3)
    near = contact(r, z, PowerLaw(2.0, 0.5 / R), A, A**2 / R, MODULUS, 0.3)
    assert_allclose(near.stress, exact.stress, atol=1e-9 * PEAK)
    # a cubic is not made of parabolas: its axis stress by quadrature of q'(x) x/(s^2 + x^2)
    cubic, depth, s = PowerLaw(3.0, 0.5), float(sneddon.depth(PowerLaw(3.0, 0.5), A)), 0.1
    factor = 0.5 * sneddon.shape_factor(3.0) * MODULUS

    def term(x):  # A0 + s A1 = (1/pi) Re int q (1/Z^2 + 2 s/Z^3) dx
        complex_depth = s + 1j * x
        return factor * (A**3 - x**3) * (1 / complex_depth**2 + 2 * s / complex_depth**3).real / np.pi

    expected = -quad(term, 0.0, A, epsabs=1e-13)[0]
    assert_allclose(contact(0.0, -s, cubic, A, depth, MODULUS, 0.3).stress[1], expected, rtol=1e-6)


def test_nothing_is_infinite_and_points_outside_the_body_are_refused():
    r, z = np.array([0.0, A, A]), np.array([0.0, 0.0, -1e-15])
    for name in CONTACTS:
        assert np.isfinite(at(name, r, z).stress).all()
    with pytest.raises(ValueError, match="body"):
        at("hertz", 0.1, 0.01)
