"""The assembled half-space against point forces, punches and spheres on an elastic body."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from contact_scene import Loading, Material, Scene, Sphere
from fem_solver import solve
from fem_solver.halfspace import HalfSpace, boussinesq_shapes
from fem_solver.placement import triangular
from meshes import EdgeMeshes, MeshParameters, structured_half_space


def ratio(nu):
    return 1.5 * (1.0 - 2.0 * nu) / (1.0 + nu)


@cache
def mesh(domain=400.0, grading=0.2, divisions=3):
    asked = MeshParameters(0.03 / divisions, 0.0, 0.36, max(0.3 * domain, 2.88), grading)
    return structured_half_space(asked)


@cache
def factors(nu):
    return HalfSpace(mesh()).factorise(ratio(nu), 61)


def symmetric(lower):
    """The whole of a matrix of which the lower triangle is given."""
    return np.tril(lower) + np.tril(lower, -1).T


def surface_field(nu, node):
    """Downward and radial surface displacement per unit force on one node's ring, unit shear modulus."""
    factor = factors(nu)
    space = factor.space
    load = np.zeros(space.unknowns)
    load[space.surface_dofs[node]] = -1.0
    u = factor.solve(load, factor.far_mix)
    vertices = np.flatnonzero((space.mesh.p[1] == 0.0) & (space.mesh.p[0] > 0.0))
    order = vertices[np.argsort(space.mesh.p[0, vertices])]
    radial, vertical = space.basis.nodal_dofs[:, order]
    return space.mesh.p[0, order], -u[vertical], u[radial]


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.4999, 0.5])
def test_boussinesq_displacements_of_a_small_ring(nu):
    radii, down, radial = surface_field(nu, 1)
    away = (radii > 0.2) & (radii < 20.0)
    expected = (1.0 - nu) / (2.0 * np.pi * radii[away])
    assert np.abs(down[away] / expected - 1.0).max() < 1.5e-3
    # Cerruti by reciprocity: the same number is the sinking at the centre under a radial ring force
    inward = -(1.0 - 2.0 * nu) / (4.0 * np.pi * radii[away])
    assert np.abs((radial[away] - inward) * radii[away]).max() < 3e-4


def test_radial_ring_force_lifts_the_centre_as_reciprocity_demands():
    factor = factors(0.3)
    space = factor.space
    at = int(np.argmin(np.abs(space.mesh.p[0] - 0.21) + 10.0 * np.abs(space.mesh.p[1])))
    ring = np.zeros(space.unknowns)
    ring[space.basis.nodal_dofs[0, at]] = 1.0
    sinking = -factor.solve(ring, np.zeros(2))[space.surface_dofs[1]]
    load = np.zeros(space.unknowns)
    load[space.surface_dofs[1]] = -1.0
    drawn = factor.solve(load, np.zeros(2))[space.basis.nodal_dofs[0, at]]
    assert sinking == pytest.approx(drawn, rel=1e-9)
    assert drawn == pytest.approx(-0.4 / (4 * np.pi * space.mesh.p[0, at]), rel=5e-3)


def test_boussinesq_shapes_are_equilibrated_and_free_of_traction():
    # the volume shape is harmonic-like: check both against finite differences of Navier's equation
    points = np.array([[0.7, 0.3], [-0.4, -1.1]])
    h, nu = 1e-3, 0.3
    share = 3.0 * ratio(nu) / (3.0 + ratio(nu))
    assert share == pytest.approx(1.0 - 2.0 * nu)

    def u(dr, dz):
        shear, volume = boussinesq_shapes(points + np.array([[dr], [dz]]))
        return shear + share * volume

    def div(dr, dz):
        r = points[0] + dr
        rate_r = (u(dr + h, dz)[0] - u(dr - h, dz)[0]) / (2 * h)
        rate_z = (u(dr, dz + h)[1] - u(dr, dz - h)[1]) / (2 * h)
        return rate_r + rate_z + u(dr, dz)[0] / r

    r = points[0]
    second = (u(h, 0) + u(-h, 0) + u(0, h) + u(0, -h) - 4 * u(0, 0)) / h**2
    laplace = second + (u(h, 0) - u(-h, 0)) / (2 * h * r)
    laplace[0] -= u(0, 0)[0] / r**2
    gradient = np.stack([(div(h, 0) - div(-h, 0)) / (2 * h), (div(0, h) - div(0, -h)) / (2 * h)])
    residual = laplace + gradient / (1.0 - 2.0 * nu)
    assert np.abs(residual).max() < 1e-4 * np.abs(second).max()


