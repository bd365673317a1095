"""Options, the steps they lead to, and progress."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem
from support.paper_scenes import ELASTIC, ONE, WORK, ZONE, cycle, scene

from bem_solver import Options, solve
from bem_solver.control import SHARE_OF_WAY, AcceptedRow, AcceptedSteps, departure_from_chord, span
from contact_scene import (
    Adhesion,
    Branch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    Oscillate,
    PowerRate,
    Ramp,
    Scene,
    SceneError,
    Sphere,
    Sweep,
    Table,
)
from contact_scene.run_control import LoadingInterval
from validation.solvers import solver

COARSE, COARSEST = Options(resolution=6), Options(resolution=4)


def test_small_oscillation_of_a_relaxed_contact():
    """One cycle, by front tracking; the penetration bends within steps as long as the branch's time."""
    trace = solve(scene(Oscillate(0.001, 0.3, 2.0 * np.pi / 0.3), start="relaxed", at=0.02), COARSE)
    assert_allclose(trace.force[-1], 2.9691511e-3, rtol=6e-4)
    assert_allclose(trace.external_work[-1], 2.9101638e-6, rtol=1.5e-3)
    assert len(trace) < 50


@pytest.mark.parametrize(
    "wrong",
    [
        {"resolution": 3},
        {"resolution": 10**6},
        {"annuli": "square"},
        {"scheme": "forward-euler"},
        {"step": 0.0},
        {"step": float("nan")},
    ],
    ids=str,
)
def test_options_are_checked(wrong):
    with pytest.raises(SceneError) as error:
        Options(**wrong)
    assert next(iter(wrong)) in str(error.value)
    assert "allowed" in str(error.value)


def test_options_have_defaults_that_refine_together():
    assert Options().divisions >= 4
    assert Options(resolution=4).divisions == 4
    ratio = Options(resolution=10).step_tolerance / Options(resolution=20).step_tolerance
    assert_allclose(ratio, 4.0)
    assert Options(tolerance=0.1).step_tolerance == 0.1


@pytest.mark.parametrize("material", [ELASTIC, ONE], ids=["elastic", "viscoelastic"])
def test_every_step_keeps_to_the_tolerance(material):
    """Departure of the force from a straight line, an eighth of the error of extrapolating the last chord.

    The chord reaches back as far as the step ahead; the force is followed four times closer than the edge.
    """
    question = scene(Sweep(0.005, 2.0, 5.0), start="relaxed", at=0.02, adhesion=None, material=material)
    trace = solve(question, COARSE)
    t, force = trace.time, trace.force
    departures = []
    for i in range(2, len(t) - 1):
        step = t[i + 1] - t[i]
        base = max((j for j in range(i) if t[i] - t[j] >= step * (1.0 - 1e-12)), default=0)
        line = force[i] + (force[i] - force[base]) / (t[i] - t[base]) * step
        departures.append(0.125 * abs(force[i + 1] - line) / np.abs(force[: i + 2]).max())
    assert trace.counters.rejected_steps > 0
    assert 0.5 < 4.0 * max(departures) / COARSE.step_tolerance <= 1.0 + 1e-6


def test_kinks_of_a_table_are_stepped_onto():
    times = (0.0, 0.1234, 0.3, 0.777, 1.0)
    trace = solve(scene(Table(times, (0.005, 0.01, 0.012, 0.006, 0.008)), at=0.005, adhesion=None), COARSE)
    assert set(times) <= set(trace.time)


@pytest.mark.parametrize("rounded", [1.0 - 1e-14, 1.0, 1.0 + 1e-14])
def test_a_step_as_long_as_the_last_looks_back_over_the_last_alone(rounded):
    """Otherwise the next step, a tenth longer or shorter, hangs on the last bit of the clock."""
    steps = AcceptedSteps()
    for row in ((0.0, 1.0, 0.0), (0.1, 1.1, 0.1), (0.2, 1.3, 0.4)):
        steps.add(AcceptedRow(*row))
    assert_allclose(steps.rates(0.1 * rounded), (2.0, 3.0), rtol=1e-12)


@pytest.mark.parametrize(
    "jump",
    [
        *(pytest.param(jump, marks=pytest.mark.slow) for jump in (2e-19, 1e-10)),
        *(pytest.param(jump, marks=pytest.mark.exhaustive) for jump in (0.0, 1e-17, 1e-14)),
    ],
)
def test_a_load_jump_of_roundings_is_stepped_over(jump):
    """A ramp of force ends at its force to the last bit or the next; a dead load of that force goes on."""
    rubber = Material(1.5e6, 0.5, (Branch(3e6, 0.1), Branch(6e6, 3e-3)))
    steps = ForceRamp(-1.9e-3, 5e-3), Force(-1.9e-3 - jump, 1e8)
    question = Scene(rubber, Sphere(3e-3), Loading("relaxed", 3e-5, steps), Adhesion(0.08, 3e-7))
    trace = solve(question, Options(resolution=4))
    assert trace.outcome.kind == "detached"
    assert_allclose(trace.time[-1], 112.124, rtol=3e-3)  # by front tracking
    assert len(trace) < 400


