"""Front tracking where the contact shrinks to the length of its process zone: the model ends there."""

import numpy as np
import pytest
from support.paper_scenes import ELASTIC, ONE, WORK

from contact_scene import Adhesion, Loading, OutcomeKind, Ramp, Scene, Sphere, Table, Trace
from contact_scene.loading import Step
from contact_scene.material import Material
from validation.reference.finite_zone import FiniteZone
from validation.reference.path.closure import closure
from validation.reference.path.solver import Options, solve
from validation.reference.sneddon import transform

LONG_ZONE = 0.2
"""Of the sphere's radius: longer than the contact at the limit point under prescribed penetration."""


def _pulled(step: Step, material: Material, resolution: int = 4) -> Trace:
    loading = Loading("relaxed", 0.1, (step,))
    return solve(
        Scene(material, Sphere(1.0), loading, Adhesion(WORK, LONG_ZONE)), Options(resolution=resolution)
    )


@pytest.mark.parametrize("ratio", [0.55, 0.9, 0.999, 0.9999])
def test_closure_of_a_contact_hardly_longer_than_its_zone(ratio: float) -> None:
    a, zone, depth = 0.2, ratio * 0.2, 0.03
    form = closure(a, zone, zone * np.linspace(0.0, 1.0, 17))
    shape = transform(Sphere(1.0))
    got = form.between(depth - shape(a - zone + form.s), shape(a + form.s) - depth)
    assert got == pytest.approx(FiniteZone(1.0, 1.0, WORK, zone).closure(a, depth), rel=1e-7)


@pytest.mark.parametrize(
    "step",
    [Ramp(-0.5, 0.01), pytest.param(Table((0.0, 1.0), (-0.06, -0.5)), marks=pytest.mark.slow)],
    ids=["slowly", "by a jump"],
)
def test_the_last_row_is_the_contact_as_long_as_its_zone(step: Step) -> None:
    """Elastic, slowly or by a jump: contact given up before shows in radius, penetration and force alike."""
    trace = _pulled(step, ELASTIC)
    exact = FiniteZone(1.0, 1.0, WORK, LONG_ZONE).state(LONG_ZONE)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert not trace.outcome.past_extremum
    assert not trace.outcome.finished
    assert not trace.events
    assert trace.contact_radius[-1] == pytest.approx(exact.contact_radius, rel=1e-6)
    assert trace.penetration[-1] == pytest.approx(exact.penetration, rel=1e-5)
    assert trace.force[-1] == pytest.approx(exact.force, rel=1e-6)


@pytest.mark.slow
def test_a_tension_that_falls_before_has_had_its_maximum() -> None:
    trace = _pulled(Ramp(-0.5, 0.1), ONE)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert trace.outcome.past_extremum
    assert trace.outcome.finished
    assert trace.outcome.time == trace.time[-1]
    assert trace.contact_radius[-1] == LONG_ZONE == trace.contact_radius.min()
    assert trace.force[-1] > 1.01 * trace.force.min()
    finer = _pulled(Ramp(-0.5, 0.1), ONE, 16)
    for column in ("time", "force", "penetration"):
        ends = getattr(trace, column)[-1], getattr(finer, column)[-1]
        assert ends[0] == pytest.approx(ends[1], rel=3e-4)
