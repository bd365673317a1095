"""Annuli that travel with the edge, against the exact punch and sphere.

Unit contact, unit plane modulus. Where ``v = D - x^2/2`` inside (sphere of radius 1),
``p = (D - 1)/(pi sqrt(1 - x^2)) + (2/pi) sqrt(1 - x^2)``, ``F = 2 (D - 1/3)`` and, outside with
``s = arcsin(1/x)``, ``v = (2/pi) [D s - (x^2 s - sqrt(x^2 - 1))/2]``.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import observed_order

from bem_solver.annuli import Annuli, PowerContact, even_cubic
from bem_solver.size_estimates import graded_annuli
from bem_solver.surface import NONE_BETWEEN, ContactSurface, LoadBetween

COUNTS = (16, 32, 64)
OUTSIDE = np.array([1.0 + 1e-9, 1.0001, 1.01, 1.1, 1.5, 3.0, 30.0, 1e4])


def pressed(count, depth, edge=1.0, exponent=2.0):
    """Surface under a sphere of radius ``edge`` at penetration ``depth * edge``: all lengths scale."""
    annuli = Annuli(count, exponent=exponent)
    return ContactSurface.under(annuli, edge, edge * (depth - 0.5 * annuli.radii**2))


def exact_outside(x, depth):
    s = np.arcsin(1.0 / x)
    return 2.0 / np.pi * (depth * s - 0.5 * (x**2 * s - np.sqrt(x**2 - 1.0)))


@pytest.mark.parametrize("count", [16, 100])
def test_punch_is_exact(count):
    """Its edge pattern is what the pressures are divided by."""
    annuli = Annuli(count)
    surface = ContactSurface.under(annuli, 2.0, np.full(count, 0.3))
    assert_allclose(surface.force, 2.0 * 2.0 * 0.3, rtol=1e-13)
    assert_allclose(surface.kappa, 0.3, rtol=1e-12)
    assert_allclose(surface.stress_intensity, -0.3 / np.sqrt(2.0 * np.pi), rtol=1e-12)
    r = 2.0 * np.array([0.0, 0.3, 0.9, 0.9999])
    assert_allclose(surface.pressure(r), 0.3 / (np.pi * np.sqrt(4.0 - r**2)), rtol=1e-11)
    assert_allclose(surface.outside(2.0 * OUTSIDE), 0.6 / np.pi * np.arcsin(1.0 / OUTSIDE), rtol=1e-11)


@pytest.mark.parametrize("depth", [1.0, 0.7, 0.0])
def test_sphere_pulled_or_not(depth):
    """Hertz (1), adhesive (0.7) and nothing but tension (0)."""
    surface = pressed(64, depth)
    assert_allclose(surface.force, 2.0 * (depth - 1.0 / 3.0), rtol=2e-6)
    assert_allclose(surface.kappa, depth - 1.0, atol=8e-5)
    x = np.linspace(0.0, 0.999, 40)
    root = np.sqrt(1.0 - x**2)
    exact = (depth - 1.0) / (np.pi * root) + 2.0 / np.pi * root
    assert_allclose(surface.pressure(x) * root, exact * root, atol=1e-4)
    assert_allclose(surface.pressure(np.array([1.0, 1.5])), 0.0)
    assert_allclose(surface.outside(OUTSIDE), exact_outside(OUTSIDE, depth), atol=3e-6)
    assert_allclose(surface.edge_load, surface.outside(np.array([1.0]))[0], rtol=1e-14)
    distance = np.array([1e-6, 1e-3, 0.1])
    assert_allclose(surface.tension(distance), -surface.pressure(1.0 - distance), rtol=1e-9)


def test_observed_order():
    """Second order in the edge strength and the pressure, third in the force and outside.

    On annuli that are exact for another profile.
    """
    errors = {"force": [], "outside": [], "strength": [], "inside": []}
    x = np.linspace(0.0, 0.999, 97)
    root = np.sqrt(1.0 - x**2)
    for count in COUNTS:
        surface = pressed(count, 0.7, exponent=4.0)
        errors["force"].append(surface.force / (2.0 * (0.7 - 1.0 / 3.0)) - 1.0)
        errors["outside"].append(np.abs(surface.outside(OUTSIDE) - exact_outside(OUTSIDE, 0.7)).max())
        errors["strength"].append(surface.kappa + 0.3)
        inside = surface.pressure(x) * root - (-0.3 / np.pi + 2.0 / np.pi * root**2)
        errors["inside"].append(np.sqrt(np.mean(inside**2)))
    for name, order in {"force": 3.0, "outside": 3.0, "strength": 2.0, "inside": 2.0}.items():
        assert order - 0.2 < observed_order(errors[name]) < order + 0.5, (name, errors[name])
    assert abs(errors["force"][-1]) < 1e-6
    assert errors["outside"][-1] < 1e-6
    assert abs(errors["strength"][-1]) < 3e-4
    assert errors["inside"][-1] < 2e-4


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 4.0, 12.0])
def test_profile_that_the_annuli_are_made_for_is_exact(exponent):
    """On few annuli, to what the interpolation between them leaves."""
    annuli, exact = Annuli(*graded_annuli(8, 1e-3), exponent), PowerContact(exponent)
    surface = ContactSurface.under(annuli, 1.0, 0.3 - annuli.radii**exponent)
    assert_allclose(surface.force, 0.6 - exact.force, rtol=1e-12)
    assert_allclose(surface.kappa, 0.3 - exact.kappa, rtol=1e-7)
    at = annuli.borders[4:-1]  # nearer to the axis the pressure of a cone is steep
    wanted = 0.3 / np.pi - exact.density(at)
    assert_allclose(surface.pressure(at) * np.sqrt(1.0 - at**2), wanted, atol=1e-3 * np.abs(wanted).max())
    assert_allclose(surface.density, 0.3 / np.pi - exact.density(annuli.radii), atol=1e-12)
    punch = 0.3 * 2.0 / np.pi * np.arcsin(1.0 / OUTSIDE)
    assert_allclose(surface.outside(OUTSIDE), punch - exact.outside(OUTSIDE), atol=1e-4)


def test_even_cubic_is_exact_for_cubics_inside_and_flat_at_the_ends():
    at = np.arange(12) + 0.5
    position = np.linspace(2.5, 9.5, 29)
    assert_allclose(even_cubic(at**3 - 2.0 * at, position), position**3 - 2.0 * position, rtol=1e-12)
    waves = np.cos(np.pi * at / 12.0)
    ends = np.linspace(0.0, 12.0, 61)
    assert_allclose(even_cubic(waves, ends), np.cos(np.pi * ends / 12.0), atol=2e-4)


@pytest.mark.parametrize(("divisions", "accuracy"), [(6, 1e-4), (12, 1.5e-5)])
def test_a_bend_between_collocation_radii_counts_wherever_it_lies(divisions, accuracy):
    """``v`` falls beyond b, where nodes lie close, with slope 1: ``kappa = -arccos(b)``.

    At the collocation radii alone the bend comes and goes as b moves over an annulus.
    """
    annuli = Annuli(*graded_annuli(divisions, 1e-4))
    alone, with_nodes = [], []
    for distance in np.geomspace(1e-3, 3e-3, 23):
        close = distance * np.geomspace(1e-4, 0.3, 60)
        nodes = np.concatenate((1.0 - np.geomspace(1.0, 1e-6, 300), 1.0 - distance + close))
        nodes = np.unique(np.concatenate((nodes, 1.0 - distance - close, [1.0 - distance])))
        between = LoadBetween.of(annuli, 1.0, nodes)
        assert len(between.radius)
        radius = np.concatenate((annuli.radii, between.radius))
        load = -np.maximum(radius - (1.0 - distance), 0.0)
        exact = -np.arccos(1.0 - distance)
        alone.append(ContactSurface.under(annuli, 1.0, load[: annuli.count]).kappa / exact - 1.0)
        with_nodes.append(ContactSurface.under(annuli, 1.0, load, between=between).kappa / exact - 1.0)
    assert np.abs(with_nodes).max() < accuracy
    assert np.ptp(with_nodes) < 0.02 * np.ptp(alone)


def test_no_nodes_count_where_they_are_no_closer_than_asked_for():
    """Smooth load is left to the annuli: sums over nodes that come and go would be noise."""
    annuli = Annuli(*graded_annuli(12, 1e-4))
    assert LoadBetween.of(annuli, 1.0, 1.0 - np.geomspace(1.0, 1e-6, 300)) is NONE_BETWEEN


@pytest.mark.parametrize("grading", [1.0, 0.1, 1e-2])
@pytest.mark.parametrize("depth", [1.0, 0.34])
def test_work_on_a_displacement_is_of_third_order(depth, grading):
    """Sphere of unit contact: ``int p v = 2 int_0^1 (D - x^2)^2 dx`` (Sneddon); by mid-points, of second."""
    exact = 2.0 * (depth**2 - 2.0 * depth / 3.0 + 0.2)
    errors = []
    for count in (80, 160, 320):
        annuli = Annuli(count, grading)
        load = depth - 0.5 * annuli.radii**2
        errors.append(abs(annuli.work(annuli.solve(load), load) / exact - 1.0))
    order = np.log2(errors[0] / errors[2]) / 2.0
    assert 2.6 < order < 3.4
    assert errors[-1] < 5e-6
