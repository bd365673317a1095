"""Fields in an elastic layer: what its surface and its base are bound to."""

import numpy as np
import pytest

from contact_scene import Cone, FlatPunch, Layer, Sphere
from validation.reference import subsurface
from validation.reference.elastic_layer import ElasticLayer
from validation.reference.layer_subsurface import contact

A, WORK = 0.2, 1e-4


def field(layer, indenter, poisson, r, z):
    elastic = ElasticLayer(layer, poisson, indenter)
    state = elastic.state(A, WORK)
    return state, contact(elastic, np.asarray(r), np.asarray(z), A, state.penetration, 1.0)


@pytest.mark.parametrize(
    ("base", "poisson", "thickness", "indenter"),
    [
        ("bonded", 0.0, 0.2, Sphere(1.0)),
        ("bonded", 0.5, 0.02, Sphere(1.0)),
        ("bonded", 0.3, 0.5, FlatPunch(A)),
        ("frictionless", 0.3, 0.1, Cone(20.0)),
    ],
)
def test_the_surface_follows_the_indenter_and_the_base_is_rigid(base, poisson, thickness, indenter):
    r = np.linspace(0.0, 0.95 * A, 9)
    state, top = field(Layer(thickness, base), indenter, poisson, r, 0.0 * r)
    height = indenter.height(r) if not isinstance(indenter, FlatPunch) else 0.0
    assert np.abs(top.displacement[1] + state.penetration - height).max() < 1e-6 * abs(state.penetration)
    assert np.abs(top.stress[3]).max() < 1e-10 * np.abs(top.stress).max()
    r = np.linspace(0.0, 2.0 * A, 9)
    _, low = field(Layer(thickness, base), indenter, poisson, r, np.full(9, -thickness))
    held = low.displacement if base == "bonded" else low.displacement[1:]
    assert np.abs(held).max() < 1e-6 * abs(state.penetration)
    if base == "frictionless":
        assert np.abs(low.stress[3]).max() < 1e-9 * np.abs(low.stress).max()


def test_it_is_in_equilibrium_and_bears_the_force():
    layer, h = Layer(0.2, "frictionless"), 1e-4
    r, z = np.meshgrid([0.1, 0.27], [-0.05, -0.15])
    r, z = r.ravel(), z.ravel()
    steps = [
        field(layer, Sphere(1.0), 0.3, r + dr, z + dz)[1].stress
        for dr, dz in ((h, 0), (-h, 0), (0, h), (0, -h))
    ]
    here = field(layer, Sphere(1.0), 0.3, r, z)[1].stress
    along_r, along_z = (steps[0] - steps[1]) / (2 * h), (steps[2] - steps[3]) / (2 * h)
    radial = along_r[0] + along_z[3] + (here[0] - here[2]) / r
    axial = along_r[3] + along_z[1] + here[3] / r
    assert max(np.abs(radial).max(), np.abs(axial).max()) < 1e-5 * np.abs(along_z).max()
    r = np.linspace(0.0, 1.6, 1601)
    state, plane = field(layer, Sphere(1.0), 0.3, r, np.full_like(r, -0.1))
    assert np.trapezoid(-2.0 * np.pi * r * plane.stress[1], r) == pytest.approx(state.force, rel=1e-4)


def test_a_thick_layer_is_a_half_space():
    r, z = np.array([0.0, 0.15, 0.4]), np.array([-0.1, 0.0, -0.2])
    state, found = field(Layer(2e4, "bonded"), Sphere(1.0), 0.3, r, z)
    expected = subsurface.contact(r, z, Sphere(1.0), A, state.penetration, 1.0, 0.3)
    assert np.abs(found.stress - expected.stress).max() < 1e-4 * np.abs(expected.stress).max()
