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
from fem_solver.closure import exact_closure
from fem_solver.components import Components
from fem_solver.contact_problem import ContactProblem
from fem_solver.moduli import Prony, moduli
from fem_solver.placement import Placement, Surfaces
from fem_solver.state import undeformed
from validation.solvers.finite_elements import FiniteElements

SCENE = Scene(ONE, SPHERE, Loading("relaxed", 0.032, (Ramp(-0.5, 0.002),)), Adhesion(WORK, 1e-4))
ELASTIC = Components(Prony(1.0, np.zeros(0), np.zeros(0)))
UNIT = moduli(ONE).unit_plane_modulus
ZONE = 0.013
"""A process zone for which one mesh, fine from the axis on, serves all radii."""
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
    assert exact_closure(radius, zone)[0] == pytest.approx(expected, rel=1e-10)


def test_closure_of_a_paraboloid_is_the_integral_over_its_zone():
    radius, zone, depth, curvature = 1.3, 0.4, 0.7, 1.1

    def gap(x: float) -> float:
        opened = curvature / math.pi * radius * math.sqrt(x**2 - radius**2)
        return opened - 2.0 / math.pi * math.acos(radius / x) * (depth - 0.5 * curvature * x**2)

    def integrand(x: float) -> float:
        pressed = depth + curvature * (radius**2 - 2.0 * x**2)
        return -pressed * gap(x + zone) / (math.pi * math.sqrt(radius + x))

    expected = quad(integrand, radius - zone, radius, weight="alg", wvar=(0.0, -0.5))[0] / (2.0 * zone)
    found = exact_closure(radius, zone) @ (depth**2, depth * curvature, curvature**2)
    assert found == pytest.approx(expected, rel=1e-10)


def test_closure_of_a_punch_with_a_short_zone_is_its_energy_release_rate():
    assert exact_closure(2.0, 1e-9)[0] == pytest.approx(1.0 / (4.0 * np.pi), rel=1e-9)


@pytest.mark.parametrize("shift", [-2.5, -1.0, 0.0, 1.3, 2.7])
def test_closure_does_not_depend_on_where_in_the_strip_the_edge_is(shift):
    placement = surfaces().around(RADIUS)
    problem, radius = punch(placement), RADIUS + shift * SCENE.adhesion.zone
    closure = problem.closure(placement.geometry.position(radius))
    assert closure == pytest.approx(UNIT * exact_closure(radius, SCENE.adhesion.zone)[0], rel=4e-6)


@pytest.mark.parametrize("divisions", [4, 5, 10])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0, 1.5])
@pytest.mark.parametrize("depth", [0.0, 0.02, 0.032])
def test_an_elastic_ball_is_exact_wherever_the_edge_lies_within_an_element(divisions, share, depth):
    scene = replace(SCENE, adhesion=Adhesion(WORK, ZONE))
    placement = Surfaces(scene, FiniteElements().mesh(scene, divisions), moduli(ONE), True).around(0.2)
    s = 2.0 * round(0.5 * placement.geometry.position(0.2)) + share  # two nodes, of a vertex and of a side
    problem = ContactProblem(placement, ELASTIC, undeformed(placement, 0), 0.0, "penetration", depth)
    radius = placement.geometry.radius(s)
    assert problem.force(s) == pytest.approx(2.0 * UNIT * (depth * radius - radius**3 / 3.0), rel=1e-12)
    closure = UNIT * exact_closure(radius, ZONE) @ (depth**2, depth, 1.0)
    assert problem.closure(s) == pytest.approx(closure, rel=2e-6)


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
