"""Edges that open or close steadily, or set off: the derivations redone by direct integration, and ends."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.optimize import brentq
from support.closed_forms import starting_edge
from support.paper_scenes import ONE

from contact_scene import Adhesion, Branch, Loading, Material, Ramp, Scene, Sphere
from validation.reference import prony_integrals, steady_crack
from validation.reference.path import solve

THREE = Material(1.2, 0.3, (Branch(3.0, 0.05), Branch(2.0, 1.0), Branch(4.0, 8.0)))
ELASTIC = Material(2.0, 0.4)
ZONE = 0.01
materials = pytest.mark.parametrize("material", [ONE, THREE], ids=["one", "three"])


def sines(function, end):
    """``int_0^end function(y)/sqrt(y (end - y)) dy``: both square roots lifted by ``y = end sin^2 b``."""
    return quad(lambda b: 2.0 * function(end * np.sin(b) ** 2), 0, np.pi / 2, epsrel=1e-10, limit=200)[0]


@materials
@pytest.mark.parametrize("speed", [1e-4, 0.01, 0.3, 30.0])
def test_opening_by_direct_integration(material, speed):
    """Gap by superposition of creep, then the closure, with K = 1."""

    def gap(s):
        # int_0^s J*((s-y)/v) dy/(2 sqrt y), y = s z^2
        creep = quad(
            lambda z: float(prony_integrals.creep(material, s * (1 - z * z) / speed)),
            0,
            1,
            epsrel=1e-11,
            limit=200,
        )[0]
        return 2.0 * np.sqrt(2.0 / np.pi) * np.sqrt(s) * creep

    # int_0^da K/sqrt(2 pi s) g(da - s) ds
    work = sines(lambda s: gap(ZONE - s) * np.sqrt(ZONE - s) / np.sqrt(2 * np.pi), ZONE) / (2 * ZONE)
    release = 1.0 / (2.0 * material.relaxed_plane_modulus)
    assert_allclose(release / work, steady_crack.opening(material, ZONE, speed), rtol=1e-7)


@materials
@pytest.mark.parametrize("speed", [1e-3, 0.01, 0.3, 30.0])
def test_closing_by_direct_integration(material, speed):
    """Stress by superposition of relaxation (its glassy part apart), then the closure, with N = 1."""
    moduli, times = material.spectrum
    plane = 1 / (1 - material.poisson**2)

    def stress_times_root(s):
        # sqrt(s) [Einf/sqrt(2 pi s) + (1/v) int_0^s E'((s-y)/v)/sqrt(2 pi y) dy], y = s (1 - z)^2
        def fading(z):
            y = s * (1 - z) ** 2
            slope = -np.sum(moduli / times * np.exp(-(s - y) / (speed * times)))
            return slope * 2.0 * np.sqrt(s)

        faded = quad(fading, 0, 1, epsrel=1e-11, limit=300, points=[1e-4, 1e-2])[0] / speed
        return plane * (material.glassy_modulus + faded * np.sqrt(s)) / np.sqrt(2 * np.pi)

    gap = 2.0 * np.sqrt(2.0 / np.pi)
    work = sines(lambda s: stress_times_root(s) * gap * (ZONE - s), ZONE) / (2 * ZONE)
    release = material.relaxed_plane_modulus / 2.0  # K = E0* N
    assert_allclose(release / work, steady_crack.closing(material, ZONE, speed), rtol=1e-6)


@pytest.mark.parametrize("material", [ONE, THREE, ELASTIC], ids=["one", "three", "elastic"])
def test_laws_go_from_one_to_the_ratio_of_moduli_or_its_inverse(material):
    speed = np.geomspace(1e-12, 1e9, 60)
    ratio = material.glassy_modulus / material.modulus
    for law, rise, last in ((steady_crack.opening, 1.0, ratio), (steady_crack.closing, -1.0, 1.0 / ratio)):
        values = law(material, ZONE, speed)
        assert np.all(rise * np.diff(values) >= -1e-8)
        assert_allclose(values[[0, -1]], [1.0, last], rtol=1e-6)


def test_one_branch_formulas():
    speed = np.geomspace(1e-4, 10.0, 11)
    retarded, relaxed = ZONE / (speed * 10.0), ZONE / speed
    opening = 1.0 / (1.0 - 0.9 * (1.0 - np.exp(-retarded)) / retarded)
    closing = 1.0 / (1.0 + 9.0 * (1.0 - np.exp(-relaxed)) / relaxed)
    assert_allclose(steady_crack.opening(ONE, ZONE, speed), opening, rtol=1e-11)
    assert_allclose(steady_crack.closing(ONE, ZONE, speed), closing, rtol=1e-12)


@pytest.mark.parametrize("law", [starting_edge.closing, starting_edge.opening])
@pytest.mark.parametrize(("ratio", "travel"), [(2.0, 1.0), (10.0, 0.3), (10.0, 1.5), (100.0, 1.0)])
def test_an_edge_that_sets_off_by_direct_integration(law, ratio, travel):
    """Stress and gap of the moved edge into the closure, what its field takes up into the balance.

    The relaxed modulus, the zone and K at rest are 1, the work of adhesion is 1/2. The closure pairs, on one
    side, the field of the moved edge with, on the other, that and what was left where the edge was at rest.
    """
    closes = law is starting_edge.closing

    def paired(x):
        """``int_x^1 (s - x)^(-1/2) (1 - s)^(1/2) ds``, 4/(2 pi) of which is what sigma and g amount to."""
        return sines(lambda s: 1.0 - x - s, 1.0 - x)

    def taken_up(x):
        left = (ratio - 1.0) * (paired(x) if x < 1.0 else 0.0) * (-1.0 if closes else 1.0)

        def excess(moved):
            return (moved**2 * paired(0.0) + moved * left) / (np.pi * ratio) - 0.5

        moved = brentq(excess, 1e-9, 2.0 * ratio, xtol=1e-13)
        return moved**2 / (2.0 * ratio)

    gained = quad(lambda x: taken_up(x) - 0.5, 0.0, travel, points=[min(travel, 1.0)], epsabs=1e-10)[0]
    assert_allclose(0.5 * law(ratio, travel), gained if closes else -gained, rtol=1e-9)


@pytest.mark.parametrize(
    ("law", "ratio", "to"),
    [
        (starting_edge.closing, 10.0, 0.01),
        (starting_edge.closing, 1000.0, 0.014),
        (starting_edge.opening, 2.0, -0.003),
        (starting_edge.opening, 10.0, -0.003),
    ],
)
def test_the_loss_of_a_contact_pressed_or_pulled_at_once_falls_by_that(law, ratio, to):
    zone, work = 1e-4, 3.652e-4
    relaxed = Loading("relaxed", 0.0, (Ramp(to, 1e6),))
    material = Material(1.0, 0.5, (Branch(ratio - 1.0, 1.0),))
    trace = solve(Scene(material, Sphere(1.0), relaxed, Adhesion(work, zone)))
    radius = trace.contact_radius
    travel = np.abs(radius - radius[0]) / zone
    rows = (travel > 0.0) & (travel < 1.0) & (radius > 0.0)
    fall = -trace.dissipated_energy[rows] / (work * 2.0 * np.pi * radius[0] * zone)
    assert rows.sum() > 5
    assert_allclose(fall, law(ratio, travel[rows]), atol=5e-3 * law(ratio))