def test_a_chord_is_missed_by_no_more_than_roundings():
    """Also where the load varies by a few of them only; more than that is a departure."""
    last_place = math.ulp(1.9e-3)
    values = {0: lambda t: 1.9e-3 + round(t) * last_place, 40: lambda t: 1.9e-3 + 160.0 * t * t * last_place}
    for least, value in values.items():
        interval = LoadingInterval("force", 0.0, 1.0, value, lambda _: 0.0, jump=False, after_kink=True)
        departure = departure_from_chord(interval, 0.0, 1.0) * span(interval) / last_place
        assert (departure == 0.0) if not least else (30.0 < departure < 40.0)


@pytest.mark.parametrize(("rate", "most", "evaluations"), [(0.002, 8, 330), (0.02, 5, 250)])
def test_a_limit_point_takes_few_trials(rate, most, evaluations):
    """A step that fails tells how far it is; halved time and again, steps failed twice as often.

    Nor does the edge turn round before it: what coarsening the history changes of the closure stood between
    the stable and the unstable edge, and five more steps went to and fro.
    """
    trace = bem(cycle(rate), resolution=4)
    assert trace.outcome.kind == "detached"
    assert 0 < trace.counters.rejected_steps <= most
    assert trace.counters.closure_evaluations <= evaluations
    assert (np.diff(trace.contact_radius[-10:]) < 0.0).all()


def test_an_advancing_edge_passes_twice_as_far():
    """Where nothing but the travel limit keeps steps short."""
    trace = bem(cycle(0.02), resolution=6)
    top = int(np.argmax(trace.penetration))
    travels = np.abs(np.diff(trace.contact_radius)) / ZONE
    assert 0.5 < travels[:top].max() <= 4.0 / 6.0 + 1e-9
    assert 0.25 < travels[top:].max() <= 2.0 / 6.0 + 1e-9


def test_a_closing_edge_knows_no_rate():
    """Its steps are those without the law, which concerns opening edges."""
    counters, forces = [], []
    for rate in (None, PowerRate(0.01, 0.4)):
        sticky = Adhesion(WORK, ZONE, work_closing=0.6 * WORK, rate=rate)
        asked = scene(Ramp(0.035, 0.01), Hold(2.0), start="relaxed", at=0.02, adhesion=sticky)
        asked = replace(asked, loading=replace(asked.loading, machine=Machine(0.8)))
        trace = solve(asked, Options(resolution=4))
        counters.append(trace.counters)
        forces.append(trace.force)
    assert counters[0] == counters[1]
    assert np.array_equal(*forces)


@pytest.mark.slow
@pytest.mark.parametrize("resolution", [8, pytest.param(12, marks=pytest.mark.exhaustive)])
def test_a_penetration_that_turns_within_the_first_step_after_a_corner_of_the_force(resolution):
    """It creeps on while the force falls, and would be back at the end of a long step: no change is seen."""
    moduli = (3.5, 1.8, 0.9, 0.45, 0.22, 0.11)
    branches = tuple(Branch(5.6e5 * moduli[k], 0.02 * 10.0**k) for k in range(6))
    steps = ForceRamp(to=0.02, rate=0.002), ForceRamp(to=0.018, rate=0.002)
    scene = Scene(Material(5.6e5, 0.5, branches), Sphere(1e-3), Loading("relaxed", 0.0, steps))
    deepest = bem(scene, resolution=resolution).penetration.max()
    assert deepest == pytest.approx(solver("reference").solve(scene).penetration.max(), rel=3e-4)


def test_a_row_a_hair_before_the_last_tells_nothing_of_a_long_step():
    steps = AcceptedSteps()
    for parameter in (0.0, 0.3, 0.5, 0.5001):
        steps.add(AcceptedRow(parameter, 1.0, 0.0))
    assert steps.earlier(1e-5).parameter == 0.5
    assert steps.earlier(0.1).parameter == 0.3
    assert steps.earlier(2.0).parameter == 0.0


@pytest.mark.parametrize("way", [1e-2, 1e-4, 1e-6, 1e-9])
def test_a_limit_point_nearer_than_the_least_travel_shortens_no_step_further(way):
    """Three rows cannot place it closer; a fast start was stepped on by less than it is known."""
    steps = AcceptedSteps(least=1e-3)
    for distance in (way + 0.03, way + 0.02, way + 0.01, way):  # the parameter is a parabola of the edge
        steps.add(AcceptedRow(-(distance**2), 1.0 - distance, 0.0))
    assert_allclose(steps.way_to_limit_point(), way, rtol=1e-6)
    until = max(way, steps.least) ** 2
    share = 2.0 if way < steps.least else 1.0 - (1.0 - SHARE_OF_WAY) ** 2
    assert_allclose(steps.step_of_travel(0.1), share * until, rtol=1e-6)
