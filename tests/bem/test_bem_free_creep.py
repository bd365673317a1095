"""Steps whose edge has not receded: what it meets does not depend on the way, nor on how long they are."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.bem_runs import bem, front
from support.paper_scenes import cycle

from bem_solver import Options, solve, trial
from bem_solver.creep import Chain
from bem_solver.motion import CarriedDisplacement
from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Material,
    Oscillate,
    PowerLaw,
    PowerRate,
    Ramp,
    Scene,
    Sphere,
)

THREE = (Branch(0.47, 0.281), Branch(15.8, 0.0409), Branch(0.833, 62.1))
SLOW = Scene(
    Material(1.0, 0.5, (Branch(15.8, 0.041),)),
    Sphere(1.0),
    Loading("jump-in", 0.0025645, (Ramp(0.0030181, 2.268e-5),)),
    Adhesion(1.5127e-5, 3.2766e-7),
)


def outside_paraboloid(radius, edge, penetration):
    """Displacement outside, of unit curvature and any modulus: Sneddon, with a free penetration."""
    angle = np.arcsin(edge / radius)
    bent = 0.5 * radius**2 * angle - 0.5 * edge * np.sqrt(radius**2 - edge**2)
    return (2.0 / np.pi) * (penetration * angle - bent)


@pytest.mark.slow
@pytest.mark.parametrize(
    "branches",
    [THREE, pytest.param((Branch(3.0, 20.0), Branch(2.0, 1e-3)), marks=pytest.mark.exhaustive)],
)
def test_displacement_outside_an_edge_that_never_receded_is_elastic(branches):
    """Whatever the material and the way: no pressure has been there (Lee and Radok)."""
    steps = (Ramp(0.0026781, 2.268e-5), Hold(0.5), Ramp(0.0028, 1e-3))
    loading = Loading("jump-in", 0.0025645, steps)
    scene = replace(SLOW, material=replace(SLOW.material, branches=branches), loading=loading)
    trace = bem(scene, profile_times=(2.5, 5.0, 5.4, 5.6), resolution=4)
    for profile in trace.profiles:
        edge, depth = (
            np.interp(profile.time, trace.time, c) for c in (trace.contact_radius, trace.penetration)
        )
        outside = profile.radius > edge + SLOW.adhesion.zone
        exact = outside_paraboloid(profile.radius[outside], edge, depth)
        assert outside.sum() > 20
        assert_allclose(profile.displacement[outside], exact, atol=5e-5 * depth)


@pytest.mark.slow
def test_an_edge_that_closes_slowly_moves_evenly_in_long_steps():
    """With a gap that depends on the assumed path its speed swung by a tenth, and no step grew longer."""
    trace = bem(SLOW)
    later = trace.time > 0.3 * trace.time[-1]
    time, radius = trace.time[later], trace.contact_radius[later]
    speed = np.diff(radius) / np.diff(time)
    assert np.abs(np.diff(speed) / speed[1:]).max() < 0.1
    assert np.median(np.diff(time)) > 20.0 * 0.041
    assert 4 < len(speed) < 30


@pytest.mark.slow
def test_a_stiff_glass_closes_in_long_steps():
    """Of 121 times the relaxed modulus: errors of the strains ahead came back magnified."""
    material = replace(SLOW.material, branches=(Branch(120.0, 0.01),))
    assert bem(replace(SLOW, material=material)).counters.steps < 200


@pytest.mark.slow
def test_what_an_edge_carries_along_counts(monkeypatch):
    """Work of a press, by front tracking; and as if the displacement ahead had changed evenly."""
    press = Loading("jump-in", 0.0025645, (Ramp(0.0040, 1e-3),))
    scene = replace(SLOW, material=replace(SLOW.material, branches=THREE), loading=press)
    exact = front(scene).external_work[-1]
    assert_allclose(solve(scene, Options(6)).external_work[-1], exact, rtol=3e-4)
    monkeypatch.setattr(
        CarriedDisplacement, "stresses", lambda self, chain, duration, radius, end: np.zeros((len(radius), 3))
    )
    assert abs(solve(scene, Options(6)).external_work[-1] / exact - 1.0) > 1e-3


@pytest.mark.exhaustive
def test_strains_that_do_not_follow_the_displacement_are_seen(monkeypatch):
    assert solve(SLOW, Options(6)).counters.steps < 100
    monkeypatch.setattr(trial.FreeCreep, "settled", lambda self, points, variables, load: variables)
    assert solve(SLOW, Options(6)).counters.steps > 300


@pytest.mark.parametrize("gained", [(0.0, 0.0), (0.3, -0.2)])
@pytest.mark.parametrize("time", [0.0, 1e-4, 2e-3, 0.3, 20.0, 1e4])
def test_moduli_behind_an_edge(time, gained):
    """Strain ``f(x)`` at distance x behind an edge of unit speed: ``E(t) f(0) + int E(t - t') df(t')``.

    By parts, because an inverse root begins infinite. Its strength may have grown since the passage.
    """
    material = Material(1.0, 0.5, THREE)
    chain, plane = Chain(material), 1.0 - 0.5**2
    exact = []
    for power, growth in zip((-0.5, 0.5), gained, strict=True):
        # x = time * u^2 since the passage, against f at the end
        def lost(u, branch, power=power, growth=growth):
            strength = 1.0 - growth * (1.0 - u**2)
            return np.exp(-time / branch.time * (1.0 - u**2)) * 2.0 * u ** (2.0 * power + 1.0) * strength

        relaxed = [b.modulus * time / b.time * quad(lost, 0.0, 1.0, args=(b,))[0] for b in THREE]
        exact.append((material.glassy_modulus - sum(relaxed)) / plane if time < 1e3 else 1.0 / plane)
    moduli = chain.moduli_of_passage(np.array([time]), tuple(np.array([g]) for g in gained))
    assert_allclose(np.ravel(moduli), exact, rtol=1e-6 if time < 1e3 else 2e-2)


SWINGS = Scene(
    Material(1.0, 0.5, THREE),
    Cone(85.0),
    Loading("jump-in", 0.0055, (Oscillate(0.002, 0.02, 600.0),)),
    Adhesion(1.5e-5, 5.5e-7),
)


@pytest.mark.exhaustive
def test_slow_swings_over_what_an_edge_has_left():
    """A cone, zone 1e-5 of its radius; at the end by front tracking. What was left behind creeps on."""
    trace = bem(SWINGS)
    assert_allclose(trace.contact_radius[-1], 0.05871796, atol=8e-6)
    assert trace.counters.steps < 550


@pytest.mark.exhaustive
def test_what_was_left_behind_as_if_it_crept_evenly_is_seen(monkeypatch):
    monkeypatch.setattr(
        trial,
        "_crept",
        lambda chain, points, motion: chain.to_strains(points.variables, points.load) @ chain.lag_scale,
    )
    assert abs(solve(SWINGS).contact_radius[-1] - 0.05871796) > 2e-5


CYCLE_TIMES = np.array([50.0, 300.0, 800.0, 1600.0, 3800.0])
HEAT = np.array([9.588278e-5, 2.1356572e-4, 3.8385023e-4, 6.4459458e-4, 7.3233542e-4])
WORK = 4.01125e-5
"""Of a cycle over long zones, which passes them in long steps: heat of the branches at these times, and the
work at the end, by front tracking."""


def slow_cycle():
    """Its heat in parts of the last one, and its work, both less those of front tracking."""
    trace = solve(cycle(2e-5))
    heat = np.interp(CYCLE_TIMES, trace.time, trace.extra["branch_dissipation"])
    return (heat - HEAT) / HEAT[-1], trace.external_work[-1] / WORK - 1.0


@pytest.mark.slow
def test_heat_and_work_of_a_slow_cycle_in_long_steps():
    """All the way: at the end alone errors of either sign cancel."""
    heat, work = slow_cycle()
    assert np.abs(heat).max() < 6e-4
    assert abs(work) < 4e-5


@pytest.mark.exhaustive
def test_a_load_at_the_edge_of_the_surface_before_is_seen(monkeypatch):
    monkeypatch.setattr(trial, "_PASSES", 1)
    heat, _ = slow_cycle()
    assert np.abs(heat).max() > 7e-4


@pytest.mark.slow
def test_punch_sets_out_after_a_long_press_when_it_should():
    """Dead load after a hold of many relaxation times; by front tracking. The gap at rest was 3 % off."""
    branches = (Branch(13452.0, 0.03333), Branch(170805.0, 0.032934))
    scene = Scene(
        Material(29500.0, 0.3, branches),
        FlatPunch(0.00033734),
        Loading("jump-in", 2.637121716e-05, (Force(0.001505286, 2.1054), Force(-0.001228075, 1.8216))),
        Adhesion(0.00064768848, 6.173322e-10, work_closing=0.00021762333),
    )
    trace = bem(scene)
    assert trace.outcome.kind == "detached"
    assert_allclose(trace.time[-1], 2.264239, rtol=5e-5)


@pytest.mark.slow
def test_punch_under_a_law_of_rate_sets_out_at_once():
    """From the moment on at which the edge is driven: it took thousands of steps of 1e-12 s."""
    scene = Scene(
        Material(1.0, 0.5, (Branch(0.133, 1.03), Branch(9.05, 0.977))),
        FlatPunch(0.0371),
        Loading("relaxed", 0.00122913, (Ramp(0.00137641, 0.0041), Ramp(-0.0055, 0.00076))),
        Adhesion(1.31661e-07, 1.56933e-06, rate=PowerRate(0.2473, 1.22)),
    )
    trace = bem(scene, resolution=6)
    assert trace.counters.steps < 1200
    early = trace.contact_radius > 0.9 * 0.0371
    assert np.diff(trace.time[early])[1:].min() > 1e-10


@pytest.mark.slow
def test_first_step_after_a_kink_is_not_told_by_its_start():
    """Force reversed while the edge closes: its largest radius by front tracking. One step was 2e-4 off."""
    scene = Scene(
        Material(1.0, 0.5, (Branch(15.6, 0.011),)),
        PowerLaw(1.45, 0.4069293701841115),
        Loading("relaxed", 0.033956325, (ForceRamp(0.019773, 0.0397048), ForceRamp(0.012, 0.0825860))),
        Adhesion(7.175093e-06, 1.3182e-07),
    )
    assert_allclose(bem(scene).contact_radius.max(), 0.170501, rtol=3e-5)
