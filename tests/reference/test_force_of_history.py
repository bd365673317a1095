"""The force that belongs to the radii and penetrations of a run: against closed forms, and on raw columns."""

import numpy as np
import pytest
from support.closed_forms import lee_radok
from support.closed_forms.force_of_history import force_of_history
from support.paper_scenes import ONE, PULL, STICKY, THREE

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
    Ramp,
    Scene,
    Sphere,
    Trace,
)
from validation.reference import prony_integrals, sneddon
from validation.reference.path import Options, solve
from validation.reference.ting import Ting

CLOSE = Material(0.75, 0.5, (Branch(3.0, 1.0), Branch(3.75, 1.05)))


@pytest.mark.parametrize("indenter", [Sphere(1.0), Cone(70.0)])
def test_ramp_hold_and_retraction_are_tings(indenter) -> None:  # type: ignore[no-untyped-def]
    ting = Ting(THREE, indenter, 0.05, 1.0, 0.05, 0.5)
    end = 0.999 * ting.detachment()
    time = np.unique(np.concatenate((np.linspace(0.0, 1.0, 201) ** 2, np.linspace(1.0, 1.5, 11),
                                     1.5 + (end - 1.5) * np.linspace(0.0, 1.0, 101))))  # fmt: skip
    got = force_of_history(
        THREE, indenter, "jump-in", time, ting.penetration(time), ting.contact_radius(time)
    )
    np.testing.assert_allclose(got, ting.force(time), atol=2e-5 * ting.force(time).max())


def test_creep_under_a_dead_load_keeps_the_load() -> None:
    time = np.concatenate(([0.0], np.geomspace(1e-4, 30.0, 400)))
    radius = lee_radok.radius_under_force_step(ONE, Sphere(1.0), 0.01, time)
    depth, touch = sneddon.depth(Sphere(1.0), radius), np.array([0.0])
    columns = [np.concatenate((touch, column)) for column in (time, depth, radius)]
    columns[0][:2] = 0.0
    got = force_of_history(ONE, Sphere(1.0), "relaxed", *columns)
    np.testing.assert_allclose(got[1:], 0.01, rtol=2e-3)  # the load jump is one row


def test_a_punch_held_after_a_jump_relaxes() -> None:
    time = np.linspace(0.0, 5.0, 20)
    got = force_of_history(CLOSE, FlatPunch(0.1), "jump-in", time, 0.02 + 0.0 * time, 0.1 + 0.0 * time)
    np.testing.assert_allclose(got, 2.0 * 0.1 * 0.02 * prony_integrals.relaxation(CLOSE, time), rtol=1e-13)


def _deviation(trace: Trace, scene: Scene) -> float:
    rows = trace.contact_radius > 0.0
    columns = (trace.time[rows], trace.penetration[rows], trace.contact_radius[rows])
    got = force_of_history(scene.material, scene.indenter, scene.loading.start, *columns)
    return float(np.abs(got - trace.force[rows]).max() / np.abs(trace.force).max())


SCENES = {
    "hold": Scene(
        ONE, Sphere(1.0), Loading("jump-in", 0.0, (Ramp(0.032, 0.1), Hold(10.0), Ramp(-0.5, 0.1))), STICKY
    ),
    "close branches": Scene(
        CLOSE, Sphere(1.0), Loading("jump-in", 0.0, (Ramp(0.02, 0.05), Hold(1.0), Ramp(-0.5, 0.05))), STICKY
    ),
    "dead load": Scene(ONE, Sphere(1.0), Loading("relaxed", 0.032, (Force(-4.0 * PULL, 100.0),)), STICKY),
    "force ramp": Scene(ONE, Sphere(1.0), Loading("relaxed", 0.032, (ForceRamp(-1.0, 0.02),)), STICKY),
    "cone": Scene(
        ONE,
        Cone(70.0),
        Loading("jump-in", 0.03, (Ramp(0.1, 0.02), Ramp(-0.5, 0.02))),
        Adhesion(STICKY.work, 0.02),
    ),
    "small units": Scene(
        Material(1e6, 0.49, (Branch(3e6, 0.01), Branch(1e6, 1.0))),
        Sphere(1e-4),
        Loading("jump-in", 0.0, (Ramp(1e-6, 1e-6), Ramp(-1e-4, 1e-5))),
        Adhesion(0.05, 1e-6),
    ),
}


QUICK = {"cone", "force ramp"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in SCENES]
)
def test_raw_columns_of_a_run_belong_together(name: str) -> None:
    scene = SCENES[name]
    trace = solve(scene, Options(resolution=8))
    assert _deviation(trace, scene) < 1e-3
    stiffer = Material(
        scene.material.modulus,
        scene.material.poisson,
        tuple(Branch(1.02 * branch.modulus, branch.time) for branch in scene.material.branches),
    )
    assert _deviation(trace, Scene(stiffer, scene.indenter, scene.loading, scene.adhesion)) > 3e-3


def test_points_that_were_released_before_are_not_covered_again() -> None:
    with pytest.raises(ValueError, match="released"):
        force_of_history(ONE, Sphere(1.0), "relaxed", [0.0, 1.0, 2.0], [0.02] * 3, [0.2, 0.1, 0.15])
