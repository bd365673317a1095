"""Steps as long as a branch needs, and steps within which the energy release of the tip jumps."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support.bem_runs import bem, front
from support.paper_scenes import ONE, cycle, scene

from bem_solver import Options, load_control, solve
from bem_solver.annuli import Annuli
from bem_solver.creep import Chain
from bem_solver.energy import Energies, updated_energies
from bem_solver.history import SurfaceHistory
from bem_solver.motion import Motion
from bem_solver.nodal_variables import NodalVariables
from bem_solver.surface import ContactSurface
from bem_solver.tip_release import energy_of_tip, tip_release
from bem_solver.work_increment import WorkIncrement
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


@pytest.mark.parametrize("y", [1e-9, 0.05, 0.4, 0.98])
def test_energies_of_a_load_that_changes_evenly_are_exact(y):
    """One surface point: ``Y = v^2``, ``X = v e``, ``W = e^2``; heat ``int l^2/(J theta) dt``."""
    chain = Chain(ONE)
    (compliance,), (time,) = chain.compliances, chain.retardation
    load, new_load, lag = 1.0, 1.7, 0.6 * compliance

    def lag_at(s):
        rise = compliance * (new_load - load) * -np.expm1(-y * s) / y
        return lag * np.exp(-y * s) + rise

    strain, new_lag = compliance * load - lag, lag_at(1.0)
    new_strain = compliance * new_load - new_lag
    before = Energies(load**2, np.array([load * strain]), np.array([strain**2]), 0.0)
    increment = WorkIncrement(
        new_load**2, np.array([new_load * new_strain]), load * new_load, np.array([new_load * lag]), 0.0
    )
    after = updated_energies(chain, before, increment, y * time)
    heat = y * quad(lambda s: lag_at(s) ** 2, 0.0, 1.0, epsabs=0.0, epsrel=1e-12)[0] / compliance
    assert_allclose(after.branch_energy, [new_strain**2], rtol=1e-12)
    assert_allclose(after.dissipated, heat, rtol=1e-6 if y < 1e-6 else 1e-11)


def test_release_of_the_tip_jumps_where_the_edge_has_rested():
    """A trapezoid on either side of a kink only; without one the trapezoid itself."""
    area = np.pi * (0.9**2 - 1.0)

    def energy(edge, new_edge, *kinks, before=(3.0, 5.0)):
        return energy_of_tip(before, (1.0, 7.0), Motion(1.0, edge, new_edge, 0.0, 0.0), kinks)

    assert_allclose(energy(1.0, 0.9), 2.0 * area)
    assert_allclose(energy(1.0, 0.9, 1.2, 0.5), 2.0 * area)
    assert_allclose(energy(1.0, 0.9, 1.0), 1.0 * area)
    passed = np.pi * (0.97**2 - 1.0)
    assert_allclose(energy(1.0, 0.9, 0.93, 0.97), 3.0 * passed + (area - passed))
    assert_allclose(energy(0.9, 1.0, 1.0), -5.0 * area)
    assert np.isnan(energy(1.0, 0.9, before=None))


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
    monkeypatch.setattr(load_control, "parabola_bend", lambda *a: 0.0)
    straight = solve(question, Options(8)).external_work[-1]
    assert abs(straight / expected - 1.0) > 1.2e-4


def history_beyond(edge, places, root):
    """A surface outside an edge, displaced by ``root sqrt(r - b)`` beyond it and each of some places."""
    chain, kinks = Chain(ONE), np.array([edge, *places])
    fine, coarse = np.linspace(0.0, 0.05, 5) ** 2, np.linspace(0.0, 3.0, 61) ** 2
    radius = np.unique(np.concatenate([edge + coarse, *(place + fine for place in places)]))
    strains = root * np.sqrt(np.maximum(radius[:, None] - kinks, 0.0)).sum(axis=1)[:, None] / chain.lag_scale
    outer = NodalVariables(radius, strains, tuple(kinks.tolist()))
    return SurfaceHistory(NodalVariables(radius[:1], strains[:1]), outer)


@pytest.mark.parametrize("ahead", [(), (0.1,), (0.3,), (0.3, 1.5), (3.0,)])
def test_release_of_the_tip_is_read_beside_the_roots_of_places_of_rest(ahead):
    """``g = sqrt(d) + 0.1 d^(3/2) + 10 sqrt(d - ahead)``: the tip has the first."""
    chain, distances, edge = Chain(ONE), np.array([1.0, 2.0]), 5.0
    surface = replace(ContactSurface.free(Annuli(8)), edge=edge)
    history = history_beyond(edge, [edge + place for place in ahead], 10.0)
    gap = np.sqrt(distances) + 0.1 * distances**1.5
    gap += sum(10.0 * np.sqrt(np.maximum(distances - place, 0.0)) for place in ahead)
    closing = tip_release(chain, surface, gap, distances, history)[1]
    assert_allclose(closing, chain.glassy * np.pi / 16.0, rtol=2e-3)


def test_a_place_of_rest_long_left_takes_nothing_from_the_release_of_the_tip():
    """Its root has faded, and the gap still bends: a root fitted to that made the release half as large."""
    chain, distances, edge = Chain(ONE), np.array([1.0, 2.0]), 5.0
    surface = replace(ContactSurface.free(Annuli(8)), edge=edge)
    history = history_beyond(edge, [edge + 0.3], 0.0)
    gap = np.sqrt(distances) + 0.1 * distances**1.5
    closing = tip_release(chain, surface, gap, distances, history)[1]
    assert_allclose(closing, chain.glassy * np.pi / 16.0, rtol=1e-12)


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
    assert_allclose(heat[-1], front(question, 12).extra["branch_dissipation"][-1], rtol=0.025)


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
