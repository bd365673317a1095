"""Weak forms, strains and internal variables on small meshes of a cylinder."""

from itertools import pairwise

import numpy as np
import pytest
from skfem import Basis, ElementTriP1, ElementTriP2, ElementVector, MeshTri

from fem_solver import forms
from fem_solver.moduli import Prony, phi


def cylinder(refinements=2):
    """Radius 1, height 1, top at z = 0."""
    mesh = MeshTri().refined(refinements)
    return MeshTri(np.stack([mesh.p[0], mesh.p[1] - 1.0]), mesh.t)


def spaces(mesh):
    displacement = Basis(mesh, ElementVector(ElementTriP2()), intorder=5)
    return displacement, Basis(mesh, ElementTriP1(), quadrature=displacement.quadrature)


def volumetric(basis, pressures):
    """``int div u div v`` in the pressures, as a dense matrix."""
    divergence = forms.divergence(basis, pressures).toarray()
    return divergence.T @ np.linalg.solve(forms.pressure_mass(pressures).toarray(), divergence)


def field(basis, radial, vertical):
    r, z = basis.doflocs
    is_radial = np.zeros(basis.N, bool)
    is_radial[np.concatenate([basis.nodal_dofs[0], basis.facet_dofs[0]])] = True
    return np.where(is_radial, radial(r, z), vertical(r, z))


def interior(basis):
    r, z = basis.doflocs
    return (r > 1e-9) & (r < 1 - 1e-9) & (z < -1e-9) & (z > -1 + 1e-9)


@pytest.mark.parametrize("bulk", [0.7, 1e3])
def test_patch_of_uniform_strain_is_in_equilibrium(bulk):
    basis, pressures = spaces(cylinder())
    u = field(basis, lambda r, z: 0.3 * r, lambda r, z: -0.2 * z + 0.1)
    stiffness = forms.deviatoric_stiffness(basis).toarray() + bulk * volumetric(basis, pressures)
    force = stiffness @ u
    assert np.abs(force[interior(basis)]).max() < 1e-11 * max(bulk, 1.0)
    assert np.abs(force).max() > 0.1


def test_mixed_patch_carries_the_pressure_of_the_uniform_dilatation():
    basis, pressures = spaces(cylinder())
    u = field(basis, lambda r, z: 0.3 * r, lambda r, z: -0.2 * z)
    divergence = forms.divergence(basis, pressures)
    mass = forms.pressure_mass(pressures)
    p = np.full(pressures.N, -2.0 * (0.6 - 0.2))  # -K div u with K = 2
    assert np.abs(divergence @ u + mass @ p / 2.0).max() < 1e-14
    force = forms.deviatoric_stiffness(basis) @ u - divergence.T @ p
    assert np.abs(force[interior(basis)]).max() < 1e-13


def test_only_the_axial_translation_is_free_of_energy():
    basis, pressures = spaces(cylinder(1))
    matrix = forms.deviatoric_stiffness(basis).toarray() + volumetric(basis, pressures)
    assert np.abs(matrix - matrix.T).max() < 1e-12
    energies = np.linalg.eigvalsh(matrix)
    assert abs(energies[0]) < 1e-12
    assert energies[1] > 1e-3  # a radial shift stretches hoops, unlike in the plane
    lift = field(basis, lambda r, z: 0 * r, lambda r, z: 1 + 0 * r)
    assert np.abs(matrix @ lift).max() < 1e-12


def test_hoop_strain_counts_in_the_energy():
    # u_r = r^2: strains (2r, 0, r), deviator (r, -r, 0), so 2 int dev:dev = 4 int r^2 = 2 pi
    basis, pressures = spaces(cylinder())
    u = field(basis, lambda r, z: r**2, lambda r, z: 0 * r)
    assert u @ forms.deviatoric_stiffness(basis) @ u == pytest.approx(2 * np.pi, rel=1e-12)
    # dilatation 3r: int 9 r^2 = 9 pi/2
    assert u @ volumetric(basis, pressures) @ u == pytest.approx(4.5 * np.pi, rel=1e-12)


def test_strain_operator_agrees_with_the_assembled_stiffness():
    basis, _ = spaces(cylinder())
    operator = forms.strain_operator(basis)
    u = np.random.default_rng(3).normal(size=basis.N)
    strains = (operator @ u).reshape(4, -1)
    weights = np.concatenate([w * forms.volume_weights(basis).ravel() for w in forms.CONTRACTION])
    force = operator.T @ (weights * 2.0 * forms.deviator(strains).ravel())
    expected = forms.deviatoric_stiffness(basis) @ u
    assert np.abs(force - expected).max() < 1e-11 * np.abs(expected).max()


