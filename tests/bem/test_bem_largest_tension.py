"""The largest tension of a run: a corner of the force where an edge at rest sets off, over short zones."""

import pytest
from numpy.testing import assert_allclose
from support.bem_runs import bem

from contact_scene import (
    Adhesion,
    Branch,
    FlatPunch,
    ForceRamp,
    Hold,
    Loading,
    Machine,
    Material,
    OutcomeKind,
    Ramp,
    Scene,
    Sphere,
    Table,
)
from validation.cases import load
from validation.solvers.boundary_elements import BoundaryElements

LATE = Scene(
    Material(1.0, 0.5, (Branch(20.0, 1.0),)),
    Sphere(1.0),
    Loading("relaxed", 0.027, (Ramp(-0.1, 0.064),)),
    Adhesion(1.5e-4, 1.6e-4, work_closing=1e-5),
)
"""Glass under rubber. The edge creeps open by a zone, where its speed jumps, a thirtieth of the way before it
sets off."""
PRESSED = Scene(
    Material(1.01e6, 0.0, (Branch(2.34e7, 1.22),)),
    Sphere(3.08e-4),
    Loading("relaxed", 1.66e-6, (Ramp(3.2e-6, 6e-6), Hold(0.03), Ramp(-1.3e-5, 2.3e-5))),
    Adhesion(0.0056, 4.1e-11),
)
"""Pressed with eleven times the force that it is pulled off with."""
PUNCH = Scene(
    Material(1.0, 0.0, (Branch(2.5, 1.0),)),
    FlatPunch(0.15),
    Loading("jump-in", 0.01, (ForceRamp(0.0065, 0.03), ForceRamp(-0.013, 0.056))),
    Adhesion(1.85e-4, 3e-8),
)
"""Filled until it is pulled off by a growing force; the penetration, by which it is judged, is glassy."""


@pytest.mark.parametrize(
    "resolution",
    [6, *(pytest.param(n, marks=pytest.mark.exhaustive) for n in (12, 24))],
)
@pytest.mark.parametrize(
    ("question", "force"),
    [
        pytest.param(LATE, 0.014152234, id="late", marks=pytest.mark.slow),
        pytest.param(PRESSED, 1.8127202e-4, id="pressed", marks=pytest.mark.slow),
        pytest.param(PUNCH, 0.0077250485, id="punch"),
    ],
)
def test_largest_tension_over_short_zones(question, force, resolution):
    """By front tracking; a row on either side of the corner used to miss it by 0.2 to 0.5 %."""
    trace = bem(question, resolution=resolution)
    assert trace.outcome.kind == "detached"
    assert_allclose(-trace.force.min(), force, rtol=1e-3)


@pytest.mark.slow
def test_a_step_that_passes_it_where_slopes_bend_is_taken_back():
    """The zone leaves the edge at which the contact has rested; to that step the load would turn later."""
    trace = BoundaryElements().solve(load("layer-dwell").scene, 6)
    assert -trace.force.min() == pytest.approx(0.015955733, rel=1e-4)  # front tracking; without 2.6e-4


def test_rounding_of_a_resting_load_has_no_extremum():
    """A stage that rests for a snap-in: steps towards extrema of rounding halved until their budget ended."""
    stage = Table((0.7533592561886379, 2.753359265869461, 6.409), (0.0, 0.04000000028448159, -0.0331))
    question = Scene(
        Material(0.9, 0.5),
        Sphere(1.0),
        Loading("snap-in", 0.0, (stage,), Machine(0.2)),
        Adhesion(5e-4, 0.01),
    )
    trace = BoundaryElements().solve(question, None, max_steps=1000)
    assert trace.outcome.kind is OutcomeKind.DETACHED
