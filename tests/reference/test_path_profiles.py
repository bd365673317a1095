"""Surface profiles of the reference: closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contact_scene import Adhesion, Branch, Cone, FlatPunch, Hold, Loading, Material, Scene, Sphere
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
    scene = Scene(Material(1.0, 0.3), indenter, Loading("jump-in", 0.02, (Hold(1.0),)), Adhesion(1e-4, 1e-3))
    (profile,) = solve(scene, Options(profile_times=(0.0,))).profiles
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
