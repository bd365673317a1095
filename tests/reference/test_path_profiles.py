"""Surface profiles of the reference: closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.paper_scenes import WORK, scene

from contact_scene import Adhesion, Branch, Cone, FlatPunch, Hold, Loading, Material, Ramp, Scene, Sphere
from validation.reference import subsurface
from validation.reference.path.equilibrium import start_state
from validation.reference.path.fields import Passages
from validation.reference.path.profiles import profile
from validation.reference.path.rheology import IndentedBody, rheology
from validation.reference.path.solver import Options, solve
from validation.reference.sneddon import transform


@pytest.mark.parametrize("indenter", [Sphere(1.0), Cone(70.0)])
def test_elastic_contact_has_the_closed_form(indenter):
    """Displacement and pressure of an elastic contact with adhesion, at the surface of the half-space."""
    asked = Scene(Material(1.0, 0.3), indenter, Loading("jump-in", 0.02, (Hold(1.0),)), Adhesion(1e-4, 1e-3))
    (profile,) = solve(asked, Options(profile_times=(0.0,))).profiles
    a, r = profile.contact_radius, profile.radius
    exact = subsurface.contact(r, 0.0 * r, indenter, a, profile.penetration, 1.0 / 0.91, 0.3)
    away = np.abs(r - a) > 0.02 * a
    assert profile.displacement == pytest.approx(-exact.displacement[1], abs=2e-8 * profile.penetration)
    pressure = -exact.stress[1][away]
    assert profile.pressure[away][1:] == pytest.approx(pressure[1:], abs=1e-6 * np.abs(pressure).max())


def test_a_contact_of_two_ages_is_two_punches():
    """Branch forces that jump within the contact: each age adds a flat punch of its own radius."""
    body = IndentedBody(rheology(Material(1.0, 0.3, (Branch(2.0, 1.0),))), transform(FlatPunch(1.0)))
    inner, outer = 0.6, 1.0
    left = np.zeros((2, 6, 2))
    left[:, 0, 1] = held = np.array([0.5, -0.2])
    parabola = np.array([[-outer, inner, 1.0], [inner - outer, outer - inner, 1.0]])
    table = Passages(
        np.array([-outer, inner - outer, 0.0]),
        np.ones(2, bool),
        parabola,
        np.zeros(2),
        left,
        0.0 * left[:, 0, 1:],
    )
    pressed = profile(body, FlatPunch(1.0), replace(start_state(body, 0.0, outer, False), surface=table))
    r, within = pressed.radius[:-1], pressed.radius < inner
    p = np.where(r < outer, held[1] / np.sqrt(np.abs(outer**2 - r**2)), 0.0)
    p += np.where(r < inner, (held[0] - held[1]) / np.sqrt(np.abs(inner**2 - r**2)), 0.0)
    assert pressed.pressure[:-1] == pytest.approx(p / np.pi, rel=1e-7)
    assert within.sum() > 50


@pytest.mark.slow
@pytest.mark.parametrize("indenter", [Sphere(1.0), Cone(80.0), FlatPunch(0.2)], ids=lambda one: one.shape)
def test_profiles_carry_the_force(indenter):
    """``2 pi int p r dr = F``, by a quadrature that knows of the root at the edge."""
    asked = scene(Ramp(0.032, 0.02), Ramp(0.0, 0.02), indenter=indenter, adhesion=Adhesion(WORK, 0.004))
    profiles = solve(asked, Options(resolution=32, profile_times=(0.0, 0.8, 1.6, 1.9))).profiles
    assert len(profiles) == 4
    for one in profiles:
        a, within = one.contact_radius, one.radius < one.contact_radius
        angle = np.arcsin(one.radius[within] / a)
        density = one.pressure[within] * one.radius[within] * a * np.cos(angle)
        edge = 3.0 * density[-1] - 3.0 * density[-2] + density[-3]
        total = 2.0 * np.pi * np.trapezoid(np.append(density, edge), np.append(angle, 0.5 * np.pi))
        assert total == pytest.approx(one.force, abs=2e-3 * max(abs(one.force), 1e-3))
        assert np.isfinite(one.displacement).all()
        assert np.all(np.diff(one.radius) > 0.0)
