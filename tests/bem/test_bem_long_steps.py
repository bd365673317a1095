"""Steps as long as a branch needs, and steps within which the energy release of the tip jumps."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem, front
from support.paper_scenes import ONE, cycle, scene

from bem_solver import Options, solve, trial
from bem_solver.creep import Chain
from bem_solver.recorder import tip_energy
from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    FlatPunch,
    Force,
    Hold,
    Loading,
    Material,
    Oscillate,
    Ramp,
    Scene,
)


def test_release_of_the_tip_jumps_where_the_edge_has_rested():
    """A trapezoid where the edge goes on; the release beyond a place of rest counts from there on only."""

    def energy(*radius):
        return tip_energy(np.array(radius), np.arange(1.0, len(radius) + 1.0)) / np.pi

    down = 0.9**2 - 1.0
    assert_allclose(energy(1.1, 1.0, 0.9), [2.0 * (1.0 - 1.1**2), 2.5 * down])
    assert_allclose(energy(0.9, 1.0, 1.0, 0.9), [-2.0 * down, 0.0, 4.0 * down])
    assert_allclose(energy(1.0, 0.95, 0.99, 1.05)[2], 3.0 * (1.0 - 0.99**2) + 4.0 * (1.05**2 - 1.0))


@pytest.mark.parametrize(
    ("resolution", "within"),
    [
        pytest.param(6, 0.025, marks=pytest.mark.exhaustive),
        pytest.param(8, 0.02, marks=pytest.mark.exhaustive),
        (9, 0.02),  # a row on the place of rest, to the accuracy of the edge
        pytest.param(10, 0.0105, marks=pytest.mark.exhaustive),
        *(pytest.param(*row, marks=pytest.mark.slow) for row in ((12, 0.005), (16, 0.004))),
    ],
)
@pytest.mark.parametrize(
    ("steps", "most"),
    [
        pytest.param((0.036, 0.03), 0.005, id="opens last", marks=pytest.mark.slow),
        pytest.param((0.03, 0.036), 1.0, id="closes last"),
    ],
)
def test_heat_of_the_branches_of_an_edge_that_turns(steps, most, resolution, within):
    """The tip's release changes a hundredfold where the edge turns and where it passes its place of rest."""
    two = Material(0.75, 0.5, (Branch(2.0, 1e-3), Branch(9.0, 100.0)))
    question = scene(*(Ramp(to, 0.01) for to in steps), start="relaxed", at=0.032, material=two)
    mine, other = bem(question, resolution=resolution), front(question, 10)
    expected = other.extra["branch_dissipation"][-1]
    assert_allclose(mine.extra["branch_dissipation"][-1], expected, rtol=min(within, most))


@pytest.mark.slow
def test_load_ahead_of_an_edge_that_turns_bends_within_a_step(monkeypatch):
    """The edge stays within 0.04 zones for a fifth of the approach; the loss tells what it set off from."""
    question = cycle(0.002)
    expected = front(question, 16).external_work[-1]
    assert_allclose(bem(question, resolution=8).external_work[-1], expected, rtol=3e-5)
    monkeypatch.setattr(trial, "parabola_bend", lambda *a: 0.0)
    straight = solve(question, Options(8)).external_work[-1]
    assert abs(straight / expected - 1.0) > 1.2e-4


@pytest.mark.slow
def test_branches_only_lose_where_an_edge_swings_over_its_old_turns():
    """Cycles within a quarter of a zone, steps ten times as long as the fastest branch needs.

    Where the edge turned, the heat of a step fell by 0.5 % of the whole, and over all it was 7 % short.
    """
    rubber = Material(1.0, 0.5, (Branch(0.866, 1.44), Branch(7.86, 0.0221)))
    loading = Loading("relaxed", 0.029258544, (Oscillate(7.3258719872e-4, 0.623, 33.58428),))
    question = Scene(rubber, Cone(78.0305), loading, Adhesion(5.7625e-4, 9.6672e-3))
    heat = bem(question).extra["branch_dissipation"]
    assert np.diff(heat).min() > -1e-4 * heat[-1]
    assert_allclose(heat[-1], front(question, 12).extra["branch_dissipation"][-1], rtol=0.01)


def test_the_first_step_of_a_glassy_contact_follows_its_force():
    """A shorter step takes the edge farther here, and not because it passes an annulus at once."""
    rubber, loading = Material(1.0, 0.0, (Branch(9.18, 1.0),)), Loading("jump-in", 0.25, (Hold(2000.0),))
    question = Scene(rubber, Cone(74.36), loading, Adhesion(0.002576, 0.144))
    trace = bem(question, resolution=6)
    assert trace.force[0] > 1.4
    assert np.abs(np.diff(trace.force)).max() < 0.2 * trace.force[0]
    expected = front(question, 6).extra["branch_dissipation"][-1]
    assert_allclose(trace.extra["branch_dissipation"][-1], expected, rtol=0.01)


def test_a_punch_creeps_under_a_dead_load():
    """``D = F J(t)/(2 a)`` in steps as long as the creep bends; straight from row to row it was 0.9 % off."""
    load = 2.0 * 0.2 * 0.03  # relaxed, penetration 0.03
    question = scene(
        Force(load, 50.0), start="relaxed", at=0.01, indenter=FlatPunch(0.2), adhesion=None, material=ONE
    )
    trace, chain = bem(question, resolution=6), Chain(ONE)
    creep = 1.0 - (1.0 - chain.relaxed / chain.glassy) * np.exp(-trace.time / chain.retardation[0])
    late = trace.time > 0.0
    exact = 0.01 + 0.02 * creep
    assert np.diff(trace.time).max() > 0.2 * chain.retardation[0]
    assert_allclose(trace.penetration[late], exact[late], rtol=4e-3)