@pytest.mark.parametrize("nu", [0.3, 0.4999999, 0.5])
def test_elimination_without_pivoting_is_as_good_as_a_refined_solution(nu):
    factor = factors(nu)
    matrix = factor.space.matrix(factor.ratio)[factor.order][:, factor.order]
    load = np.random.default_rng(0).normal(size=len(factor.order))
    found = factor.factor.solve(load)
    missed = factor.factor.solve(load - matrix @ found)
    assert np.abs(missed).max() < 1e-11 * np.abs(found).max()
    clamped = symmetric(factor.condensed())
    unit = np.eye(1, len(load), len(load) - factor.count + 7)[0]
    assert np.allclose(factor.factor.solve(unit)[-factor.count :], clamped[7], rtol=1e-9, atol=0.0)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_surface_compliance_is_positive(nu):
    factor = factors(nu)
    whole, weights = factor.compliance()
    assert np.abs(weights - 1.0).max() < 1e-4
    assert np.linalg.eigvalsh(symmetric(whole)).min() > 0.0


def test_leading_blocks_of_one_factor_serve_every_contact():
    compliance = symmetric(factors(0.3).compliance()[0])
    root = triangular(compliance.copy(order="F"))
    imposed = np.cos(3.0 * np.arange(61) / 61)
    unit, y = np.linalg.solve(root, np.stack([np.ones(61), imposed], axis=1)).T
    for count in (5, 18, 61):
        forces = np.linalg.solve(compliance[:count, :count], imposed[:count])
        assert np.allclose(np.linalg.solve(root[:count, :count].T, y[:count]), forces, rtol=1e-9)
        last = slice(count - 3, count)
        assert np.allclose(np.linalg.solve(root[last, last].T, y[last]), forces[-3:], rtol=1e-9)
        assert unit[:count] @ y[:count] == pytest.approx(forces.sum(), rel=1e-10)


@cache
def punch_radius(nu, far_field=True, domain=400.0):
    """Of the flat punch as stiff as contact up to a node, over the radius of that node."""
    space = HalfSpace(mesh(domain), far_field)
    compliance = symmetric(space.factorise(ratio(nu), 61).compliance()[0])[:41, :41]
    stiffness = np.linalg.solve(compliance, np.ones(41)).sum()
    return stiffness * (1.0 - nu) / 4.0 / space.radii[40]


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_hertz_forces(nu):
    scene = Scene(Material(1.0 - nu**2, nu), Sphere(1.0), Loading("relaxed", 0.04))
    trace = solve(scene, EdgeMeshes(0.0125, 4, 0.25))
    assert trace.force[0] == pytest.approx(4.0 / 3.0 * 0.2**3, rel=5e-4)
    assert trace.contact_radius[0] == pytest.approx(0.2, rel=5e-4)


def test_nothing_locks_where_the_body_keeps_its_volume():
    exact = punch_radius(0.3)
    for nu in (0.4999, 0.5):
        assert abs(punch_radius(nu) / exact - 1.0) < 2e-3


def test_far_field_removes_the_error_of_the_truncated_domain():
    exact = punch_radius(0.3)
    clamped, prescribed = (
        [abs(punch_radius(0.3, far_field=far, domain=d) / exact - 1.0) for d in (10.0, 20.0, 40.0)]
        for far in (False, True)
    )
    for a, b in pairwise(clamped):
        assert 1.6 < a / b < 2.5  # a/R of the boundary
    assert max(prescribed) < 0.03 * min(clamped)
