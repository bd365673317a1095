"""Starts above the surface: without contact nothing happens before it touches; adhesion may hold it there."""

from __future__ import annotations

import numpy as np
import pytest
from support.invariants.coarse_solvers import SOLVERS
from support.paper_scenes import ONE, PULL, WORK

from contact_scene import (
    Adhesion,
    Branch,
    Cone,
    ForceRamp,
    Loading,
    Material,
    OutcomeKind,
    PowerLaw,
    Ramp,
    Scene,
    Sphere,
    TabulatedProfile,
)
from validation import solvers
from validation.measure.observables import observe
from validation.reference.jkr import JKR

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


TABLE = TabulatedProfile(tuple(np.linspace(0.0, 0.3, 31)), tuple(0.5 * np.linspace(0.0, 0.3, 31) ** 2))
SHAPES = {"sphere": Sphere(1.0), "cone": Cone(85.0), "power": PowerLaw(4.0, 20.0), "table": TABLE}
QUICK = {("sphere", 1e-1), ("sphere", 1e-6), ("cone", 1e-6), ("power", 1e-3), ("table", 1e-3)}


@pytest.mark.parametrize(
    ("solver", "shape", "share"),
    [
        pytest.param(solver, shape, share, marks=() if usual else pytest.mark.slow)
        for solver in SOLVERS
        for shape in SHAPES
        for share in ((1e-1, 1e-3, 1e-6) if solver != "fem" else (1e-1, 1e-2))
        for usual in [solver != "fem" and (shape, share) in QUICK]
    ],
)
def test_adhesion_holds_a_relaxed_contact_above_the_surface(solver, shape, share):
    """As far as JKR's does: the reference found none where four zones were within the unstable branch."""
    exact = JKR(Sphere(1.0) if shape == "table" else SHAPES[shape], 1.0, WORK)
    limit = exact.pull_off_penetration_control()

    def start(part: float) -> Scene:
        loading = Loading("relaxed", part * limit.penetration)
        return Scene(ONE, SHAPES[shape], loading, Adhesion(WORK, share * limit.contact_radius))

    for part in (0.1, 0.5, 0.9):
        radius = exact.at_penetration(part * limit.penetration).contact_radius
        accuracy = share + SOLVERS[solver].declared(start(part))
        trace = SOLVERS[solver].solve(start(part))
        assert trace.contact_radius[0] == pytest.approx(radius, rel=accuracy), part
    if solver != "fem":  # which has no mesh for it, and says so
        assert SOLVERS[solver].solve(start(1.2)).outcome.kind is OutcomeKind.NO_EQUILIBRIUM


def test_the_start_is_found_up_to_the_least_penetration():
    """Close to the limit point the stable and the unstable branch are closer than any scan is dense."""
    exact, zone = JKR(Sphere(1.0), 1.0, WORK), 1e-9
    limit = exact.pull_off_penetration_control().penetration

    def radii(part: float) -> np.ndarray:
        loading = Loading("relaxed", part * limit)
        scene = Scene(ONE, Sphere(1.0), loading, Adhesion(WORK, zone))
        return SOLVERS["reference"].solve(scene).contact_radius

    part = 1.0 - 1e-7
    assert radii(part)[0] == pytest.approx(exact.at_penetration(part * limit).contact_radius, rel=1e-4)
    assert not radii(1.0 + 1e-7).size


@pytest.mark.parametrize(
    "solver", ["reference", *(pytest.param(n, marks=pytest.mark.slow) for n in ("bem", "fem"))]
)
def test_pull_off_from_a_relaxed_contact_under_tension(solver):
    """Boundary elements 5.89038, finite elements 5.88992 JKR forces; the reference refused the start."""
    loading = Loading("relaxed", -0.003, (Ramp(-0.5, 0.01),))
    trace = solvers.SOLVERS[solver].solve(Scene(ONE, Sphere(1.0), loading, Adhesion(WORK, 3.9e-5)))
    assert trace.contact_radius[0] == pytest.approx(0.1319715, rel=2e-5)
    assert observe(trace).pull_off_force == pytest.approx(5.8904 * PULL, rel=5e-4)
