"""The elastic layer against printed and derived numbers; the histories that have closed forms."""

import numpy as np
import pytest
from support.closed_forms.layer import thin_punch

from contact_scene import Cone, FlatPunch, Layer, PowerLaw, Sphere
from validation.reference import layer_formulas, sneddon
from validation.reference.elastic_layer import ElasticLayer, force_ratio, moment, transfer
from validation.reference.jkr import JKR

BONDED, SLIDING = "bonded", "frictionless"


def punch(ratio, poisson, base):
    """The response of a flat punch of a radius over the thickness."""
    return ElasticLayer(Layer(1.0 / ratio, base), poisson, FlatPunch(1.0)).response(1.0)


def sphere(thickness, poisson=0.5, base=BONDED):
    return ElasticLayer(Layer(thickness, base), poisson, Sphere(1.0))


@pytest.mark.parametrize(
    ("ratio", "printed"),
    [
        (0.2, (1.2066, 1.2323, 1.2523, 1.2806, 1.1710)),
        (1.0, (2.4835, 2.7938, 3.0914, 3.6187, 2.1986)),
        (3.0, (6.2613, 7.9916, 10.3654, 18.1574, 5.2874)),
    ],
)
def test_flat_punch_to_all_printed_digits(ratio, printed):
    cases = [(nu, BONDED) for nu in (0.3, 0.4, 0.45, 0.5)] + [(0.3, SLIDING)]
    found = [0.5 * punch(ratio, *case).stiffness for case in cases]
    np.testing.assert_allclose(found, printed, rtol=0, atol=0.51e-4)
    assert punch(ratio, 0.0, SLIDING) == punch(ratio, 0.5, SLIDING)


@pytest.mark.parametrize(
    ("poisson", "base", "values", "shares"),
    [
        (0.5, BONDED, (252.898, 4806.94, 156045.88), (0.582, 0.827, 0.944)),
        (0.3, BONDED, (19.7157, 58.1976, 192.893), (0.976, 0.992, 0.998)),
        (0.3, SLIDING, (16.2696, 47.6820, 157.637), (0.966, 0.988, 0.996)),
    ],
)
def test_a_thin_layer_tends_to_its_limit(poisson, base, values, shares):
    for ratio, value, share in zip((10.0, 30.0, 100.0), values, shares, strict=True):
        found = 0.5 * punch(ratio, poisson, base).stiffness
        assert found == pytest.approx(value, rel=3e-6)
        assert thin_punch(ratio, poisson, base) / found == pytest.approx(share, abs=1e-3)


def test_transfer_at_both_ends():
    t = np.array([1e-3])
    assert transfer(t, 0.5, BONDED) == pytest.approx(2.0 / 3.0 * t**3, rel=1e-5)
    assert transfer(t, 0.3, BONDED) == pytest.approx(0.5 * t * 0.4 / 0.7**2, rel=1e-5)
    assert transfer(t, 0.3, SLIDING) == pytest.approx(0.5 * t, rel=1e-5)
    assert transfer(np.array([25.0]), 0.3, BONDED) == pytest.approx(1.0, abs=1e-15)


def test_moments_and_series_of_the_sphere():
    for (poisson, base), printed in {
        (0.5, BONDED): (1.77021677, 3.83107716),
        (0.3, BONDED): (1.37685417, 2.51020665),
        (0.3, SLIDING): (1.16757684, 1.58152555),
    }.items():
        found = [moment(order, poisson, base) for order in (0, 2)]
        np.testing.assert_allclose(found, printed, rtol=0, atol=0.51e-8)
        rest = []
        for chi in (0.02, 0.04):
            layer = sphere(1.0, poisson, base)
            exact = layer.state(layer.radius_at(chi * chi)).force / (4.0 / 3.0 * chi**3)
            rest.append(float(exact - force_ratio(chi, poisson, base)))
        assert abs(rest[1]) < 1e-7
        assert abs(rest[1] / rest[0]) > 2.0**4.5  # the fifth order is the first that is left


