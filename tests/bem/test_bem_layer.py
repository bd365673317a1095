"""A layer on a rigid base: the operator, the flat punch, spheres with and without adhesion, and refusals.

Cycles on layers: ``tests/all_solvers/test_layer.py``.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import j0, j1
from support.bem_runs import bem
from support.paper_scenes import scene

from bem_solver import solve
from bem_solver.annuli import Annuli, annulus_influence
from bem_solver.body import Compliance
from bem_solver.surface import ContactSurface, EdgeKinks
from contact_scene import (
    Adhesion,
    Cone,
    FlatPunch,
    ForceRamp,
    Layer,
    Loading,
    Material,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
)
from validation.reference.elastic_layer import ElasticLayer, transfer

BODIES = [(0.3, "bonded"), (0.4, "bonded"), (0.45, "bonded"), (0.5, "bonded"), (0.5, "frictionless")]
# force of a flat punch over 2 E* a D by contact radius over thickness, for each of the bodies
PUNCH = {
    0.2: (1.2066, 1.2323, 1.2523, 1.2806, 1.1710),
    1.0: (2.4835, 2.7938, 3.0914, 3.6187, 2.1986),
    3.0: (6.2613, 7.9916, 10.3654, 18.1574, 5.2874),
}


def body_of(poisson, base, thickness=1.0):
    return Compliance.of(
        replace(scene(material=Material(1.0, poisson), adhesion=None), body=Layer(thickness, base))
    )


@pytest.mark.parametrize("ratio", PUNCH)
def test_flat_punch(ratio):
    """In other units than those of the tests beside it: the operator has no length but the thickness."""
    for (poisson, base), stiffness in zip(BODIES, PUNCH[ratio], strict=True):
        body, edge = body_of(poisson, base, 7e-6), 7e-6 * ratio
        surface = ContactSurface.under(Annuli(60), edge, np.full(60, 3e-7), body=body)
        assert_allclose(surface.force / (6e-7 * edge), stiffness, atol=5.1e-5)


def test_displacement_is_that_of_the_transfer_function():
    """Inside, beside and far outside, under the pressures found, by a sum over the transform."""
    annuli, edge = Annuli(40), 1.3
    surface = ContactSurface.under(annuli, edge, 1.0 - 0.2 * annuli.radii**2, body=body_of(0.3, "bonded"))
    t = 0.002 * (np.arange(10000.0) + 0.5)
    k = 3.0 - 4.0 * 0.3
    transfer = (k * np.sinh(2 * t) - 2 * t) / (k * np.cosh(2 * t) + 2 * t * t + 5.0 - 12.0 * 0.3 + 8.0 * 0.09)
    borders = edge * annuli.borders
    discs = borders * j1(np.outer(t, borders)) / t[:, None]
    pressure = surface.scaled / edge
    lacking = (1.0 - transfer) * (np.diff(discs) @ pressure)
    radius = np.concatenate((edge * annuli.radii, [1.5, 2.0, 5.0, 12.0]))
    half_space = annulus_influence(radius, borders) @ pressure
    layer = half_space - 2.0 * 0.002 * j0(np.outer(radius, t)) @ lacking
    assert_allclose(layer[: annuli.count], 1.0 - 0.2 * annuli.radii**2, atol=1e-6)
    assert_allclose(surface.outside(radius[annuli.count :]), layer[annuli.count :], atol=2e-5)
    assert_allclose(surface.outside(np.array([19.0, 40.0])), 0.0, atol=1e-6)


@pytest.mark.parametrize("old", [0.79, 0.7999])
def test_former_edge_within_the_contact(old):
    """Under what a punch of another edge leaves, the force is that of the integral equation for a step."""
    annuli, edge = Annuli(60, 0.05), 0.8
    kinks = EdgeKinks(np.array([old]), np.array([0.25 * (edge - old)]))
    load = kinks.displacement(np.concatenate((edge * annuli.radii, kinks.readings)))[:, 0]
    surface = ContactSurface.under(annuli, edge, load, kinks, body=body_of(0.45, "bonded"))
    node, weight = np.polynomial.legendre.leggauss(30)
    x = np.concatenate((0.5 * old * (1.0 + node), old + 0.5 * (edge - old) * (1.0 + node)))
    w = np.concatenate((0.5 * old * weight, 0.5 * (edge - old) * weight))
    t = 0.005 * (np.arange(4000.0) + 0.5)
    waves = np.cos(np.outer(x, t)) * np.sqrt(0.01 / np.pi * (1.0 - transfer(t, 0.45, "bonded")))
    stress = np.linalg.solve(np.eye(60) - waves @ waves.T * w, 1.0 * (x < old))
    assert_allclose(surface.force, 2.0 * w @ stress, rtol=1e-4)
    assert_allclose(surface.load_work, 2.0 * w[:30] @ stress[:30], rtol=1e-4)


def test_bases_of_different_reach_agree():
    """Over a contact just below, and just above, the border between two of them."""
    body, annuli = body_of(0.45, "bonded"), Annuli(40)
    assert body.within(1.0) is not body.within(1.0 + 1e-9)
    below, above = (
        ContactSurface.under(annuli, edge, 0.1 - 0.05 * annuli.radii**2, body=body)
        for edge in (1.0, 1.0 + 1e-9)
    )
    assert_allclose(above.force, below.force, rtol=1e-8)
    assert_allclose(above.kappa, below.kappa, rtol=1e-8)
    radius = np.array([1.1, 3.0])
    assert_allclose(above.outside(radius), below.outside(radius), rtol=1e-6)


@pytest.mark.parametrize(
    "ratio", [0.3, 2.0, *(pytest.param(one, marks=pytest.mark.slow) for one in (9.0, 25.0))]
)
@pytest.mark.parametrize("indenter", [Sphere(1.0), Cone(80.0), PowerLaw(4.0, 3.0)], ids=lambda one: one.shape)
def test_pressed_contact(indenter, ratio):
    """Radius and force at a penetration, against the integral equation of the elastic layer."""
    layer = Layer(0.2 / ratio, "bonded")
    for poisson in (0.3, 0.5):
        exact = ElasticLayer(layer, poisson, indenter).state(0.2)
        ramp = Ramp(1.01 * exact.penetration, 1.0)
        question = scene(
            ramp,
            start="relaxed",
            at=exact.penetration,
            indenter=indenter,
            material=Material(1.0, poisson),
            adhesion=None,
        )
        trace = bem(replace(question, body=layer))
        assert_allclose(trace.contact_radius[0], 0.2, rtol=3e-6)
        assert_allclose(trace.force[0] * (1.0 - poisson**2), exact.force, rtol=3e-5)


@pytest.mark.parametrize("lengths", [0.2, pytest.param(1.0, marks=pytest.mark.exhaustive)])
def test_thin_film_jkr(lengths):
    """Elastic limits of stability on a bonded incompressible layer, zone extrapolated to nothing.

    ``lengths`` is ``(9 pi w R^2/8 E*)^(1/3)/h``. In SI units.
    """
    under_load, under_penetration = {0.2: (1.00598, 0.89099), 1.0: (1.20099, 0.63581)}[lengths]
    thickness, radius, modulus = 2.3e-5, 7e-4, 4e5
    work = (lengths * thickness) ** 3 * 8.0 * modulus / (9.0 * np.pi * radius**2)
    force, depth = 1.5 * np.pi * work * radius, 0.75 * (np.pi**2 * work**2 * radius / modulus**2) ** (1 / 3)
    reached = []
    for zone in (1e-3 * lengths * thickness, 5e-4 * lengths * thickness):
        lost = []
        for step in (ForceRamp(-3.0 * force, force), Ramp(-5.0 * depth, depth)):
            loading = Loading("relaxed", 2.0 * depth, (step,))
            run = solve(
                Scene(
                    Material(0.75 * modulus, 0.5),
                    Sphere(radius),
                    loading,
                    Adhesion(work, zone),
                    body=Layer(thickness, "bonded"),
                )
            )
            lost.append((-run.force.min() / force, -run.penetration[run.contact_radius > 0.0][-1] / depth))
        reached.append((lost[0][0], lost[1][1]))
    limit = 2.0 * np.array(reached[1]) - np.array(reached[0])
    assert_allclose(limit, (under_load, under_penetration), rtol=2e-5)


def test_steps_of_a_loaded_punch():
    """A punch under a growing force sinks as on the half-space, only less: its steps are judged alike."""
    loaded = scene(ForceRamp(1.0, 1.0), start="relaxed", indenter=FlatPunch(0.2), adhesion=None)
    trace, half_space = bem(replace(loaded, body=Layer(0.2 / 3.0, "bonded"))), bem(loaded)
    assert len(trace.time) == len(half_space.time)
    assert_allclose(18.15739 * trace.penetration[-1], half_space.penetration[-1], rtol=3e-6)


def test_elastic_layer_stores_what_it_is_given():
    """On a layer four fifths of what a half-space would seem to store is not there."""
    press = scene(
        Ramp(0.01, 1.0), Ramp(0.0, 1.0), material=Material(0.75, 0.5), adhesion=None, indenter=Cone(70.0)
    )
    trace = bem(replace(press, body=Layer(0.02, "bonded")), resolution=8)
    most = trace.stored_energy.max()
    assert_allclose(trace.stored_energy, trace.external_work, atol=1e-5 * most)
