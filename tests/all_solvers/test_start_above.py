"""Where an indenter sets out above the surface does not matter: nothing happens before it touches."""

from __future__ import annotations

import numpy as np
import pytest
from support.invariants.coarse_solvers import SOLVERS

from contact_scene import Branch, ForceRamp, Loading, Material, Ramp, Scene, Sphere

RUBBER = Material(0.75, 0.5, (Branch(2.25, 1.0), Branch(1.0, 0.1)))
RATE, DEPTH, HEIGHT = 0.02, 0.01, 0.005


def pressed(start: float, off: Ramp | ForceRamp) -> Scene:
    """Without adhesion, pressed in and taken off."""
    return Scene(RUBBER, Sphere(1.0), Loading("jump-in", start, (Ramp(DEPTH, RATE), off)))


@pytest.mark.parametrize(
    "off",
    [
        pytest.param(Ramp(-DEPTH, RATE), id="penetration"),
        pytest.param(ForceRamp(-1e-3, 1e-2), id="force", marks=pytest.mark.exhaustive),
    ],
)
@pytest.mark.parametrize(
    "solver", ["fem", *(pytest.param(name, marks=pytest.mark.slow) for name in ("reference", "bem"))]
)
def test_contact_ends_as_if_it_had_begun_at_once(solver, off):
    """The centre kept what it would have taken up on the way: reference 6 % too long in contact."""
    above, touching = (SOLVERS[solver].solve(pressed(start, off)) for start in (-HEIGHT, 0.0))
    assert above.outcome.kind == touching.outcome.kind == "detached"
    accuracy = 2.0 * SOLVERS[solver].declared(pressed(0.0, off))
    assert above.time[-1] - HEIGHT / RATE == pytest.approx(touching.time[-1], rel=accuracy)
    assert above.penetration[-1] == pytest.approx(touching.penetration[-1], abs=accuracy * DEPTH)
    for column in ("branch_dissipation", "dissipated_energy", "external_work"):
        one, two = (trace.columns()[column] for trace in (above, touching))
        assert one[-1] == pytest.approx(two[-1], rel=2.0 * accuracy), column
    assert np.diff(above.extra["branch_dissipation"]).min() >= -1e-6 * above.extra["branch_dissipation"][-1]
