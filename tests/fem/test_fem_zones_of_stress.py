"""Process zones of fixed stress that are far shorter, or far longer, than that at rest."""

from __future__ import annotations

import pytest

from contact_scene import Adhesion, Branch, Loading, Material, OutcomeKind, PowerRate, Ramp, Scene, Sphere
from validation.solvers.finite_elements import (
    LEAST_DIVISIONS,
    FiniteElements,
    resolved_length,
)

ONE = Material(1.0, 0.5, (Branch(2.0, 0.5),))
WORK = 2e-4
PRESSED = Loading("jump-in", 0.01, (Ramp(0.05, 0.05),))
PEELED = Loading("relaxed", 0.03, (Ramp(-0.5, 0.05),))


@pytest.mark.parametrize(
    ("share", "radius"),
    [
        pytest.param(0.05, 0.2278761, marks=pytest.mark.slow),
        pytest.param(0.1, 0.2297051, marks=pytest.mark.slow),
    ],
)
def test_an_edge_closes_smoothly_in_a_zone_far_shorter_than_that_at_rest(share, radius):
    """Radii by front tracking; in steps of elements longer than its zone the edge was 0.6 to 0.8 % behind."""
    scene = Scene(ONE, Sphere(1.0), PRESSED, Adhesion(WORK, work_closing=share * WORK, stress=0.1023))
    assert scene.adhesion.closing_zone == pytest.approx(share * scene.adhesion.zone)
    assert resolved_length(scene, 1.0) <= LEAST_DIVISIONS * scene.adhesion.closing_zone
    assert FiniteElements().solve(scene, 4).contact_radius[-1] == pytest.approx(radius, rel=5e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stress", "speed", "force", "work", "end"),
    [
        pytest.param(0.2288, 1e-4, 0.03651653, 1.266561e-3, 1.151686, marks=pytest.mark.slow),
        (0.1618, 2e-4, 0.03062150, 7.226401e-4, 0.868802),
    ],
)
def test_a_zone_that_grows_to_the_length_of_its_contact(stress, speed, force, work, end):
    """By front tracking. The closure looks one zone beyond the edge, and the model ends where that is all."""
    scene = Scene(ONE, Sphere(1.0), PEELED, Adhesion(WORK, rate=PowerRate(speed, 0.5), stress=stress))
    trace = FiniteElements().solve(scene, 4)
    assert trace.outcome.kind is OutcomeKind.BELOW_ZONE
    assert -trace.force.min() == pytest.approx(force, rel=2e-3)
    assert trace.external_work[-1] == pytest.approx(work, rel=1e-2)
    assert trace.outcome.time == pytest.approx(end, rel=5e-3)


def test_elements_are_shorter_than_the_resolution_says_only_where_the_closing_zone_asks_for_it():
    def shorter(**adhesion):
        asked = Scene(ONE, Sphere(1.0), PRESSED, Adhesion(WORK, **adhesion))
        return asked.adhesion.zone / resolved_length(asked, 1.0)

    for same in ({"zone": 0.02}, {"zone": 0.02, "work_closing": 0.05 * WORK}, {"stress": 0.1}):
        assert shorter(**same) == 1.0
    assert shorter(stress=0.1, work_closing=0.05 * WORK) == pytest.approx(5.0)
    assert shorter(stress=0.1, work_closing=0.5 * WORK) == 1.0