@pytest.mark.parametrize(
    ("poisson", "base", "size", "printed"),
    [
        (0.5, BONDED, 0.2, (1.005977, 0.89099, 0.46222)),
        (0.5, BONDED, 1.0, (1.200995, 0.63581, 0.23900)),
        (0.5, BONDED, 5.0, (1.502631, 0.32939, 0.04870)),
        (0.3, BONDED, 1.0, (1.137002, 0.69150, 0.29407)),
        (0.3, SLIDING, 1.0, (1.110669, 0.72273, 0.31963)),
    ],
)
def test_jkr_of_a_thin_film(poisson, base, size, printed):
    work, free = 1e-3, JKR(Sphere(1.0), 1.0, 1e-3)
    film = sphere((9.0 * np.pi * work / 8.0) ** (1.0 / 3.0) / size, poisson, base)
    dead, rigid = film.pull_off(work, "force"), film.pull_off(work, "penetration")
    limit = free.pull_off_force_control().force
    found = (
        dead.force / limit,
        rigid.penetration / free.pull_off_penetration_control().penetration,
        rigid.force / limit,
    )
    assert found[0] == pytest.approx(printed[0], abs=6e-6)  # printed from zones extrapolated to zero
    np.testing.assert_allclose(found[1:], printed[1:], atol=0.51e-5)


@pytest.mark.parametrize("indenter", [Sphere(2.0), Cone(70.0), FlatPunch(0.3)])
def test_a_thick_layer_is_a_half_space(indenter):
    layer = ElasticLayer(Layer(1e9, BONDED), 0.3, indenter)
    found, half_space = layer.state(0.3, 1e-3), JKR(indenter, 1.0, 1e-3)
    assert found.penetration == pytest.approx(float(half_space.penetration(0.3)), rel=1e-8)
    assert found.force == pytest.approx(float(half_space.force(0.3)), rel=1e-8)


def test_a_flat_punch_is_in_full_contact_at_any_penetration():
    assert ElasticLayer(Layer(0.5, BONDED), 0.5, FlatPunch(0.3)).radius_at(0.1) == 0.3


def test_how_wrong_published_formulas_are():
    def error(name, ratio):
        base, formula = layer_formulas.SPHERES[name]
        state = sphere(1.0 / ratio, base=base).state(1.0)
        depth = state.penetration
        return formula(ratio * depth**0.5) * 4.0 / 3.0 * depth**1.5 / state.force - 1.0

    for name, printed in {
        "Dimitriadis 2002": {0.5: -0.055, 1.0: -0.13},
        "Garcia 2018": {0.5: 0.003, 1.0: 0.049, 2.0: 0.34},
        "Dimitriadis 2002, not bonded": {0.5: 0.066, 1.0: 0.15},
    }.items():
        for ratio, value in printed.items():
            assert error(name, ratio) == pytest.approx(value, abs=0.006)
    shull = layer_formulas.PUNCHES["Shull 1998"]
    for ratio, value in {0.5: -0.05, 1.0: 0.013, 2.0: 0.57, 3.0: 1.26}.items():
        assert shull(ratio) / (0.5 * punch(ratio, 0.5, BONDED).stiffness) - 1.0 == pytest.approx(
            value, abs=0.025
        )
    for ratio, row in layer_formulas.HAYES.items():
        for poisson, value in zip((0.3, 0.4, 0.45, 0.5), row, strict=True):
            assert -0.017 < value / (0.5 * punch(ratio, poisson, BONDED).stiffness) - 1.0 < 5e-4


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 4.0, 8.0])
@pytest.mark.parametrize(("poisson", "base"), [(0.5, BONDED), (0.3, BONDED), (0.0, BONDED), (0.0, SLIDING)])
def test_bounds_of_an_approach_hold_on_a_layer(exponent, poisson, base):
    """What contact_scene.approach_bound says of it, at one depth against the half-space."""
    indenter = PowerLaw(exponent, 1.0)
    for ratio in np.geomspace(1e-3, 30.0, 24):
        layer = ElasticLayer(Layer(1.0 / ratio, base), poisson, indenter)
        at, beyond = layer.response(1.0), layer.response(1.0 + 1e-5)
        depth = at.penetration()
        slope = (beyond.penetration() - depth) / 1e-5
        radius = sneddon.contact_radius(indenter, depth)
        pressed = at.force(depth) / sneddon.force(indenter, radius, 1.0)
        pulled = exponent * depth / (radius**2 * slope)
        assert 2.0 * pressed > 1.0 + pulled
        assert at.edge**2 > 1.0 / radius > 1.0
        if ratio < 15.0:  # to the widest contact that a pull makes of it the depth rises as fast, or nearly
            assert layer.response(2.0).penetration() - depth > 0.5**0.5 * slope
