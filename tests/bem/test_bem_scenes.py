"""Scenes other than the paper's, against front tracking and closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import at_times, bem, front
from support.closed_forms import punch
from support.closed_forms.lee_radok import radius_under_force_ramp, radius_under_force_step
from support.paper_scenes import ELASTIC, ONE, PULL, SPHERE, THREE, WORK, cycle, scene

from bem_solver import Options, solve
from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    FlatPunch,
    Force,
    ForceRamp,
    Hold,
    Material,
    Oscillate,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Sweep,
    Table,
    TabulatedProfile,
)
from validation.measure.observables import observe
from validation.reference import punch_oscillation
from validation.reference.ting import Ting

GRID = np.linspace(0.0, 1.0, 41)
TABLE = TabulatedProfile(tuple(GRID), tuple(0.5 * GRID**2))
PUNCH = FlatPunch(0.2)
STIFF = Material(0.75, 0.5, (Branch(74.25, 1.0),))
HARD = Material(0.91, 0.3, (Branch(8.19, 1.0),))

# Whole cycles; the tolerance is on F, relative to its largest, and on a, over the whole run.
CYCLES = {
    "three branches": (cycle(0.02, material=THREE), 2e-3),
    "short zone": (cycle(0.02, adhesion=Adhesion(WORK, 0.005)), 1e-3),
    "long zone": (cycle(0.02, adhesion=Adhesion(WORK, 0.03)), 3e-3),
    "hundredfold": (cycle(0.02, material=STIFF), 1e-3),
    "nu = 0.3": (cycle(0.02, material=HARD), 1e-3),
    "cone": (cycle(0.02, indenter=Cone(80.0), adhesion=Adhesion(WORK, 0.004)), 3e-3),
    "power 1.5": (cycle(0.02, indenter=PowerLaw(1.5, 0.5)), 1e-3),
    "power 3": (cycle(0.02, indenter=PowerLaw(3.0, 1.5)), 1e-3),
    "power 8": (cycle(0.02, indenter=PowerLaw(8.0, 1e4)), 2e-3),
    "hold": (scene(Ramp(0.032, 0.1), Hold(3.0), Ramp(-0.5, 0.1)), 2e-3),
    "re-approach": (scene(Ramp(0.03, 0.05), Ramp(0.02, 0.05), Ramp(0.04, 0.05), Ramp(-0.5, 0.05)), 1e-3),
}
# Runs of the loading's own kind; driven by the force they are softer near their ends.
LOADINGS = {
    "force": (scene(Force(2.0 * PULL, 3.0), start="relaxed"), 2e-3),
    "dead tension": (scene(Force(-2.0 * PULL, 50.0), start="relaxed"), 2e-2),
    "force ramps": (scene(ForceRamp(3.0 * PULL, PULL), ForceRamp(-20.0 * PULL, PULL), start="relaxed"), 5e-3),
    "oscillation": (scene(Oscillate(0.005, 1.0, 8.0), at=0.02), 2e-3),
    "oscillation with drift": (scene(Oscillate(0.003, 2.0, 40.0, 0.002), start="relaxed", at=0.02), 1e-2),
    "sweep": (scene(Sweep(0.003, 0.5, 6.0), start="relaxed", at=0.02), 2e-2),
    "table": (scene(Table((0.0, 1.0, 2.0), (0.0, 0.03, 0.01))), 2e-3),
    "jump down": (scene(Table((0.0, 1.0), (0.025, 0.025)), start="relaxed", at=0.032), 2e-3),
}
SLOW = {
    "hold",
    "table",
    "power 8",
    "sweep",
    "three branches",
    "dead tension",
    "oscillation",
    "cone",
    "hundredfold",
    "re-approach",
    "oscillation with drift",
    "force ramps",
}
EXHAUSTIVE = {"long zone", "short zone", "power 1.5", "power 3", "nu = 0.3"}
"""Between or beside others of which but a number varies."""


def marked(cases):
    marks = dict.fromkeys(SLOW, pytest.mark.slow) | dict.fromkeys(EXHAUSTIVE, pytest.mark.exhaustive)
    return [pytest.param(*case, id=name, marks=marks.get(name, ())) for name, case in cases.items()]


def compared(question, tolerance, resolution=12, of_front=10):
    """Both answers, alike in how they end and along the way."""
    mine, other = bem(question, resolution=resolution), front(question, of_front)
    assert mine.outcome.kind is other.outcome.kind
    assert [event.kind for event in mine.events] == [event.kind for event in other.events]
    assert_allclose(mine.outcome.time, other.outcome.time, rtol=5e-3)
    times = np.linspace(0.0, 0.99 * min(mine.time[-1], other.time[-1]), 150)[1:]
    for name in ("penetration", "force", "contact_radius"):
        scale = np.abs(other.columns()[name]).max()
        found = at_times(mine, name, times)
        assert_allclose(found, at_times(other, name, times), atol=tolerance * scale, err_msg=name)
    return observe(mine), observe(other)


@pytest.mark.parametrize(("question", "tolerance"), marked(CYCLES))
def test_cycle_is_that_of_front_tracking(question, tolerance):
    mine, other = compared(question, tolerance)
    assert_allclose(mine.pull_off_force, other.pull_off_force, rtol=1e-3)
    assert_allclose(mine.loop_energy, other.loop_energy, rtol=2e-3)
    assert_allclose(mine.dissipated_energy, other.dissipated_energy, rtol=5e-3)
    lost = abs(mine.detachment_penetration - other.detachment_penetration)
    assert lost < 1e-3 * max(abs(other.detachment_penetration), other.approach_penetration)


@pytest.mark.parametrize(("question", "tolerance"), marked(LOADINGS))
def test_loading_is_that_of_front_tracking(question, tolerance):
    mine, other = compared(question, tolerance, 8, 6)
    assert_allclose(mine.start_force, other.start_force, rtol=1e-3, atol=1e-5)


def test_only_the_plane_modulus_counts():
    plain, other = bem(cycle(0.02), resolution=4), bem(cycle(0.02, material=HARD), resolution=4)
    assert_allclose(other.force.min(), plain.force.min(), rtol=1e-9)
    assert_allclose(other.time[-1], plain.time[-1], rtol=1e-9)


@pytest.mark.slow
def test_tabulated_sphere_is_the_sphere():
    mine, sphere = bem(cycle(0.1, indenter=TABLE), resolution=6), bem(cycle(0.1), resolution=6)
    assert_allclose(mine.force.min(), sphere.force.min(), rtol=1e-7)
    assert_allclose(mine.external_work[-1], sphere.external_work[-1], rtol=1e-6)


def test_oscillating_punch_is_one_linear_element():
    question = scene(
        Oscillate(1e-3, 2.0, 6.0), start="relaxed", at=0.01, material=THREE, indenter=PUNCH, adhesion=None
    )
    trace = bem(question)
    assert trace.outcome.kind is OutcomeKind.COMPLETED
    expected = 0.4 * 0.01 + punch_oscillation.force(THREE, 0.2, 2.0, 1e-3, trace.time)
    assert_allclose(trace.force, expected, atol=1e-3 * expected.max())
    assert_allclose(trace.contact_radius, 0.2, rtol=1e-14)


def test_elastic_punch_detaches_at_kendalls_force():
    excess = []
    for zone in (8e-3, 4e-3):
        question = scene(
            Ramp(-0.5, 1e-3),
            start="relaxed",
            at=1e-3,
            material=ELASTIC,
            indenter=PUNCH,
            adhesion=Adhesion(WORK, zone),
        )
        trace = bem(question)
        assert trace.outcome.kind is OutcomeKind.DETACHED
        excess.append(-trace.force.min() / punch.pull_off_force(0.2, 1.0, WORK) - 1.0)
    assert 0.0 < excess[1] < 4e-3
    assert_allclose(excess[0] / excess[1], 2.0, rtol=0.15)


@pytest.mark.parametrize(
    "indenter", [SPHERE, pytest.param(Cone(80.0), marks=pytest.mark.slow)], ids=["sphere", "cone"]
)
def test_adhesionless_cycle_with_hold_is_tings(indenter):
    question = scene(
        Ramp(0.04, 0.05), Hold(0.2), Ramp(-0.05, 0.08), material=THREE, indenter=indenter, adhesion=None
    )
    exact, trace = Ting(THREE, indenter, 0.05, 0.8, 0.08, 0.2), bem(question, resolution=4)
    assert trace.outcome.kind is OutcomeKind.DETACHED
    assert_allclose(trace.outcome.time, exact.detachment(), rtol=2e-3)
    assert_allclose(trace.force, exact.force(trace.time), atol=1e-3 * trace.force.max())


def test_creep_under_a_dead_load_and_a_growing_one():
    """The contact grows from nothing under a force; duals of Lee and Radok's loading."""
    dead = bem(scene(Force(0.01, 3.0), start="relaxed", material=THREE, adhesion=None), resolution=5)
    rows = dead.time > 0.0
    exact = radius_under_force_step(THREE, SPHERE, 0.01, dead.time[rows])
    assert_allclose(dead.contact_radius[rows], exact, rtol=5e-3)
    growing = bem(scene(ForceRamp(0.01, 0.005), start="relaxed", at=0.005, adhesion=None), resolution=5)
    exact = radius_under_force_ramp(ONE, SPHERE, 0.005, growing.time, growing.force[0])
    assert_allclose(growing.contact_radius, exact, rtol=2e-3)


def test_a_stiff_glass_that_creeps_under_a_force_is_lee_radoks():
    """What a step misses of displacements at the edge, a glass twenty times as stiff makes large."""
    glass = Material(0.75, 0.5, (Branch(14.25, 1.0),))
    force = 4.0 / 3.0 * 20.0 * 0.005**1.5
    trace = bem(scene(Force(force, 40.0), at=0.005, adhesion=None, material=glass))
    depth = (0.75 * force * (1.0 - 0.95 * np.exp(-trace.time / 20.0))) ** (2.0 / 3.0)
    assert_allclose(trace.penetration, depth, rtol=1e-3)
    assert_allclose(trace.contact_radius, np.sqrt(trace.penetration), rtol=1e-3)


@pytest.mark.slow
def test_dwell_strengthens_the_pull_off():
    """Pressed longer, the contact has grown wider and relaxed: it holds more."""
    pulls = []
    for dwell in (0.0, 1.0, 10.0):
        question = scene(Ramp(0.02, 0.1), Hold(dwell), Ramp(-0.5, 0.1))
        pulls.append(-solve(question, Options(resolution=6)).force.min())
    assert np.all(np.diff(pulls) > 0.0)
