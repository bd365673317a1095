"""Indenters: heights and slopes agree, the axis is the lowest point, tables are followed or refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from contact_scene import Cone, FlatPunch, PowerLaw, SceneError, Sphere, TabulatedProfile, scene_from_dict

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
    "table with a flat": TabulatedProfile((0.0, 0.2, 0.5, 1.0), (0.0, 0.0, 0.1, 0.4)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_slope_is_the_derivative_of_the_height(name):
    shape, h = SHAPES[name], 1e-6
    r = np.linspace(0.013, 1.7, 60)
    slope = (shape.height(r + h) - shape.height(r - h)) / (2 * h)
    np.testing.assert_allclose(shape.slope(r), slope, rtol=1e-7, atol=1e-8)


@pytest.mark.parametrize("name", SHAPES)
def test_the_axis_is_the_lowest_point_and_heights_never_fall(name):
    shape = SHAPES[name]
    r = np.linspace(0.0, 3.0, 400)
    assert float(shape.height(0.0)) == 0.0
    assert (np.diff(shape.height(r)) >= 0.0).all()
    assert (shape.slope(r) >= 0.0).all()


@pytest.mark.parametrize("name", SHAPES)
def test_shapes_of_the_arguments_are_kept(name):
    shape = SHAPES[name]
    for r in (0.5, [0.5], np.full((2, 3), 0.5), np.empty(0)):
        assert np.shape(shape.height(r)) == np.shape(shape.slope(r)) == np.shape(r)


def test_closed_forms():
    assert float(Sphere(2.0).height(0.6)) == pytest.approx(0.09)
    assert float(Cone(60.0).height(3.0)) == pytest.approx(math.sqrt(3.0))
    assert float(PowerLaw(3.0, 2.0).height(0.5)) == 0.25
    np.testing.assert_allclose(PowerLaw(2.0, 0.25).height(R), Sphere(2.0).height(R), rtol=1e-15)
    np.testing.assert_allclose(PowerLaw(1.0, 0.5).height(R), 0.5 * R)
    assert (Sphere(1.0).edge, FlatPunch(0.5).edge) == (math.inf, 0.5)


def test_cones_keep_their_digits_at_both_ends():
    assert Cone(1e-3).cotangent == pytest.approx(180e3 / math.pi, rel=1e-9)
    assert Cone(1e-3).cotangent == pytest.approx(1.0 / math.tan(math.radians(1e-3)), rel=1e-15)
    assert Cone(90.0 - 2.0**-30).cotangent == pytest.approx(math.radians(2.0**-30), rel=1e-14)
    assert Cone(45.0).cotangent == pytest.approx(1.0, rel=1e-15)


def test_steep_powers_overflow_to_infinity():
    assert float(PowerLaw(100.0, 1.0).height(1e10)) == math.inf
    assert float(PowerLaw(100.0, 1.0).slope(1e10)) == math.inf


def test_table_passes_through_its_points_and_goes_on_straight():
    radii, heights = (0.0, 0.1, 0.4, 1.0), (0.0, 0.01, 0.2, 1.3)
    table = TabulatedProfile(radii, heights)
    np.testing.assert_allclose(table.height(radii), heights, rtol=1e-15)
    end = float(table.slope(1.0))
    assert float(table.slope(5.0)) == end
    assert float(table.height(5.0)) == pytest.approx(1.3 + 4.0 * end)
    assert float(table.slope(1.0 - 1e-9)) == pytest.approx(end, rel=1e-6)


def test_table_height_at_the_axis_does_not_matter():
    lifted = TabulatedProfile((0.0, 1.0, 2.0), (5.0, 5.5, 7.0))
    assert lifted == TabulatedProfile((0.0, 1.0, 2.0), (0.0, 0.5, 2.0))


@pytest.mark.parametrize(("points", "worst"), [(21, 1e-5), (41, 1.3e-6), (81, 1.6e-7)])
def test_table_of_a_smooth_profile_converges(points, worst):
    radii = np.linspace(0.0, 1.0, points)
    table = TabulatedProfile(tuple(radii), tuple(np.cosh(radii) - 1.0))
    fine = np.linspace(0.0, 1.0, 1001)
    error = np.abs(table.height(fine) - (np.cosh(fine) - 1.0)).max()
    assert worst / 3.0 < error < worst


def test_curve_between_steep_and_flat_pieces_does_not_swing_over():
    table = TabulatedProfile((0.0, 1.0, 2.0, 3.0, 4.0), (0.0, 0.001, 1.0, 1.001, 1.001))
    r = np.linspace(0.0, 4.0, 4001)
    assert (np.diff(table.height(r)) >= 0.0).all()
    assert (table.slope(r) >= 0.0).all()
    assert float(table.height(4.0)) == 1.001


def test_tabulated_paraboloids_and_cones_are_exact():
    radii = np.array([0.0, 0.1, 0.15, 0.3, 0.7, 1.0])
    fine = np.linspace(0.0, 1.0, 101)
    for shape in (Sphere(2.0), Cone(60.0)):
        table = TabulatedProfile(tuple(radii), tuple(shape.height(radii)))
        np.testing.assert_allclose(table.height(fine), shape.height(fine), atol=1e-15)
        np.testing.assert_allclose(table.slope(fine), shape.slope(fine), atol=1e-14)


def test_rising_scatter_is_followed_and_falling_scatter_is_refused():
    rng = np.random.default_rng(7)
    radii = np.linspace(0.0, 1.0, 41)
    scatter = 1e-4 * rng.standard_normal(41)
    clean = 0.5 * radii**2
    rising = np.maximum.accumulate(clean + scatter)
    table = TabulatedProfile(tuple(radii), tuple(rising))
    np.testing.assert_allclose(table.height(radii), rising - rising[0], atol=1e-15)
    assert (np.diff(table.height(np.linspace(0.0, 1.0, 2000))) >= 0.0).all()
    with pytest.raises(SceneError, match=r"height, row \d+: falls by .*; allowed: .*smooth a noisy table"):
        TabulatedProfile(tuple(radii), tuple(clean + 30 * scatter))


def test_table_from_a_file(tmp_path):
    (tmp_path / "tip.csv").write_text("# measured\nradius,height\n0,0\n0.5,0.1\n1.0,0.5\n")
    data = {
        "material": {"modulus": 1.0, "poisson": 0.3},
        "indenter": {"shape": "profile", "file": "tip.csv"},
        "loading": {"start": "relaxed", "penetration": 0.0},
    }
    scene = scene_from_dict(data, tmp_path)
    assert scene.indenter == TabulatedProfile((0.0, 0.5, 1.0), (0.0, 0.1, 0.5))
    for rows, where in [
        ("0,0\n0.5,0.1\n0.5,0.5\n", "radius, row 3"),
        ("0,0\n0.5,0.1\n1.0,0.05\n", "height, row 3"),
        ("0.1,0\n0.5,0.1\n1.0,0.5\n", "radius"),
        ("0,0\n1,1\n", "radius"),
        ("0,0\n1,0\n2,0\n", "height"),
        ("0,0\n1,x\n2,0\n", "height, line 2"),
        ("0,0\n1,nan\n2,0\n", "height, line 2"),
        ("0,0\n-1,1\n2,3\n", "radius, row 2"),
        ("0,0,0\n1,1,1\n2,2,2\n", "line 1"),
        ("0,0\n1e-80,1\n2,3\n", "radius"),
        ("", "the file is empty"),
    ]:
        (tmp_path / "tip.csv").write_text(rows)
        with pytest.raises(SceneError) as caught:
            scene_from_dict(data, tmp_path)
        assert str(caught.value).startswith(f"{tmp_path / 'tip.csv'}: {where}")


@pytest.mark.parametrize("heights", [(0.0, 1e-300, 1.0), (0.0, 1e60, 1e60), (-1e60, 0.0, 1e60)])
def test_extreme_tables_stay_finite(heights):
    table = TabulatedProfile((0.0, 1e-60, 1e60), heights)
    r = np.geomspace(1e-61, 1e60, 50)
    assert np.isfinite(table.height(r)).all()
    assert np.isfinite(table.slope(r)).all()


@pytest.mark.parametrize(
    ("build", "key"),
    [
        (lambda: TabulatedProfile((0.0, 1.0, 2.0), (0.0, 1.0)), "height"),
    ],
)
def test_bad_shapes(build, key):
    with pytest.raises(SceneError) as caught:
        build()
    assert caught.value.key == key
    assert caught.value.allowed
