"""What a following mesh is read in: the flat punch's closure and Hertz's force, wherever the edge lies."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad
from support.paper_scenes import ONE, SPHERE, WORK

from contact_scene import Adhesion, Loading, PowerLaw, Ramp, Scene, Sphere
from fem_solver.components import Components
from fem_solver.contact_problem import ContactProblem
from fem_solver.moduli import Prony, moduli
from fem_solver.placement import Placement, Surfaces, punch_closure
from fem_solver.state import undeformed
from validation.solvers.finite_elements import FiniteElements

SCENE = Scene(ONE, SPHERE, Loading("relaxed", 0.032, (Ramp(-0.5, 0.002),)), Adhesion(WORK, 1e-4))
ELASTIC = Components(Prony(1.0, np.zeros(0), np.zeros(0)))
UNIT = moduli(ONE).unit_plane_modulus
RADIUS, MOVED = 0.1, 6e-4
"""A contact radius, and by how much it changes from one place of the mesh to the next: six zones."""


@cache
def surfaces(indenter: Sphere | PowerLaw = SPHERE) -> Surfaces:
    return Surfaces(replace(SCENE, indenter=indenter), FiniteElements().mesh(SCENE, 5), moduli(ONE), True)


def punch(placement: Placement) -> ContactProblem:
    """A flat punch of any radius, pulled by a unit."""
    flat = np.zeros(len(placement.radii))
    placement = replace(placement, height=flat, profile=flat)
    return ContactProblem(placement, ELASTIC, undeformed(placement, 0), 0.0, "penetration", -1.0)


def test_closure_of_a_punch_is_the_integral_over_its_zone():
    radius, zone = 1.3, 0.4

    def integrand(x: float) -> float:
        return math.acos(radius / (x + zone)) / math.sqrt(radius + x)

    expected = quad(integrand, radius - zone, radius, weight="alg", wvar=(0.0, -0.5))[0] / (np.pi**2 * zone)
    assert punch_closure(radius, zone) == pytest.approx(expected, rel=1e-10)


def test_closure_of_a_punch_with_a_short_zone_is_its_energy_release_rate():
    assert punch_closure(2.0, 1e-9) == pytest.approx(1.0 / (4.0 * np.pi), rel=1e-9)


@pytest.mark.parametrize("shift", [-2.5, -1.0, 0.0, 1.3, 2.7])
def test_closure_does_not_depend_on_where_in_the_strip_the_edge_is(shift):
    placement = surfaces().around(RADIUS)
    problem, radius = punch(placement), RADIUS + shift * SCENE.adhesion.zone
    closure = problem.closure(placement.geometry.position(radius))
    assert closure == pytest.approx(UNIT * punch_closure(radius, SCENE.adhesion.zone), rel=4e-6)


def test_closure_hardly_changes_where_the_mesh_moves_on():
    here, there = surfaces().around(RADIUS), surfaces().around(RADIUS + MOVED)
    assert here.place != there.place
    radius = RADIUS + 0.5 * MOVED
    before, after = (punch(one).closure(one.geometry.position(radius)) for one in (here, there))
    assert after == pytest.approx(before, rel=4e-6)


@pytest.mark.parametrize(
    ("exponent", "radius", "known"),
    [(2.0, 0.01, 1e-8), pytest.param(2.0, RADIUS, 1e-8, marks=pytest.mark.slow), (4.0, RADIUS, 1.5e-5)],
)
def test_a_tip_without_adhesion_bears_over_the_strip_what_sneddon_has(exponent, radius, known):
    placement = surfaces(PowerLaw(exponent, 1.0)).around(radius)
    first, last = int(placement.lowest), placement.geometry.last
    ends = placement.geometry.effective[first - 1 : last]
    depths = placement.profile[first:last] / placement.unit[first:last]
    factor = math.sqrt(math.pi) * math.gamma(1.0 + 0.5 * exponent) / math.gamma(0.5 + 0.5 * exponent)
    exact = factor * np.diff(ends ** (exponent + 1.0)).sum() / (exponent + 1.0)
    assert np.diff(ends) @ depths == pytest.approx(exact, rel=known)


@pytest.mark.slow
def test_an_edge_about_to_run_away_does_not_leap_where_the_mesh_moves_on():
    # on the glassy plateau a change of the closure by 1e-5 is the whole speed of the edge
    short = replace(SCENE, loading=Loading("relaxed", 0.032, (Ramp(-0.5, 0.02),)))
    trace = FiniteElements().solve(short)
    assert trace.outcome.kind == "detached"
    assert len(trace) < 300
    before = trace.time < trace.time[-1] - 1e-5  # then the loss itself: a load known to 1e-7
    assert np.diff(trace.contact_radius[before]).max() < 0.1 * SCENE.adhesion.zone