def test_one_element_relaxes_like_the_closed_form():
    # one triangle stretched on a ramp to t = 1 and held: G * x in closed form
    mesh = MeshTri(np.array([[0.5, 1.0, 0.6], [-1.0, -0.9, 0.0]]), np.array([[0], [1], [2]]))
    basis = Basis(mesh, ElementVector(ElementTriP2()), intorder=5)
    operator, weights = forms.strain_operator(basis), forms.volume_weights(basis).ravel()
    weights = np.concatenate([w * weights for w in forms.CONTRACTION])
    u = np.random.default_rng(5).normal(size=basis.N)
    shape = 2.0 * forms.deviator((operator @ u).reshape(4, -1)).ravel()
    modulus = Prony(1.0, np.array([3.0, 2.0]), np.array([0.2, 40.0]))
    branches, x, time = np.zeros((2, shape.size)), np.zeros_like(shape), 0.0
    stiffness = forms.deviatoric_stiffness(basis)
    for end in (0.1, 0.9, 1.0, 1.05, 3.0, 100.0):
        step, new = modulus.increment(end - time), shape * min(end, 1.0)
        memory = step.memory(branches, x)
        branches = step.advance(branches, new - x)
        assert np.allclose(step.modulus * new + memory, new + branches.sum(axis=0), rtol=1e-13, atol=1e-13)
        x, time = new, end
        force = operator.T @ (weights * (modulus.relaxed * x + branches.sum(axis=0)))
        until = min(end, 1.0)
        tau = modulus.times
        ramped = modulus.moduli * tau * (np.exp(-(end - until) / tau) - np.exp(-end / tau))
        expected = (until + ramped.sum()) * (stiffness @ u)
        assert np.abs(force - expected).max() < 1e-12 * np.abs(expected).max()


def test_phi_at_both_ends():
    assert phi(np.array([0.0, np.inf])).tolist() == [1.0, 0.0]
    assert phi(np.array([1e-12]))[0] == pytest.approx(1.0 - 5e-13, rel=1e-15)


@pytest.mark.parametrize("dt", [1e-9, 1e-3, 0.99e-3, 1.0, 50.0])
def test_branch_loss_is_the_integral_over_the_step(dt):
    modulus = Prony(0.0, np.array([3.0]), np.array([0.7]))
    before, dx = 0.4, 0.3
    t, w = np.polynomial.legendre.leggauss(60)
    edges = np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 30)]) * dt
    loss = 0.0
    for a, b in pairwise(edges):
        s = 0.5 * (a + b) + 0.5 * (b - a) * t
        branch = np.exp(-s / 0.7) * before - 3.0 * 0.7 / dt * np.expm1(-s / 0.7) * dx
        loss += 0.5 * (b - a) * w @ (branch**2 / 3.0 / 0.7)
    weights = modulus.loss_weights(dt)[:, 0]
    assert weights @ [before**2 / 3.0, before * dx, 3.0 * dx**2] == pytest.approx(loss, rel=1e-9)


@pytest.mark.parametrize("dt", [1e-6, 0.69e-3, 0.71e-3, 0.99e-3, 1e-3, 1.0, 50.0])
def test_a_bend_of_the_strain_within_a_step_adds_its_integrals(dt):
    modulus, b, dx, bend = Prony(0.0, np.array([3.0]), np.array([0.7])), 0.4, 0.3, 0.11
    t, w = np.polynomial.legendre.leggauss(80)
    share, weight = 0.5 * (t + 1.0), 0.5 * w

    def after(at, bent):
        """The branch at a share of the step, by quadrature over the time before."""
        s = at * share
        rate = 3.0 * (dx + bent * (2.0 * s - 1.0))
        return np.exp(-at * dt / 0.7) * b + at * weight @ (np.exp(-(at - s) * dt / 0.7) * rate)

    found = modulus.increment(dt).advance(np.array([[b]]), np.array([dx]), np.array([bend]))
    # a series ends at 0.7e-3: what it leaves out is most there
    assert found[0, 0] == pytest.approx(after(1.0, bend), rel=1e-12)
    straight, bent = (np.array([after(at, c) for at in share]) for c in (0.0, bend))
    lost = dt / 0.7 / 3.0 * weight @ (bent**2 - straight**2)
    found = modulus.bent_loss(dt, np.array([[b]]), np.array([dx]), np.array([bend]))
    assert found[0] == pytest.approx(lost, rel=2e-3 if dt <= 1e-3 else 1e-6)


@pytest.mark.parametrize("dt", [1e-5, 1e-3, 0.5, 20.0, 1e4])
def test_mean_branch_loss_is_that_of_parts_that_leave_evenly(dt):
    modulus = Prony(0.0, np.array([3.0]), np.array([0.7]))
    share, weight = np.polynomial.legendre.leggauss(60)
    edges = np.concatenate([[0.0], np.geomspace(1e-6, 1.0, 30)])
    mean = np.zeros(3)
    for a, b in pairwise(edges):
        for s, w in zip(0.5 * (a + b) + 0.5 * (b - a) * share, 0.5 * (b - a) * weight, strict=True):
            mean += w * modulus.loss_weights(s * dt)[:, 0] * [1.0, s, s**2]
    assert modulus.mean_loss_weights(dt)[:, 0] == pytest.approx(mean, rel=2e-6)
