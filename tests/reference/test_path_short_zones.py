"""Short zones, rated edges and collapses: outcomes are events, whatever rounding is left of zone and time."""

from __future__ import annotations

import pytest

from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    Force,
    Loading,
    Material,
    OutcomeKind,
    PowerRate,
    Ramp,
    RateTable,
    Scene,
    Sphere,
)
from validation.reference.path.solver import solve

BRANCHES = (Branch(4.8, 10.1), Branch(3.56, 0.447), Branch(0.012, 0.0034))
SOFT, ELASTIC = Material(0.91, 0.3, BRANCHES), Material(0.76, 0.49, ())
CUT = Material(1480.0, 0.5, (Branch(483.0, 0.00953), Branch(56.6, 0.0215)))
SATURATES = RateTable((1.27e-5, 0.0127), (0.000713, 0.00328))
SCENES = {
    # a zone of 1.7e-7 of the radius under a jump of the load: rounding of the radius is 1e-9 zones
    "jump": (
        Scene(
            SOFT, Sphere(3.75), Loading("jump-in", 0.0134, (Force(-3e-4, 65.5),)), Adhesion(1.46e-6, 3.8e-8)
        ),
        OutcomeKind.DETACHED,
    ),
    # the time left of a collapse is below the rounding of the time
    "collapse": (
        Scene(
            CUT,
            Cone(87.6),
            Loading("relaxed", 0.000185, (Ramp(-0.000741, 0.00573),)),
            Adhesion(0.000597, 1.67e-7, 0.000241, PowerRate(0.000622, 0.283)),
        ),
        OutcomeKind.BELOW_ZONE,
    ),
    # under a force the depth of a shrinking contact grows without bound
    "sinking": (
        Scene(
            Material(0.75, 0.5, ()),
            Sphere(1.0),
            Loading("relaxed", 0.00836, (Force(-0.00346, 0.966),)),
            Adhesion(3.94e-5, 9.42e-8, 1.38e-6, PowerRate(0.474, 1.29)),
        ),
        OutcomeKind.BELOW_ZONE,
    ),
    # after a jump the edge takes up the most that its law allows: the next instant tells its speed
    "saturated": (
        Scene(
            Material(44400.0, 0.3, (Branch(1640.0, 3.4), Branch(2450.0, 4390.0))),
            Sphere(0.0013),
            Loading("jump-in", 1.16e-5, (Force(1.75e-4, 13.0), Force(8.62e-5, 252.0))),
            Adhesion(0.000292, 1.17e-10, 0.000199, SATURATES),
        ),
        OutcomeKind.COMPLETED,
    ),
}


@pytest.mark.parametrize(
    "name", ["jump", "collapse", *(pytest.param(n, marks=pytest.mark.slow) for n in ("sinking", "saturated"))]
)
def test_outcomes_are_events(name: str) -> None:
    """No run ends for want of a step."""
    scene, outcome = SCENES[name]
    trace = solve(scene)
    assert trace.outcome.kind is outcome
    assert trace.counters.steps + trace.counters.rejected_steps < 2000
