"""Closure at the edge (paper, Eq. closure) on fields known exactly.

Sphere of radius 1 on unit plane modulus with the edge at ``a``, penetration ``D``, by Abel's transform:
``sigma = -(D - a^2)/(pi sqrt(a^2 - r^2)) - (2/pi) sqrt(a^2 - r^2)`` inside,
``g = r^2/2 - D + (2/pi) [D s - (r^2 s - a sqrt(r^2 - a^2))/2]``, ``s = arcsin(a/r)``, outside.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.bem_runs import observed_order
from support.paper_scenes import ELASTIC, STICKY, WORK, ZONE, scene

from bem_solver.annuli import Annuli
from bem_solver.creep import Chain
from bem_solver.equilibrium import untouched_state
from bem_solver.problem import ClosureRule, Problem
from bem_solver.trial import evaluate
from contact_scene import Adhesion, Counters
from validation.reference.finite_zone import FiniteZone

EDGE = 0.245
DEPTHS = {"adhesive": 0.032, "loose": 0.055}


def tension(r, depth, a=EDGE):
    root = np.sqrt(a * a - r * r)
    return -(depth - a * a) / (np.pi * root) - 2.0 / np.pi * root


def gap(r, depth, a=EDGE):
    s = np.arcsin(a / r)
    lifted = 2.0 / np.pi * (depth * s - 0.5 * (r * r * s - a * np.sqrt(r * r - a * a)))
    return 0.5 * r * r - depth + lifted


def problem(count=64, divisions=12, material=ELASTIC, adhesion=STICKY, exponent=2.0):
    """A problem as the solver sets it up, with a given number of annuli."""
    question = scene(start="relaxed", material=material, adhesion=adhesion)
    rule = ClosureRule.resolving(divisions)
    annuli = Annuli(count, exponent=exponent)
    return Problem(question, annuli, Chain(material), adhesion.zone if adhesion else 0.01, Counters(), rule)


def static(whole, edge, depth):
    return evaluate(whole, untouched_state(whole, depth), 0.0, edge, "penetration", depth)


@pytest.mark.parametrize("depth", DEPTHS.values(), ids=DEPTHS)
def test_rule_on_the_exact_sphere(depth):
    """Three ways: this rule, adaptive quadrature of Eq. closure as it stands, Gauss-Jacobi elsewhere."""
    rule = ClosureRule.resolving(12)
    s = ZONE * rule.distance
    value = 0.5 * rule.weight @ (tension(EDGE - s, depth) * gap(EDGE + ZONE - s, depth))

    def integrand(angle):  # r = a - da sin^2
        r = EDGE - ZONE * np.sin(angle) ** 2
        return tension(r, depth) * gap(r + ZONE, depth) * ZONE * np.sin(2.0 * angle)

    plain, _ = quad(integrand, 0.0, 0.5 * np.pi, epsrel=1e-11)
    assert_allclose(value, plain / (2.0 * ZONE), rtol=1e-9)
    assert_allclose(value, FiniteZone(1.0, 1.0, WORK, ZONE).closure(EDGE, depth), rtol=1e-9)


@pytest.mark.parametrize("divisions", [4, 12, 100])
def test_near_field_releases_irwins_energy(divisions):
    """``sigma = K/sqrt(2 pi s)`` and ``g = (4 K/E*) sqrt(x/(2 pi))`` give ``K^2/(2 E*)`` for any zone."""
    rule, intensity, modulus = ClosureRule.resolving(divisions), 0.3, 2.5
    for zone in (1e-6, 0.01, 0.9):
        s = zone * rule.distance
        stress = intensity / np.sqrt(2.0 * np.pi * s)
        opening = 4.0 * intensity / modulus * np.sqrt((zone - s) / (2.0 * np.pi))
        released = 0.5 * rule.weight @ (stress * opening)
        assert_allclose(released, intensity**2 / (2.0 * modulus), rtol=1e-12)


def test_zone_longer_than_the_contact_is_cut_at_the_centre():
    zone, edge, depth = 0.3, 0.2, 0.02
    found = static(problem(adhesion=Adhesion(WORK, zone)), edge, depth).closure

    def integrand(angle):  # r = a cos
        r = edge * np.cos(angle)
        return tension(r, depth, edge) * gap(r + zone, depth, edge) * edge * np.sin(angle)

    plain, _ = quad(integrand, 0.0, 0.5 * np.pi, epsrel=1e-11)
    assert_allclose(found, plain / (2.0 * zone), rtol=1e-4)


@pytest.mark.parametrize("depth", DEPTHS.values(), ids=DEPTHS)
def test_static_sphere_from_pressures(depth):
    """Formulation notes, section 4, last line; observed order two on annuli exact for another profile."""
    exact = FiniteZone(1.0, 1.0, WORK, ZONE).closure(EDGE, depth)
    assert_allclose(static(problem(40), EDGE, depth).closure, exact, rtol=5e-5)
    trials = [static(problem(count, exponent=4.0), EDGE, depth) for count in (40, 80, 160)]
    errors = [trial.closure / exact - 1.0 for trial in trials]
    assert abs(errors[0]) < 3e-2
    assert abs(errors[-1]) < 2e-3
    assert 1.7 < observed_order(errors) < 3.2, errors
    assert_allclose(trials[-1].surface.force, 2.0 * (EDGE * depth - EDGE**3 / 3.0), rtol=1e-7)
    assert_allclose(trials[-1].residual, trials[-1].closure - WORK, rtol=1e-12)


def test_pressed_edge_closes_whatever_the_product_of_the_signs():
    """Compression meets overlap beyond the edge: the product is positive, the edge must advance."""
    trial = static(problem(), 0.1, 0.032)
    assert trial.surface.kappa > 0.0
    assert trial.closure < 0.0
    assert trial.residual < -WORK


def test_force_control_is_penetration_control_read_backwards():
    whole = problem(material=ELASTIC)
    given = static(whole, EDGE, 0.032)
    start = untouched_state(whole, 0.0)
    back = evaluate(whole, start, 0.0, EDGE, "force", given.surface.force)
    assert_allclose(back.motion.new_penetration, 0.032, rtol=1e-11)
    assert_allclose(back.closure, given.closure, rtol=1e-9)


def test_without_adhesion_the_edge_carries_no_singularity():
    whole = problem(adhesion=None)
    for edge, sign in ((0.15, -1.0), (0.2, 1.0)):
        trial = static(whole, edge, 0.032)
        assert np.sign(trial.residual) == sign
        assert_allclose(trial.residual, edge**2 - 0.032, atol=1e-4)
    assert whole.counters.closure_evaluations == 0
    assert whole.counters.linear_solves == 2
