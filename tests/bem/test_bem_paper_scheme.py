"""The paper's own discretisation: its limits, its order, its work, and its refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.paper_scenes import ONE as RUBBER
from support.paper_scenes import PULL as JKR
from support.paper_scenes import WORK as GAMMA
from support.paper_scenes import cycle, scene

import bem_solver
from bem_solver import Options
from bem_solver.paper_scheme import LeadingBlocks
from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    OutcomeKind,
    PowerRate,
    Ramp,
    SceneError,
    Table,
    UnsupportedScene,
)
from validation.reference.creep_compliance import creep_compliance

TWO_BRANCHES = Material(0.75, 0.5, (Branch(2.0, 0.1), Branch(4.75, 1.0)))


def uniform(scene, resolution=12, scheme="backward-euler", progress=None, **more):
    options = Options(resolution=resolution, annuli="uniform", scheme=scheme, **more)
    return bem_solver.solve(scene, options, progress)


def test_elastic_pull_off():
    for modulus, exact in ((0.75, 1.02693), (7.5, 1.05837)):
        elastic = Material(modulus, 0.5)
        trace = uniform(scene(Ramp(-0.5, 0.01), start="relaxed", at=0.032, material=elastic), 24)
        assert -trace.force.min() / JKR == pytest.approx(exact, rel=1.2e-2)
        assert trace.outcome.kind is OutcomeKind.DETACHED
        assert [event.kind for event in trace.events] == ["pull-off"]


def test_relaxed_equilibrium():
    trace = uniform(scene(start="relaxed", at=0.032), 24)
    assert trace.contact_radius[0] == pytest.approx(0.245149, abs=0.013 / 24)
    assert trace.force[0] / np.pi == pytest.approx(1.8695e-3, rel=1e-2)


def test_a_single_large_step_lands_where_the_static_search_does():
    elastic = Material(0.75, 0.5)
    loaded = scene(Ramp(0.032, 1.0), start="relaxed", at=0.0, material=elastic)
    trace = uniform(loaded, step=1.0)
    at_once = uniform(scene(start="relaxed", at=0.032, material=elastic))
    assert len(trace) == 2
    assert trace.contact_radius[-1] == at_once.contact_radius[0]
    assert trace.force[-1] == pytest.approx(at_once.force[0], rel=1e-9)
    assert [event.kind for event in trace.events] == ["snap-in"]  # many annuli at once


@pytest.mark.parametrize(("scheme", "error"), [("backward-euler", 2e-3), ("exponential", 5e-5)])
def test_adhesionless_sphere_lee_radok_and_ting(scheme, error):
    times, radii = (0.5, 1.0, 1.2710490), (0.1581139, 0.2236068, 0.1795367)
    loads = scene(Ramp(0.05, 0.05), Ramp(-0.5, 0.05), adhesion=None)
    trace = uniform(loads, scheme=scheme, profile_times=times)
    assert [p.time for p in trace.profiles] == list(times)
    for profile, radius, force in zip(
        trace.profiles, radii, (0.04443517, 0.10786683, 0.03680143), strict=True
    ):
        assert profile.contact_radius == pytest.approx(radius, abs=0.2236068 / 120)
        assert profile.force == pytest.approx(force, rel=error)
        assert profile.pressure.min() >= 0.0
        assert profile.gap.min() >= -1e-12
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.time[-1] == pytest.approx(1.5420981, rel=5e-3)
    assert trace.force[-1] == trace.contact_radius[-1] == 0.0


def test_a_punch_creeps_under_constant_force():
    """``D = F J*(t)/(2 a)``; the exponential scheme is exact in time."""
    held = scene(Force(0.03, 5.0), start="relaxed", at=0.0, indenter=FlatPunch(0.2), adhesion=None)
    trace = uniform(held, scheme="exponential")
    held = trace.time > 0.0
    compliance = 0.75 * creep_compliance(RUBBER)(trace.time[held])
    assert np.all(trace.contact_radius[held] == 0.2)
    np.testing.assert_allclose(trace.force[held], 0.03, rtol=1e-11)
    np.testing.assert_allclose(trace.penetration[held], 0.03 * compliance / 0.4, rtol=2e-3)
    ratio = trace.penetration[held] / trace.penetration[held][-1]
    np.testing.assert_allclose(ratio, compliance / compliance[-1], rtol=1e-9)


@pytest.mark.parametrize("scheme", ["backward-euler", "exponential"])
def test_energies_of_a_relaxing_punch(scheme):
    loads = scene(Hold(20.0), at=0.01, indenter=FlatPunch(0.2), adhesion=None)
    trace = uniform(loads, scheme=scheme)
    # U = F D/2 in the glassy and in the relaxed state: 2 a E* D^2/2
    np.testing.assert_allclose(trace.stored_energy[[0, -1]], [0.2e-4 * 10, 0.2e-4], rtol=2e-3)
    np.testing.assert_allclose(trace.dissipated_energy[-1], 0.2e-4 * 9, rtol=2e-3)
    np.testing.assert_allclose(trace.extra["branch_dissipation"][-1], 0.2e-4 * 9, rtol=2e-2)
    assert np.all(np.diff(trace.extra["branch_dissipation"]) >= -1e-18)
    assert trace.extra["stress_intensity_factor"][0] == pytest.approx(-0.1 / np.sqrt(np.pi * 0.2), rel=1e-10)


def test_the_edge_of_a_punch_is_a_border():
    trace = uniform(scene(Ramp(-0.1, 0.01), start="relaxed", at=0.01, indenter=FlatPunch(0.2)))
    assert np.all(trace.contact_radius == 0.2)
    assert trace.outcome.kind is OutcomeKind.DETACHED


@pytest.mark.slow
def test_force_control_follows_the_force():
    steps = (ForceRamp(0.02, 0.01), Hold(1.0), ForceRamp(-0.1, 0.01))
    trace, default = uniform(scene(*steps), 6), bem_solver.solve(scene(*steps), Options(resolution=6))
    ramp = trace.time <= 2.0 + 0.5
    loaded = trace.force[ramp & (np.diff(trace.time, prepend=0.0) > 0.0)]
    assert np.ptp(np.diff(loaded[:100])) < 1e-12
    assert trace.outcome.kind is default.outcome.kind is OutcomeKind.DETACHED
    assert trace.force.min() == pytest.approx(default.force.min(), rel=2e-2)
    assert trace.penetration.max() == pytest.approx(default.penetration.max(), rel=1e-2)


def test_two_like_branches_are_one():
    twin = Material(0.75, 0.5, (Branch(3.0, 1.0), Branch(3.75, 1.0 + 1e-7)))
    steps = (Ramp(0.032, 0.1), Ramp(-0.5, 0.1))
    one, two = uniform(scene(*steps), 6), uniform(scene(*steps, material=twin), 6)
    np.testing.assert_array_equal(one.contact_radius, two.contact_radius)
    np.testing.assert_allclose(one.force, two.force, rtol=1e-5, atol=1e-9)


# --- order, work, agreement


@pytest.mark.slow
def test_first_order_when_width_and_step_are_refined_together():
    """Two-sided slope of the loop energy, and caps, against front tracking.

    The error of the pull-off force is of either sign, as the largest tension falls between two annuli.
    """
    resolutions, pull_off, loop = (5, 10, 20, 40), [], []
    for resolution in resolutions:
        trace = uniform(cycle(0.02), resolution)
        assert trace.counters.factorisations == 1
        # the start; the step that found no contact; the halvings that find the last one
        assert trace.counters.linear_solves == trace.counters.steps + 2 + 8
        pull_off.append(abs(-trace.force.min() / JKR / 4.300 - 1.0))
        loop.append(abs(trace.external_work[-1] / np.pi / 1.5104e-4 - 1.0))
    assert -1.5 < np.polyfit(np.log(resolutions), np.log(loop), 1)[0] < -0.7
    assert loop[-1] < 3e-3
    assert np.all(np.array(pull_off) * resolutions < 0.04)


@pytest.mark.parametrize(
    ("speed", "radius", "pull_off", "lost", "loop"),
    [
        pytest.param(0.002, 0.21116, 4.5242, -0.02277, 1.8872e-4, marks=pytest.mark.slow),
        (0.1, 0.20092, 1.7023, 0.0042386, 7.469e-5),
    ],
)
def test_cycles(speed, radius, pull_off, lost, loop):
    trace = uniform(cycle(speed))
    assert trace.contact_radius[trace.penetration.argmax()] == pytest.approx(radius, abs=0.013 / 12)
    assert -trace.force.min() / JKR == pytest.approx(pull_off, rel=2e-2)
    assert trace.penetration[-1] == pytest.approx(lost, rel=2e-2)
    assert trace.external_work[-1] / np.pi == pytest.approx(loop, rel=1.5e-2)


JUMP = scene(Table((0.0, 0.3, 1.0), (0.03, 0.03, -0.1)), start="relaxed", at=0.02, material=TWO_BRANCHES)


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(scene(Ramp(0.05, 0.02), Ramp(-0.5, 0.02), at=0.01, indenter=Cone(70.0)), id="cone"),
        pytest.param(JUMP, id="jump", marks=pytest.mark.slow),
    ],
)
def test_agreement_with_the_default_solver(case):
    ours, default = uniform(case, 16), bem_solver.solve(case, Options(resolution=6))
    assert ours.outcome.kind is default.outcome.kind
    assert ours.force.max() == pytest.approx(default.force.max(), rel=1e-2)
    assert ours.force.min() == pytest.approx(default.force.min(), rel=2e-2)
    assert ours.contact_radius.max() == pytest.approx(default.contact_radius.max(), abs=0.013 / 16)
    assert ours.dissipated_energy[-1] == pytest.approx(default.dissipated_energy[-1], rel=2e-2)


def test_profile_carries_the_force():
    annuli = np.pi * np.diff((np.arange(400) * 0.013 / 12) ** 2)
    trace = uniform(scene(Ramp(0.032, 0.1), Hold(0.5)), profile_times=(0.0, 0.5, 9.0))
    assert [p.time for p in trace.profiles] == [0.0, 0.5]
    for p in trace.profiles:
        assert p.pressure @ annuli[: len(p.pressure)] == pytest.approx(p.force, rel=1e-10)
        inside = p.radius < p.contact_radius
        assert np.all(p.gap[inside] == 0.0)
        assert np.all(p.gap[~inside] > 0.0)
        np.testing.assert_allclose(
            p.displacement[inside], p.penetration - p.radius[inside] ** 2 / 2, rtol=1e-9
        )


def test_progress_rises_to_one():
    seen = []
    uniform(scene(Ramp(0.01, 0.1), Hold(0.0), Hold(0.1)), 4, progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0


# --- refusals and other ends


def test_too_many_annuli_are_refused():
    with pytest.raises(UnsupportedScene, match=r"uniform annuli would be needed; allowed: at most 4000"):
        uniform(scene(Hold(1.0), start="relaxed", at=0.032, adhesion=Adhesion(GAMMA, 1e-4)))


@pytest.mark.parametrize(
    ("key", "left_out"),
    [
        ("adhesion.work_closing", {"adhesion": Adhesion(GAMMA, 0.013, 0.4 * GAMMA)}),
        ("adhesion.rate", {"adhesion": Adhesion(GAMMA, 0.013, rate=PowerRate(1e-3, 0.5))}),
        ("adhesion.stress", {"adhesion": Adhesion(GAMMA, stress=0.2)}),
        ("machine", {"loading": Loading("relaxed", 0.0, (Ramp(-0.1, 0.1),), Machine(1.0))}),
        ("level", {"loading": Loading("relaxed", 0.0, (Ramp(0.1, 0.1, until_force=1e-3),))}),
    ],
)
def test_what_the_paper_leaves_out_is_refused(key, left_out):
    asked = replace(scene(start="relaxed", material=Material(0.75, 0.5)), **left_out)
    with pytest.raises(UnsupportedScene, match=f"{key}.*graded"):
        uniform(asked)


def test_a_zone_longer_than_the_contact_is_refused():
    with pytest.raises(SceneError, match="process zone"):
        uniform(scene(Hold(1.0), adhesion=Adhesion(GAMMA, 0.2)))


def test_no_equilibrium():
    trace = uniform(scene(Hold(1.0), at=-0.5))
    assert trace.outcome.kind is OutcomeKind.NO_EQUILIBRIUM
    assert len(trace) == 0


def test_step_budget():
    trace = uniform(scene(Ramp(0.032, 0.1)), max_steps=10)
    assert trace.outcome.kind is OutcomeKind.STEP_BUDGET
    assert trace.counters.steps == 10
    assert trace.time[-1] < 0.32


def test_motion_without_contact():
    trace = uniform(scene(Ramp(-0.1, 1.0), at=-0.5, adhesion=None))
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    assert trace.time[-1] == 0.4
    assert not trace.force.any()
    assert not trace.contact_radius.any()


def test_pulled_without_contact():
    trace = uniform(scene(Force(-0.1, 1.0), at=-0.5, adhesion=None))
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert trace.outcome.reason == "pulled without contact"


def test_contact_that_leaves_the_annuli(monkeypatch):
    monkeypatch.setattr("bem_solver.paper_scheme.largest_contact", lambda scene: 0.15)
    trace = uniform(cycle(0.1))
    assert trace.outcome.kind is OutcomeKind.OUT_OF_RANGE
    assert 0.16 < trace.contact_radius[-1] < 0.17


@pytest.mark.parametrize("method", ["backward", "last"])
def test_no_nan_in_the_trace(monkeypatch, method):
    solve, calls = getattr(LeadingBlocks, method), []

    def spoiled(self, *given):
        calls.append(0)
        return solve(self, *given) * (np.nan if len(calls) > 350 else 1.0)

    monkeypatch.setattr(LeadingBlocks, method, spoiled)
    trace = uniform(cycle(0.1), 20)
    assert trace.outcome.kind is OutcomeKind.NOT_FINITE
    assert len(trace) > 1
    for column in trace.columns().values():
        assert np.isfinite(column).all()


def test_nan_at_the_start(monkeypatch):
    monkeypatch.setattr(LeadingBlocks, "backward", lambda self, values: np.nan * values)
    trace = uniform(cycle(0.1))
    assert trace.outcome.kind is OutcomeKind.NO_EQUILIBRIUM
    assert "not finite" in trace.outcome.reason
