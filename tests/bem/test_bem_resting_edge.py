"""An edge that rests or nearly rests: it neither freezes nor jitters, whatever the step or the resolution.

Errors are relative to what the radius does in the run, not to the radius.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem, front
from support.paper_scenes import ZONE, scene

from bem_solver import Options, solve
from bem_solver.equilibrium import rising_root
from bem_solver.problem import closure_of_departure
from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    FlatPunch,
    Hold,
    Loading,
    Machine,
    Material,
    Oscillate,
    PowerLaw,
    Ramp,
    RateTable,
    Scene,
    Sphere,
    Sweep,
)
from validation.measure.curves import distance, interpolation_error


@dataclass(frozen=True)
class Trial:
    residual: float


def test_root_beyond_a_vertical_tangent():
    """A slope known from next to the tangent is no reason to stay there."""
    accuracy = 1e-3

    def trial(x):
        return Trial(np.copysign(abs(x) ** 0.5, x) - 0.05**0.5)

    for slope in (0.0, 1.0, accuracy**-0.5):
        for guess in (0.0, 1e-12, 1e-4, 0.04):
            found = rising_root(trial, guess, slope, -1.0, 1.0, accuracy)
            assert found.position == "converged"
            assert abs(found.x - 0.05) <= accuracy
            assert found.slope <= accuracy**-0.5  # over the accuracy, it cannot be steeper


def test_no_root_is_met_by_a_slope_alone():
    """By one that is far too steep every guess would be the root; nor is it handed on as measured."""
    found = rising_root(lambda x: Trial(x - 0.3), 0.1, 1e17, -1.0, 1.0, 1e-3, 1e-3)
    assert found.position == "converged"
    assert abs(found.x - 0.3) <= 1e-3
    assert_allclose(found.slope, 1.0, rtol=1e-6)
    assert rising_root(lambda x: Trial(x - 0.3), 0.3, 1e17, -1.0, 1.0, 1e-3, 1e-3).slope == 0.0


@pytest.mark.parametrize("resolution", [4, 8])
@pytest.mark.parametrize("time", [1e-2, 1e-4])
def test_edge_rests_in_a_hold_and_follows_a_ramp(time, resolution):
    """Ting: without adhesion the radius is ``sqrt(R D)``, as long as the penetration does not fall."""
    rubber = Material(0.75, 0.5, (Branch(6.75, time),))
    trace = bem(
        scene(Hold(1.0), Ramp(0.02, 0.01), at=0.01, adhesion=None, material=rubber), resolution=resolution
    )
    travel = np.ptp(np.sqrt(trace.penetration))
    holding = trace.time <= 1.0
    assert_allclose(trace.contact_radius[holding], 0.1, atol=0.016 / resolution * travel)
    assert_allclose(trace.contact_radius[-1], np.sqrt(0.02), atol=0.01 * travel)


SMALL = Scene(
    Material(1e6, 0.49, (Branch(3e6, 0.01), Branch(1e6, 1.0))),
    Sphere(1e-3),
    Loading("relaxed", 2e-6, (Oscillate(1e-6, 62.8, 1.0),)),
    Adhesion(0.05, 1e-6),
)
ENDS = tuple(2.0 * np.pi / 62.8 * k for k in range(1, 10))


def oscillating(duration):
    """The small oscillation, and the times at which its cycles end."""
    steps = (Oscillate(1e-6, 62.8, duration),)
    return Scene(SMALL.material, SMALL.indenter, Loading("relaxed", 2e-6, steps), SMALL.adhesion), tuple(
        t for t in ENDS if t < duration
    )


@pytest.mark.parametrize(
    ("resolution", "duration", "share"),
    [
        pytest.param(5, 0.32, 0.02, marks=pytest.mark.slow),
        pytest.param(8, 1.0, 0.02, marks=pytest.mark.exhaustive),
        pytest.param(12, 1.0, 0.01, marks=pytest.mark.exhaustive),
    ],
)
def test_small_oscillation_with_stops_at_the_ends_of_cycles(resolution, duration, share):
    question, stops = oscillating(duration)
    exact = front(question, 6)
    for times in ((), stops):
        trace = bem(question, resolution=resolution, stop_times=times)
        error = np.abs(trace.contact_radius - np.interp(trace.time, exact.time, exact.contact_radius))
        assert error.max() < share * np.ptp(exact.contact_radius)
        moves = np.diff(trace.contact_radius)
        still = np.flatnonzero(moves == 0.0)  # one row at most, and only where the edge turns
        assert np.all(moves[still - 1] * moves[still + 1] < 0.0)


@pytest.mark.parametrize(
    "stop", [5.326e-4, *(pytest.param(stop, marks=pytest.mark.slow) for stop in (5.323e-4, 5.329e-4))]
)
def test_an_edge_that_a_row_leaves_just_beyond_its_old_place_recedes_past_it(stop):
    # the place where it has relaxed is nearer to the edge there than the annuli resolve
    question = Scene(
        Material(142000.0, 0.49, [Branch(2499200.0, 0.0065703)]),
        PowerLaw(4.29, 27516787309.97498),
        Loading(
            "relaxed",
            0.00012829486574999997,
            [Sweep(amplitude=3.429394175e-07, chirp=21829264.41359641, duration=6.6e-4)],
        ),
        Adhesion(0.04327379005692223, 4.307295e-5),
    )
    radius = bem(question, resolution=6, stop_times=(stop,)).contact_radius
    exact = front(question, 10).contact_radius
    assert abs(radius[-1] - exact[-1]) < 0.02 * np.ptp(exact)
    assert radius.max() < exact.max() + 0.05 * np.ptp(exact)


@pytest.mark.parametrize(("depth", "way"), [(0.0, -1.0), (0.05, 1.0)])
def test_a_row_lies_where_the_zone_has_left_the_place_of_rest(depth, way):
    """The speed of the edge jumps there: to fifteen times what it was, after a quick pull."""
    start = 0.03 if way < 0.0 else 0.01
    trace = bem(scene(Ramp(depth, 10.0), start="relaxed", at=start), resolution=4)
    travel = way * (trace.contact_radius - trace.contact_radius[0]) / ZONE
    assert np.abs(travel - 1.0).min() < 2e-4


def test_an_edge_does_not_turn_where_the_residual_hardly_rises():
    """In a slow retraction the residual is nearly flat before the least stage: no false root beyond."""
    rubber = Material(0.75e6, 0.5, (Branch(2.25e6, 1.0),))
    loading = Loading("relaxed", 2e-5, (Ramp(-1e-4, 1e-12),), Machine(150.0))
    question = Scene(rubber, Sphere(1e-3), loading, Adhesion(0.5, 1.3e-5))
    radius = bem(question, resolution=4).contact_radius
    assert np.diff(radius).max() < 1e-6 * 1.3e-5


def pressed_after_rest(zone: float) -> Scene:
    """At rest near zero force, then pressed."""
    moduli, times = (1.138, 0.242, 0.0671, 0.684, 0.356, 0.00435), (17.2, 5.22, 1.14, 9.51, 0.527, 0.0132)
    material = Material(1.0, 0.0, tuple(map(Branch, moduli, times)))
    steps = (Hold(0.96827786), Ramp(0.02204, 0.55))
    return Scene(
        material, PowerLaw(1.463, 0.2107), Loading("relaxed", 0.00884, steps), Adhesion(1.69e-4, zone)
    )


@pytest.mark.parametrize(
    "resolution",
    [12, pytest.param(13, marks=pytest.mark.slow), pytest.param(24, marks=pytest.mark.exhaustive)],
)
def test_press_after_rest_near_zero_force(resolution: int):
    """Set off a hair beyond the place of rest: the root was read on that hair, steps rejected without end.

    In the rest the edge found a false root within the outermost annulus, at some resolutions.
    """
    question = pressed_after_rest(0.0382)
    trace = bem(question, resolution=resolution)
    assert trace.outcome.kind == "completed"
    assert trace.counters.rejected_steps < 20
    assert np.ptp(trace.contact_radius[trace.time < 0.968]) < 1e-5 * 0.0382
    at_once = bem(
        replace(question, loading=replace(question.loading, steps=question.loading.steps[1:])),
        resolution=resolution,
    )
    assert_allclose(trace.contact_radius[-1], at_once.contact_radius[-1], rtol=1e-4)
    assert_allclose(trace.force[-1], at_once.force[-1], rtol=5e-4)


@pytest.mark.parametrize("resolution", [6, pytest.param(10, marks=pytest.mark.slow)])
def test_press_after_rest_over_short_zones(resolution: int):
    """Set off fast, the closure hardly changes over a zone: 600 to 1000 steps followed its unevenness."""
    trace = solve(pressed_after_rest(1e-5), Options(resolution, max_steps=150))
    assert trace.outcome.kind == "completed"
    assert_allclose(trace.contact_radius[-1], 0.175124396, rtol=1e-4)  # by front tracking


@pytest.mark.parametrize(
    "tolerance",
    [pytest.param(5.6e-4, marks=pytest.mark.slow), pytest.param(2.8e-4, marks=pytest.mark.exhaustive)],
)
def test_turn_over_an_annulus(tolerance: float):
    """An edge that turns back over an annulus at once takes the load along: no shorter step mends that.

    It closes slowly, and what it has covered last is stiff within less than an annulus: at the turn that
    opens at fixed time. With a close tolerance the run ended there, or tried steps for ever.
    """
    material = Material(1.0, 0.0, (Branch(3.48, 0.00214),))
    adhesion = Adhesion(4.483889e-3, 0.0153136)
    question = Scene(
        material, Cone(74.784), Loading("jump-in", 0.01590656, (Ramp(0.01396, 3.8674e-3),)), adhesion
    )
    trace = bem(question, resolution=12, tolerance=tolerance, max_steps=1000)
    assert trace.outcome.kind == "completed"
    assert trace.contact_radius.max() > trace.contact_radius[-1] + 1.5e-3  # it has turned (1.8e-3)
    usual = bem(question, resolution=12)
    assert_allclose(trace.contact_radius[-1], usual.contact_radius[-1], atol=1e-4)


def test_an_edge_sets_off_at_what_its_way_takes_up():
    """Between the two it rests; at fixed time the most that opening can take up counts."""
    sticky = Adhesion(2.0, 0.1, work_closing=1.0, rate=RateTable((0.01, 1.0), (3.0, 4.0)))
    assert closure_of_departure(sticky, 1.5, at_once=False) is None
    assert closure_of_departure(sticky, 0.9, at_once=False) == 1.0
    assert closure_of_departure(sticky, 2.1, at_once=False) == 2.0
    most = sticky.opening(np.inf)
    assert closure_of_departure(sticky, 2.1, at_once=True) is None
    assert closure_of_departure(sticky, 1.1 * most, at_once=True) == most


def test_a_creeping_edge_that_is_pressed_on_sets_out_on_a_row():
    """It opens slowly, by a law of its speed, closes as fast as it is pressed: a corner of the force.

    Cubics across it made the work of two cycles 8 % too large.
    """
    law = RateTable((0.017143, 1.7143), (0.010011, 0.045994))
    question = Scene(
        Material(1.0, 0.45, (Branch(0.146, 0.151),)),
        Cone(73.9336),
        Loading("relaxed", 0.077055, (Oscillate(3.90666e-4, 97.4, 4.0 * np.pi / 97.4),)),
        Adhesion(0.0057207, 0.0153792, rate=law),
    )
    expected = front(question, 12).external_work[-1]
    assert_allclose(bem(question, resolution=8).external_work[-1], expected, rtol=0.015)


def test_an_edge_that_closes_is_not_stopped_for_nothing():
    """Opening takes up 0.2 % more than closing: less than the closure of an edge that closes may be off.

    Every third step ended at once, at rest; the heat of the branches was 1.3 % off.
    """
    question = Scene(
        Material(5270.0, 0.5, (Branch(12700.7, 1.3398e-05),)),
        Sphere(8.67e-05),
        Loading("relaxed", 4.99785e-07, (Oscillate(3.79064e-08, 1280.52, 0.0049),)),
        Adhesion(2.644495e-05, 7.826409e-07, work_closing=2.639206e-05),
    )
    mine = bem(question)
    moved = np.diff(mine.contact_radius)
    assert not np.any((moved[1:-1] == 0.0) & (moved[:-2] > 0.0) & (moved[2:] > 0.0))
    expected = front(question, 12).extra["branch_dissipation"][-1]
    assert_allclose(mine.extra["branch_dissipation"][-1], expected, rtol=0.005)


def test_the_force_on_a_punch_is_straight_up_to_where_its_edge_sets_off():
    """One step of half a second, and steps of a ten-thousandth of that from there on.

    Read from the rows, the force was 4 % off in the long step, and its estimate told half a per cent.
    """
    question = Scene(
        Material(1.0, 0.45, (Branch(0.13, 4e-5),)),
        FlatPunch(1.0),
        Loading("relaxed", 0.0526, (Ramp(-0.0636, 0.0516),)),
        Adhesion(7.4e-6, 0.0265),
    )
    mine, other = bem(question, resolution=6), front(question, 12)
    apart = distance(mine, other)
    assert np.diff(mine.time).max() > 0.1 * mine.time[-1]
    assert apart.rms < 2e-4
    assert apart.rms < interpolation_error(mine, "force") + 1e-4


@pytest.mark.slow
def test_an_edge_that_has_rested_goes_on_the_way_it_came():
    """Pinned on its way in, at 19.035 um: what it leaves there held it up for 0.3 s of the pull (0.8 %)."""
    moduli = 1703.03283, 907.1687055, 446.5090192, 1272.192368, 246.8682674
    times = 24.22736176, 341.9908576, 776.3444754, 1121.225633, 3188.202053
    material = Material(2870.88959, 0.0, tuple(map(Branch, moduli, times)))
    adhesion = Adhesion(9.22285951e-4, 1.334073273e-8, work_closing=7.148766825e-5)
    steps = (
        Ramp(2.029055507e-6, 4.75598653e-9),
        Ramp(3.469031454e-6, 1.321920815e-7),
        Oscillate(-1.4226517065e-6, 0.04066225088643834, 618.0853415839949),
        Ramp(-5.315e-5, 1.0191767e-7),
    )
    trace = bem(
        Scene(material, Sphere(7.979497651e-5), Loading("snap-in", 0.0, steps), adhesion), resolution=6
    )
    assert_allclose(-trace.force.min(), 6.234568e-7, rtol=2e-4)  # by front tracking
