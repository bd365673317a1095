"""Process zones short against the contact radius: steps over zones, annuli graded towards the edge.

The pull-off forces are those of a retraction from the relaxed contact at V = 0.002, by front tracking at
twice its default resolution.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem, front
from support.paper_scenes import cycle

from bem_solver import Options, solve
from bem_solver.annuli import Annuli
from bem_solver.size_estimates import edge_step, graded_annuli
from bem_solver.surface import ContactSurface
from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    Ramp,
    Scene,
    Sphere,
)

PULL_OFF = {1.3e-3: 0.02028430, 1.3e-4: 0.02305769, 1.3e-5: 0.02343383, 1.3e-6: 0.02347723, 1e-9: 0.02348288}
"""By front tracking; the shortest is the limit of fast opening in closed form."""
DISTANCES = np.array([1e-9, 1e-7, 1e-5, 1e-3, 0.1, 0.5])


def retraction(zone):
    return Scene(
        Material(0.75, 0.5, (Branch(6.75, 1.0),)),
        Sphere(1.0),
        Loading("relaxed", 0.032, (Ramp(-0.5, 0.002),)),
        Adhesion(5.026548e-4, zone),
    )


def pulled(zone, resolution):
    """Relative error of the pull-off force, and the run."""
    trace = solve(retraction(zone), Options(resolution))
    assert trace.outcome.kind == "detached"
    return -trace.force.min() / PULL_OFF[zone] - 1.0, trace


@pytest.mark.slow
def test_a_cone_pressed_to_hundreds_of_times_its_first_radius():
    """Radius and force by front tracking at half its default resolution.

    The surface was known out to 200 times the first radius: an edge that came there slid off, by 7 %.
    """
    material = Material(2.7e5, 0.49, (Branch(4.5e7, 0.015), Branch(1.35e7, 0.35)))
    loading = Loading("jump-in", 0.0, (Ramp(2.6e-5, 1e-5),))
    trace = solve(Scene(material, Cone(82.0), loading, Adhesion(0.25, 1.1e-7)), Options(4))
    assert trace.contact_radius[-1] > 250.0 * trace.contact_radius[0]
    assert_allclose(trace.contact_radius[-1], 1.2521787e-4, rtol=5e-4)
    assert_allclose(trace.force[-1], 0.015807233, rtol=5e-4)


@pytest.mark.parametrize(
    ("zone", "error"),
    [
        pytest.param(1.3e-3, 2e-3, marks=pytest.mark.slow),
        (1.3e-5, 2e-4),
        pytest.param(1e-9, 2e-4, marks=pytest.mark.exhaustive),
    ],
)
def test_pull_off_in_few_steps(zone, error):
    """At half the default resolution; 16,000 steps of a part of a zone would be the longer one's."""
    missed, trace = pulled(zone, 6)
    assert abs(missed) < error
    assert trace.counters.steps < 220


@pytest.mark.parametrize(
    ("zone", "resolution", "error"),
    [
        pytest.param(1.3e-3, 12, 1e-4, marks=pytest.mark.slow),
        pytest.param(1.3e-3, 48, 1e-5, marks=pytest.mark.exhaustive),
    ],
)
def test_default_error_and_four_times_the_resolution(zone, resolution, error):
    assert abs(pulled(zone, resolution)[0]) < error


@pytest.mark.slow
@pytest.mark.parametrize(("rate", "force"), [(2e-5, 1.64535e-4), (2e-2, 1.668212e-3)])
def test_approach_over_zones(rate, force):
    """Force by front tracking at the end of a slow and of a fast approach."""
    scene = replace(retraction(2.5e-5), loading=Loading("jump-in", 0.0, (Ramp(0.004, rate),)))
    trace = solve(scene, Options(12))
    assert trace.outcome.kind == "completed"
    assert_allclose(trace.force[-1], force, atol=1e-3 * np.abs(trace.force).max())


@pytest.mark.slow
def test_slow_approach_and_fast_retraction():
    """Speeds of 1e-6 and 0.02 in one scene, zone 3e-5 of the radius; pull-off force by front tracking."""
    steps = (Ramp(0.001, 1e-6), Ramp(-0.5, 0.02))
    scene = replace(retraction(2.5e-6), loading=Loading("jump-in", 0.0, steps))
    trace = solve(scene, Options(12))
    assert trace.outcome.kind == "detached"
    assert_allclose(-trace.force.min(), 0.007310717, rtol=2e-4)
    assert trace.counters.steps < 400


