"""Scenes other than the paper's, against front tracking and closed forms."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.bem_runs import at_times, bem, front
from support.paper_scenes import cycle, scene

from contact_scene import (
    Branch,
    Force,
    Material,
    Oscillate,
    PowerLaw,
    Sweep,
    Table,
)
from validation.measure.observables import observe

STIFF = Material(0.75, 0.5, (Branch(74.25, 1.0),))
HARD = Material(0.91, 0.3, (Branch(8.19, 1.0),))

# The tolerance is on F, relative to its largest, and on a, over the whole run. Other kinds of loading are
# compared by the quick report.
CYCLES = {
    "hundredfold": (cycle(0.02, material=STIFF), 1e-3),
    "power 8": (cycle(0.02, indenter=PowerLaw(8.0, 1e4)), 2e-3),
}
LOADINGS = {
    "oscillation with drift": (scene(Oscillate(0.003, 2.0, 40.0, 0.002), start="relaxed", at=0.02), 1e-2),
    "sweep": (scene(Sweep(0.003, 0.5, 6.0), start="relaxed", at=0.02), 2e-2),
    "jump down": (scene(Table((0.0, 1.0), (0.025, 0.025)), start="relaxed", at=0.032), 2e-3),
}


def marked(cases):
    return [
        pytest.param(*case, id=name, marks=() if name == "jump down" else pytest.mark.slow)
        for name, case in cases.items()
    ]


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


def test_a_stiff_glass_that_creeps_under_a_force_is_lee_radoks():
    """What a step misses of displacements at the edge, a glass twenty times as stiff makes large."""
    glass = Material(0.75, 0.5, (Branch(14.25, 1.0),))
    force = 4.0 / 3.0 * 20.0 * 0.005**1.5
    trace = bem(scene(Force(force, 40.0), at=0.005, adhesion=None, material=glass))
    depth = (0.75 * force * (1.0 - 0.95 * np.exp(-trace.time / 20.0))) ** (2.0 / 3.0)
    assert_allclose(trace.penetration, depth, rtol=1e-3)
    assert_allclose(trace.contact_radius, np.sqrt(trace.penetration), rtol=1e-3)
