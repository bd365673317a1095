"""A layer of finite thickness: its surface against closed forms."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.paper_scenes import ONE, SPHERE, WORK

from contact_scene import Adhesion, Layer, Loading, Material, Ramp, Scene
from fem_solver import Options, solve
from fem_solver.layer import LayerDifference, ring_fields
from fem_solver.moduli import moduli
from fem_solver.placement import Surfaces, UnscaledSurface
from meshes import EdgeMeshes, layer
from validation.reference.elastic_layer import ElasticLayer
from validation.solvers.finite_elements import FiniteElements

ADHESION = Adhesion(WORK, 0.013)


def ratio(nu: float) -> float:
    return 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu)


@cache
def difference(base: str, nu: float, reach: float) -> LayerDifference:
    return LayerDifference(layer(reach), base, ratio(nu))


@cache
def half_space(nu: float) -> tuple[UnscaledSurface, float]:
    """The surface of a mesh in process zones, and the plane modulus."""
    material = Material(0.75, nu)
    scene = Scene(material, SPHERE, Loading("jump-in", 0.1, (Ramp(-0.5, 0.02),)), ADHESION)
    surfaces = Surfaces(scene, EdgeMeshes(0.013, 5, 0.5, 0.14), moduli(material), True)
    return surfaces._level(1), moduli(material).unit_plane_modulus


@pytest.mark.parametrize("radius", [0.0, 0.4, 2.0])
def test_a_ring_force_is_borne_by_any_plane_below_it(radius):
    r = np.concatenate([np.linspace(0.0, 20.0, 4001), np.geomspace(20.0, 1e4, 4001)[1:]])
    stress = ring_fields(np.stack([r, -np.ones_like(r)]), radius, ratio(0.3))[1]
    assert np.trapezoid(2.0 * np.pi * r * stress[2], r) == pytest.approx(-1.0, abs=1e-5)


@pytest.mark.parametrize(
    ("base", "nu", "moment", "second"),
    [
        ("bonded", 0.5, 1.77021677, 3.83107716),
        ("bonded", 0.3, 1.37685417, 2.51020665),
        ("frictionless", 0.5, 1.16757684, 1.58152555),
        ("frictionless", 0.2, 1.16757684, 1.58152555),
    ],
)
def test_the_difference_at_the_axis_has_the_moments_of_the_transfer_function(base, nu, moment, second):
    """``D(r, 0) = -(1 - nu)/(2 pi) int (1 - K) J0(t r) dt``, by ``int (1 - K) (1 - t^2 r^2/4 + ...)``."""
    r = np.array([0.0, 0.05])
    unit = -2.0 * np.pi / (1.0 - nu) * difference(base, nu, 1.0).compliance(r)[0]
    assert unit[0] == pytest.approx(moment, rel=2e-6)
    assert (unit[0] - unit[1]) / r[1] ** 2 == pytest.approx(0.25 * second, rel=5e-3)


@pytest.mark.parametrize(
    ("base", "nu", "stiffer"),
    [
        ("bonded", 0.3, (1.2066, 2.4835, 6.2613)),
        ("bonded", 0.45, (1.2523, 3.0914, 10.3654)),
        ("bonded", 0.5, (1.2806, 3.6187, 18.1574)),
        ("frictionless", 0.5, (1.1710, 2.1986, 5.2874)),
    ],
)
def test_a_flat_punch_is_as_much_stiffer_as_the_integral_equation_says(base, nu, stiffer):
    surface, modulus = half_space(nu)
    for expected, relative in zip(stiffer, (0.2, 1.0, 3.0), strict=True):
        vertex = int(np.searchsorted(surface.radii, 48.0))
        for node in (vertex, vertex + 1):  # and a mid-side node
            scale = relative / surface.effective[node]
            on = surface.on_layer(difference(base, nu, 1.3 * relative), scale)
            stiffness = np.sum(on.unit[: node + 1] ** 2) / (2.0 * modulus * surface.effective[node])
            assert stiffness == pytest.approx(expected, rel=1e-4)


def pressed(thickness: float, depth: float) -> tuple[Scene, ElasticLayer]:
    """A sphere pressed onto a bonded, incompressible layer without adhesion, and the elastic one."""
    body, loading = Layer(thickness, "bonded"), Loading("jump-in", 0.0, (Ramp(depth, 0.02),))
    return Scene(ONE, SPHERE, loading, body=body), ElasticLayer(body, ONE.poisson, SPHERE)


@pytest.mark.slow
def test_elements_grow_less_where_a_layer_is_thin():
    """Otherwise the stiffness is off by 4e-3: what the half-space errs by is much of a small difference."""
    scene, elastic = pressed(0.02, 0.0135)
    material = moduli(ONE)
    surface = Surfaces(scene, FiniteElements().mesh(scene), material, True).around(0.2)
    node = int(surface.geometry.position(0.2))
    radius = surface.geometry.effective[node]
    stiffness = np.sum(surface.unit[: node + 1] ** 2) / material.unit_plane_modulus
    assert radius > 9.9 * elastic.layer.thickness
    assert stiffness == pytest.approx(elastic.response(radius).stiffness, rel=1.5e-3)


def test_a_growing_contact_without_adhesion_bears_the_history_of_the_elastic_force():
    """Lee and Radok's ``F(t) = int E(t - s) dF_el(D(s))``, at any thickness."""
    scene, elastic = pressed(0.1, 0.02)
    trace = solve(scene, FiniteElements().mesh(scene))
    times = np.linspace(0.0, 1.0, 161)
    radii = [elastic.radius_at(0.02 * t) for t in times[1:]]
    forces = np.append(
        0.0, [elastic.response(a).force(0.02 * t) for a, t in zip(radii, times[1:], strict=True)]
    )
    (branch,) = ONE.branches
    step = times[1] / branch.time
    kept = np.exp(-(1.0 - times[1:]) / branch.time) * -np.expm1(-step) / step
    expected = (ONE.modulus * forces[-1] + branch.modulus * kept @ np.diff(forces)) / (1.0 - ONE.poisson**2)
    assert trace.contact_radius[-1] == pytest.approx(radii[-1], rel=5e-5)
    assert trace.force[-1] == pytest.approx(expected, rel=2e-4)


CYCLE = Loading("jump-in", 0.0, (Ramp(0.02, 0.02), Ramp(-0.5, 0.02)))
ON_LAYER = Scene(ONE, SPHERE, CYCLE, ADHESION, body=Layer(0.2, "bonded"))


def meshes_of(divisions: int = 10, zone: float = 0.013) -> EdgeMeshes:
    return EdgeMeshes(zone, divisions, 0.27, 0.4 / divisions**0.5)


@pytest.mark.slow
def test_meshes_that_follow_the_edge_agree_with_one_that_stays():
    """Elements and steps are the same: what is left is that of the places of the mesh."""
    short = replace(ON_LAYER, adhesion=Adhesion(WORK, 0.004))
    options = Options(tolerance=5e-4)
    followed, stays = (solve(short, meshes_of(n, zone), options) for n, zone in ((10, 0.004), (30, 0.012)))
    for found in (lambda t: t.force.max(), lambda t: -t.force.min(), lambda t: t.external_work[-1]):
        assert found(followed) == pytest.approx(found(stays), rel=2e-4)
    assert followed.penetration[-1] == pytest.approx(stays.penetration[-1], rel=3e-6)