def closed(to, rate):
    """An approach at half the default resolution, zone 3e-5 of the radius."""
    scene = replace(retraction(2.5e-6), loading=Loading("jump-in", 0.0, (Ramp(to, rate),)))
    return solve(scene, Options(6))


@pytest.mark.slow
def test_steps_over_what_an_edge_covers():
    """Steps of up to 200 zones; radius by front tracking at four times its default resolution."""
    trace = closed(0.001, 1e-6)
    assert_allclose(trace.contact_radius[-1], 0.0796962, rtol=2e-4)
    assert trace.counters.steps < 90


@pytest.mark.slow
def test_limit_point_of_a_very_short_zone():
    """A share of the zone is less than rounding there: a run that looked for it so closely did not end."""
    scene = replace(retraction(1e-9), loading=Loading("relaxed", 0.032, (Ramp(-0.5, 1.0),)))
    trace = solve(scene, Options(6))
    assert trace.outcome.kind == "detached"
    assert_allclose(trace.time[-1], 0.00794907, rtol=1e-5)


@pytest.mark.exhaustive
def test_steps_of_an_edge_before_layers_of_three_branches():
    """Over four decades of time; an uneven speed of the fast edge took 1072 steps."""
    branches = (Branch(3.0, 0.01), Branch(2.5, 1.0), Branch(1.25, 100.0))
    loading = Loading("jump-in", 0.0, (Ramp(0.032, 0.02), Ramp(-0.5, 0.02)))
    scene = replace(retraction(2e-6), material=Material(0.75, 0.3, branches), loading=loading)
    trace = solve(scene, Options(12))
    assert trace.outcome.kind == "detached"
    assert_allclose(trace.time[-1], 3.12573, rtol=1e-4)
    assert trace.counters.steps < 850


@pytest.mark.slow
def test_delayed_detachment_over_zones():
    """Time by front tracking: the penetration bends within a step, and the edge runs away."""
    scene = replace(retraction(1.3e-3), loading=Loading("relaxed", 0.032, (Force(-0.00947482, 5000.0),)))
    trace = solve(scene, Options(12))
    assert trace.outcome.kind == "detached"
    assert_allclose(trace.time[-1], 312.3068, rtol=1e-3)


@pytest.mark.parametrize(("to", "excess"), [(0.006, 9.0), (0.004, 0.9)])
def test_branches_turn_into_heat_what_a_slow_sharp_edge_releases(to, excess):
    """Per area, in works of adhesion: ``Einf/E0 - 1`` closing, with a glassy tip; ``1 - E0/Einf`` opening."""
    scene = replace(retraction(1.3e-4), loading=Loading("relaxed", 0.005, (Ramp(to, 1e-8),)))
    trace = solve(scene, Options(6))
    turned = np.pi * abs(np.diff(trace.contact_radius[[0, -1]] ** 2)[0]) * scene.adhesion.work
    assert_allclose(trace.extra["branch_dissipation"][-1], excess * turned, rtol=0.01)


@pytest.mark.parametrize(
    ("rate", "force"),
    [
        (1e-9, -0.00134917),
        *(
            pytest.param(*row, marks=pytest.mark.exhaustive)
            for row in ((3e-8, -0.00133454), (1e-7, -0.00130598))
        ),
    ],
)
def test_edge_at_rest_that_advances_slowly(rate, force):
    """Force by front tracking: the layer behind the edge is a 20,000th to a 400th of the zone."""
    scene = replace(retraction(1.3e-4), loading=Loading("relaxed", 0.005, (Ramp(0.0056, rate),)))
    trace = solve(scene, Options(6))
    assert_allclose(trace.force[-1], force, rtol=1.5e-3)
    assert trace.counters.steps < 40


@pytest.mark.slow
def test_advance_within_a_zone_carries_the_whole_fall_of_the_load():
    """Steps many times the branch's time, yet a part of a zone; with a root alone 1.8e-3 off."""
    scene = replace(retraction(1.3e-4), loading=Loading("relaxed", 0.005, (Ramp(0.0056, 1e-7),)))
    assert_allclose(solve(scene, Options(24)).force[-1], -0.00130598, rtol=6e-4)


