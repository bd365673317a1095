"""Stress in the body from annular loads: against Hankel integrals, closed forms, and the finite elements."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import j0, j1

import bem_solver
import fem_solver
from bem_solver.subsurface import disc_load, punch_load, subsurface_stress
from contact_scene import (
    Adhesion,
    Branch,
    FlatPunch,
    Hold,
    Loading,
    Material,
    PowerLaw,
    Scene,
    Sphere,
)
from fem_solver.fields import field_states
from fem_solver.solver import record
from validation import cases
from validation.reference import subsurface
from validation.solvers.finite_elements import FiniteElements

MODULUS, POISSON, WORK = 3.0, 0.3, 2e-3
PLANE = MODULUS / (1.0 - POISSON**2)


@pytest.mark.parametrize("r", [1e-5, 0.3, 1.2, 2.0])
@pytest.mark.parametrize(
    ("load", "transform"),
    [
        (lambda r, s: disc_load(r, s, np.array(1.2)), lambda k: 1.2 * j1(1.2 * k) / k),
        (punch_load, lambda k: np.sin(k) / k),
    ],
    ids=["disc", "punch"],
)
def test_potentials_are_their_hankel_integrals(load, transform, r):
    s = 0.35
    node, weight = np.polynomial.legendre.leggauss(10)
    borders = np.linspace(0.0, 40.0 / s, 201)
    half = 0.5 * np.diff(borders)[:, None]
    k = (borders[:-1, None] + half * (1.0 + node)).ravel()
    share = (half * weight).ravel() * transform(k) * np.exp(-k * s)
    even = [share @ (k * j0(k * r)), share @ (k**2 * j0(k * r))]
    odd = [share @ (k**n * j1(k * r)) / r for n in (0, 1, 2)]
    assert_allclose(load(np.array(r), np.array(s)), even + odd, rtol=2e-9)


def static_profile(indenter, work, penetration):
    adhesion = Adhesion(work, 0.003) if work else None
    loading = Loading("relaxed", penetration, (Hold(1.0),))
    scene = Scene(Material(MODULUS, POISSON), indenter, loading, adhesion)
    options = bem_solver.Options(profile_times=(1.0,))
    return bem_solver.solve(scene, options).profiles[-1]


@pytest.mark.parametrize(
    ("indenter", "work", "penetration", "bound"),
    [
        (FlatPunch(0.3), WORK, 0.1, 1e-8),
        (Sphere(0.7), 0.0, 0.13, 2e-4),
        (Sphere(0.7), WORK, 0.13, 2e-4),
        (PowerLaw(4.0, 2.0), WORK, 0.05, 5e-4),
    ],
    ids=["punch", "hertz", "jkr", "power-law"],
)
def test_elastic_contacts_have_the_closed_forms(indenter, work, penetration, bound):
    profile = static_profile(indenter, work, penetration)
    a = profile.contact_radius
    r, z = np.meshgrid(np.linspace(0.0, 2.0, 21) * a, -np.geomspace(0.005, 2.0, 15) * a)
    away = np.hypot(r - a, z) > 0.05 * a
    exact = subsurface.contact(r, z, indenter, a, profile.penetration, PLANE, POISSON).stress[:, away]
    found = subsurface_stress(profile, r, z, POISSON)[:, away]
    assert np.abs(found - exact).max() < bound * np.abs(exact).max()
    # on the surface constant pressures show
    r = np.linspace(0.0, 0.9, 10) * a
    surface = subsurface_stress(profile, r, 0.0, POISSON)
    exact = subsurface.contact(r, 0.0, indenter, a, profile.penetration, PLANE, POISSON).stress
    assert np.abs(surface - exact).max() < 5e-3 * np.abs(exact).max()


def test_annuli_converge_on_the_pressure_and_carry_its_force():
    profile = static_profile(Sphere(0.7), WORK, 0.13)
    a = profile.contact_radius
    r, z = np.meshgrid(np.linspace(0.0, 1.5, 8) * a, [-0.2 * a, -a])
    finest = subsurface_stress(profile, r, z, POISSON, 1600)
    errors = [np.abs(subsurface_stress(profile, r, z, POISSON, n) - finest).max() for n in (50, 100, 200)]
    assert errors[2] < errors[1] / 3.5 < errors[0] / 3.5**2
    far = subsurface_stress(profile, 0.0, -1000.0 * a, POISSON, 50)
    assert_allclose(far[1], -1.5 * profile.force / (np.pi * (1000.0 * a) ** 2), rtol=1e-4)


def test_no_contact_no_stress_and_nothing_infinite():
    profile = static_profile(FlatPunch(0.3), WORK, 0.1)
    points = np.array([0.0, 0.3, 0.3, 5.0]), np.array([0.0, 0.0, -1e-14, 0.0])
    assert np.isfinite(subsurface_stress(profile, *points, POISSON)).all()
    free = replace(profile, contact_radius=0.0, pressure=0.0 * profile.pressure)
    assert_allclose(subsurface_stress(free, *points, POISSON), 0.0)
    with pytest.raises(ValueError, match="body"):
        subsurface_stress(profile, 0.1, 0.1, POISSON)


def field_differences(times, resolution=8):
    """Largest differences of the two fields two process zones from the edge on, over the largest stress."""
    scene = cases.load("cycle-v0.02").scene
    poisson = 0.4
    young = scene.material.modulus / 0.75 * (1.0 - poisson**2)  # the same plane modulus
    scene = replace(scene, material=Material(young, poisson, (Branch(9.0 * young, 1.0),)))
    options = fem_solver.Options(record_times=times)
    recording = record(scene, FiniteElements().mesh(scene, resolution), options)
    boundary = bem_solver.solve(scene, bem_solver.Options(resolution, profile_times=times))
    profiles = {profile.time: profile for profile in boundary.profiles}
    rows = {int(np.flatnonzero(recording.trace.time == time)[-1]): "" for time in times}
    differences = []
    for state in field_states(recording, rows):
        profile = profiles[state.time]
        a = profile.contact_radius
        r, z = state.points.T
        chosen = (np.hypot(r, z) < 3.0 * a) & (np.hypot(r - a, z) > 2.0 * scene.adhesion.zone)
        stress = subsurface_stress(profile, r[chosen], np.minimum(z[chosen], 0.0), poisson)
        inside = state.stress[:, chosen]
        differences.append(float(np.abs(stress - inside).max() / np.abs(inside).max()))
    return differences


@pytest.mark.exhaustive
def test_finite_elements_find_the_same_stress_all_along_the_cycle():
    """At jump-in the singular part is all there is."""
    assert max(field_differences((0.0, 0.8, 1.6, 2.2, 2.45))) < 0.01
