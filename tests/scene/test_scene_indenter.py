"""Indenters: heights and slopes agree, the axis is the lowest point, tables are followed or refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_scene import Cone, FlatPunch, PowerLaw, Sphere, TabulatedProfile

R = np.linspace(0.0, 1.0, 21)
SHAPES = {
    "sphere": Sphere(2.0),
    "blunt cone": Cone(89.0),
    "sharp cone": Cone(10.0),
    "punch": FlatPunch(0.5),
    "power 1": PowerLaw(1.0, 0.3),
    "power 1.5": PowerLaw(1.5, 0.3),
    "power 8": PowerLaw(8.0, 0.3),
    "table": TabulatedProfile(tuple(R), tuple(np.cosh(R) - 1.0)),
    "steep and flat": TabulatedProfile((0.0, 1.0, 2.0, 3.0), (0.0, 0.001, 1.0, 1.0)),
    "table with a flat": TabulatedProfile((0.0, 0.2, 0.5, 1.0), (0.0, 0.0, 0.1, 0.4)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_slope_is_the_derivative_of_a_height_that_never_falls(name):
    shape, h = SHAPES[name], 1e-6
    r = np.linspace(0.013, 1.7, 60)
    slope = (shape.height(r + h) - shape.height(r - h)) / (2 * h)
    np.testing.assert_allclose(shape.slope(r), slope, rtol=1e-7, atol=1e-8)
    assert float(shape.height(0.0)) == 0.0
    r = np.linspace(0.0, 3.0, 400)
    assert (np.diff(shape.height(r)) >= 0.0).all()
    assert (shape.slope(r) >= 0.0).all()
    for r in (0.5, [0.5], np.full((2, 3), 0.5), np.empty(0)):
        assert np.shape(shape.height(r)) == np.shape(shape.slope(r)) == np.shape(r)


def test_cones_keep_their_digits_at_both_ends():
    assert Cone(1e-3).cotangent == pytest.approx(180e3 / math.pi, rel=1e-9)
    assert Cone(1e-3).cotangent == pytest.approx(1.0 / math.tan(math.radians(1e-3)), rel=1e-15)
    assert Cone(90.0 - 2.0**-30).cotangent == pytest.approx(math.radians(2.0**-30), rel=1e-14)
    assert Cone(45.0).cotangent == pytest.approx(1.0, rel=1e-15)


def test_table_passes_through_its_points_and_goes_on_straight():
    radii, heights = (0.0, 0.1, 0.4, 1.0), (0.0, 0.01, 0.2, 1.3)
    table = TabulatedProfile(radii, heights)
    np.testing.assert_allclose(table.height(radii), heights, rtol=1e-15)
    end = float(table.slope(1.0))
    assert float(table.slope(5.0)) == end
    assert float(table.height(5.0)) == pytest.approx(1.3 + 4.0 * end)
    assert float(table.slope(1.0 - 1e-9)) == pytest.approx(end, rel=1e-6)
    lifted = TabulatedProfile(radii, tuple(5.0 + height for height in heights))
    np.testing.assert_allclose(lifted.height(radii), heights, atol=1e-14)


@pytest.mark.parametrize(("points", "worst"), [(21, 1e-5), (41, 1.3e-6), (81, 1.6e-7)])
def test_table_of_a_smooth_profile_converges(points, worst):
    radii = np.linspace(0.0, 1.0, points)
    table = TabulatedProfile(tuple(radii), tuple(np.cosh(radii) - 1.0))
    fine = np.linspace(0.0, 1.0, 1001)
    error = np.abs(table.height(fine) - (np.cosh(fine) - 1.0)).max()
    assert worst / 3.0 < error < worst


@pytest.mark.parametrize("heights", [(0.0, 1e-300, 1.0), (0.0, 1e60, 1e60), (-1e60, 0.0, 1e60)])
def test_extreme_tables_stay_finite(heights):
    table = TabulatedProfile((0.0, 1e-60, 1e60), heights)
    r = np.geomspace(1e-61, 1e60, 50)
    assert np.isfinite(table.height(r)).all()
    assert np.isfinite(table.slope(r)).all()