@pytest.mark.parametrize("grading", [0.2, 1e-2, 1e-4])
def test_sphere_on_graded_annuli(grading):
    """Tension and outer displacement as near to the edge as the process zone needs them."""
    depth, (count, _) = 0.7, graded_annuli(12, grading / 12)
    annuli = Annuli(count, grading)
    surface = ContactSurface.under(annuli, 1.0, depth - 0.5 * annuli.radii**2)
    assert_allclose(surface.force, 2.0 * (depth - 1.0 / 3.0), rtol=1e-5)
    assert_allclose(surface.kappa, depth - 1.0, rtol=2e-4)
    root = np.sqrt(DISTANCES * (2.0 - DISTANCES))
    tension = (1.0 - depth) / (np.pi * root) - 2.0 / np.pi * root
    assert_allclose(surface.tension(DISTANCES) * root, tension * root, atol=3e-4)
    x = 1.0 + DISTANCES
    s = np.arcsin(1.0 / x)
    exact = 2.0 / np.pi * (depth * s - 0.5 * (x**2 * s - np.sqrt(x**2 - 1.0)))
    assert_allclose(surface.outside(x), exact, atol=2e-6)


def test_number_of_annuli_grows_with_the_logarithm_of_the_zone():
    counts = [graded_annuli(12, edge_step(12, 10.0**-n, 1.0, 0.0))[0] for n in range(2, 8)]
    assert_allclose(np.diff(counts), 9.0 * np.log(10.0), atol=1.1)


def test_few_steps_up_to_where_the_edge_runs_away():
    """A path of the edge over the time misses the instant of the loss by 1.4e-4, with as many steps."""
    trace = bem(cycle(0.002), resolution=4)
    assert trace.counters.steps < 80
    assert_allclose(trace.time[-1], 43.3846019, rtol=2e-5)


@pytest.mark.slow
def test_creep_over_the_first_zones_beyond_a_place_of_rest():
    """What the edge comes to was one cubic over a hundred zones: it ran ahead, by 0.031 zones of two."""
    zone = 2.1576e-5
    material, adhesion = Material(1.0, 0.45, (Branch(12.0, 5.0),)), Adhesion(7.92e-6, zone)
    loading = Loading("relaxed", 0.004013136, (Force(0.0011154288, 18.0),))
    question = Scene(material, Sphere(1.0), loading, adhesion)
    ahead = bem(question).contact_radius[-1] - front(question).contact_radius[-1]
    assert abs(ahead) < 0.01 * zone


@pytest.mark.slow
def test_edge_returns_over_what_it_has_left_and_beyond():
    """Wide annuli read now and then what it had left there: the edge went on in jumps, 1760 steps."""
    rubber = Material(2e6, 0.49, (Branch(5e6, 0.05), Branch(3e6, 1.5)))
    steps = (Hold(1.0), Ramp(9e-6, 2e-6), Hold(1.0), Ramp(1.1e-5, 2e-6))
    question = Scene(rubber, Sphere(2e-3), Loading("jump-in", 1e-5, steps), Adhesion(0.2, 1.5e-9))
    trace = solve(question, Options(max_steps=400))
    assert trace.outcome.kind == "completed"
    assert_allclose(trace.contact_radius[-1], 1.736266741e-4, rtol=2e-4)  # by front tracking


@pytest.mark.exhaustive
def test_third_opening_of_an_oscillation_over_a_short_zone():
    """Each turn leaves a place of rest; the edge meets the first ones again. Radius by front tracking.

    With the outermost eight places kept alone it is a seventieth of its swing too small.
    """
    material = Material(1e6, 0.49, (Branch(3e6, 0.01), Branch(1e6, 1.0)))
    loading = Loading("relaxed", 2e-5, (Oscillate(5e-6, 6.28, 2.67),))
    trace = bem(Scene(material, Sphere(1e-3), loading, Adhesion(0.05, 1.5e-9)), resolution=4)
    assert_allclose(trace.contact_radius[-1], 1.516111e-4, atol=1e-3 * np.ptp(trace.contact_radius))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("steps", "radius", "swing"),
    [
        ((ForceRamp(1e-3, 5e-3), ForceRamp(1.5e-3, 5e-3)), 1.5506403e-4, 6.856e-6),
        ((Ramp(2.5e-5, 2e-5), Ramp(2.45e-5, 2e-5)), 1.6681668e-4, 4.898e-6),
    ],
    ids=["force", "penetration"],
)
def test_edge_goes_on_where_its_load_turns(steps, radius, swing):
    """It goes nearly as far in a tenth of the time: no leap, but steps as short as its speed asks.

    Radius by front tracking at the end, zone 1e-5 of it. Taken for a leap it is 15 and 2.5 zones off.
    """
    material = Material(1e6, 0.49, (Branch(3e6, 0.01), Branch(1e6, 1.0)))
    trace = bem(Scene(material, Sphere(1e-3), Loading("relaxed", 2e-5, steps), Adhesion(0.05, 1.5e-9)))
    assert_allclose(trace.contact_radius[-1], radius, atol=3e-4 * swing)
