"""Square roots inside the contact: punches with the old edge, exact however narrow the new band is."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.bem_runs import bem, front
from support.paper_scenes import scene

from bem_solver.annuli import Annuli
from bem_solver.surface import ContactSurface, EdgeKinks
from contact_scene import Adhesion, Branch, Cone, Force, Material, Ramp, Sphere

TWO = Material(0.75, 0.5, (Branch(0.75, 0.1), Branch(0.75, 1.0)))


def test_a_kink_alone_is_the_flat_punch_it_came_from():
    """``v`` of a punch with edge 0.7, given to a contact with edge 0.72: the annuli have nothing to do."""
    annuli, old, edge = Annuli(24), 0.7, 0.72
    kinks = EdgeKinks.within((old,), edge, 0.01)
    radius = np.append(edge * annuli.radii, kinks.readings)
    load = np.where(radius <= old, 1.0, 2.0 / np.pi * np.arcsin(np.minimum(old / radius, 1.0)))
    aware, blind = (
        ContactSurface.under(annuli, edge, load, kinks),
        ContactSurface.under(annuli, edge, load[:24]),
    )
    assert_allclose(aware.force, 2.0 * old, rtol=3e-4)
    assert abs(aware.force - 2.0 * old) < 0.1 * abs(blind.force - 2.0 * old)
    assert abs(aware.kappa) < 0.05 * abs(blind.kappa)
    beyond = edge * np.array([1.0, 1.01, 1.5, 30.0])
    assert_allclose(aware.outside(beyond), 2.0 / np.pi * np.arcsin(old / beyond), rtol=1e-4)


@pytest.mark.parametrize("band", [1e-9, 1e-5, 1e-2])
def test_strength_is_read_however_narrow_the_band(band):
    kinks = EdgeKinks.within((0.3, 0.5), 0.5 + band, 0.1)
    assert_allclose(kinks.reach, [0.1, min(band, 0.1)])
    given = np.array([2.0, -3.0])
    load = 0.4 + kinks.displacement(kinks.readings) @ given
    # the inner punch is smooth at the outer kink, up to what a straight line misses
    assert_allclose(kinks.strengths(load), given, rtol=2e-1 if band > 1e-3 else 5e-2)


def test_punches_carry_their_force():
    kinks = EdgeKinks.within((0.3,), 0.5, 0.1)
    force, _ = quad(lambda s: -kinks.tension(0, s * s) * 2.0 * np.pi * (0.3 - s * s) * 2.0 * s, 0.0, 0.3**0.5)
    assert_allclose(force, 2.0 * 0.3, rtol=1e-9)


@pytest.mark.parametrize("band", [1e-2, 3e-3, 1e-3, 1e-4])
def test_work_of_two_punches_on_each_other(band):
    """``v = 1 - 0.3 u`` with u of a punch inside the edge: ``int p v = 2 a - 4 0.3 b + 2 0.3^2 b``.

    Summed over annuli the work of the inner punch is off by up to 3e-5, either way.
    """
    annuli, edge = Annuli(80, 0.01), 0.25
    old = edge * (1.0 - band)
    kinks = EdgeKinks(np.array([old]), np.array([edge - old]))
    radius = np.concatenate((edge * annuli.radii, kinks.readings))
    load = 1.0 - 0.3 * kinks.displacement(radius)[:, 0]
    surface = ContactSurface.under(annuli, edge, load, kinks)
    exact = 2.0 * edge - 1.2 * old + 0.18 * old
    assert_allclose(surface.load_work, exact, rtol=2e-6)
    assert_allclose(surface.work_on(load[:, None]), exact, rtol=2e-6)


def test_volume_of_a_punch_on_an_annulus():
    kinks = EdgeKinks(np.array([0.3]), np.array([0.1]))

    def volume(first, last):
        where = [0.3] if first < 0.3 < last else None
        return quad(
            lambda r: 2.0 * np.pi * r * kinks.displacement(np.array([r]))[0, 0], first, last, points=where
        )[0]

    expected = [[volume(0.0, 0.2)], [volume(0.2, 0.35)], [volume(0.35, 0.5)]]
    assert_allclose(kinks.volumes(np.array([0.0, 0.2, 0.35, 0.5])), expected, rtol=1e-9)


def test_no_kinks_no_work():
    assert len(EdgeKinks.within((), 1.0, 0.1).radius) == 0
    assert len(EdgeKinks.within((1.0, 2.0, 0.0), 1.0, 0.1).radius) == 0


@pytest.mark.parametrize("resolution", [4, 6, 12])
@pytest.mark.parametrize(
    ("indenter", "depth", "zone"),
    [(Sphere(1.0), 0.02, 0.013), (Cone(82.0), 0.0058, 0.02)],
    ids=["sphere", "cone"],
)
def test_small_rise_from_a_relaxed_contact(indenter, depth, zone, resolution):
    """The edge moves by a fraction of an annulus; the force follows the glassy stiffness, not a snap."""
    question = scene(
        Ramp(1.001 * depth, depth),
        start="relaxed",
        at=depth,
        material=TWO,
        indenter=indenter,
        adhesion=Adhesion(3.2e-4, zone),
    )
    ours, exact = bem(question, resolution=resolution), front(question, 20)
    assert not ours.events
    assert_allclose(np.ptp(ours.force), np.ptp(exact.force), rtol=0.1)
    assert np.ptp(ours.contact_radius) < 2.0 * np.ptp(exact.contact_radius)
    assert_allclose(ours.force[-1] - ours.force[0], exact.force[-1] - exact.force[0], rtol=0.1)


@pytest.mark.slow
def test_load_jump_from_a_relaxed_contact_is_no_snap():
    question = scene(Force(0.004, 3.0), start="relaxed", at=0.01)
    assert not bem(question).events
    assert_allclose(bem(question).contact_radius[-1], front(question).contact_radius[-1], rtol=2e-4)
