"""Creases of the fields, where the speed of the edge has jumped, and the nodes that keep them."""

from __future__ import annotations

import numpy as np
import pytest
from support.paper_scenes import ONE

from contact_scene import Adhesion, Branch, Force, Loading, Material, Scene, Sphere, Table, TabulatedProfile
from validation.reference.path.rheology import Body, rheology
from validation.reference.sneddon import transform
from validation.reference.tracking import Options, hermite, solve
from validation.reference.tracking.coarsening import coarsened
from validation.reference.tracking.edge_path import ParabolicPath
from validation.reference.tracking.law import Griffith
from validation.reference.tracking.penetration_path import straight
from validation.reference.tracking.surface import Surface
from validation.reference.tracking.surface_step import field_update, surface_step

BODY = Body(rheology(ONE), transform(Sphere(1.0)))
EDGE = 0.2


def _bent(x: np.ndarray, at: float = EDGE) -> np.ndarray:
    """A parabola on either side of ``at``, with a jump of the slope."""
    return np.where(x < at, 1.0 + 0.5 * (x - at) - (x - at) ** 2, 1.0 - 7.0 * (x - at) + 3.0 * (x - at) ** 2)


def _surface(inside: np.ndarray, outside: np.ndarray) -> Surface:
    return Surface(0.03, inside, _bent(inside)[:, None], outside, -1e-3 * (1.0 + outside[:, None] ** 2))


@pytest.mark.parametrize("apart", [2e-15, 1e-12])
def test_either_side_of_a_crease_is_interpolated_by_itself(apart: float) -> None:
    left, right = np.array([0.0, 0.1, 0.17, EDGE]), np.array([EDGE + apart, 0.20001, 0.27, 0.4])
    at = np.linspace(0.0, 0.4, 200)
    x = np.concatenate((left, right))
    found = hermite.evaluate(x, _bent(x), hermite.slopes(x, _bent(x)), at)
    np.testing.assert_allclose(found, _bent(at), atol=1e-6 if apart > 1e-13 else 1e-11)
    single = np.concatenate((left, right[1:]))
    found = hermite.evaluate(single, _bent(single), hermite.slopes(single, _bent(single)), at)
    assert np.abs(found - _bent(at)).max() > 1e-3


def test_between_two_creases_with_nothing_in_between_the_line_is_straight() -> None:
    x = np.array([0.0, 0.1, 0.1 + 1e-14, 0.3, 0.3 + 1e-14, 0.4])
    y = np.array([5.0, 1.0, 1.0, 2.0, 2.0, -3.0])
    found = hermite.evaluate(x, y, hermite.slopes(x, y), np.array([0.15, 0.2, 0.25]))
    np.testing.assert_allclose(found, [1.25, 1.5, 1.75], atol=1e-12)


def test_a_crease_changes_nothing_but_the_slopes() -> None:
    smooth = _surface(np.linspace(0.0, EDGE, 41), np.linspace(EDGE, 0.3, 31))
    creased = smooth.with_edge_nodes_doubled()
    assert len(creased.inside) == 42
    assert len(creased.outside) == 32
    assert creased.radius == smooth.radius
    assert (np.diff(creased.inside) > 0.0).all()
    assert (np.diff(creased.outside) > 0.0).all()
    assert creased.force(BODY) == pytest.approx(smooth.force(BODY), rel=1e-6)
    law = Griffith(Adhesion(5e-4, 0.013))
    assert law.residual(creased, BODY) == pytest.approx(law.residual(smooth, BODY), rel=1e-6)
    again = creased.with_edge_nodes_doubled()
    np.testing.assert_array_equal(again.inside, creased.inside)
    np.testing.assert_array_equal(again.outside, creased.outside)


@pytest.mark.parametrize("apart", [1e-3, 1e-14, 0.0])  # 0: the next floating-point number
def test_an_edge_that_has_rested_leaves_what_lies_beyond_as_it_was(apart: float) -> None:
    """A node one rounding inside it took the place of the one beyond: the edge stood on a false root."""
    last = np.nextafter(EDGE, 0.0) if apart == 0.0 else EDGE - apart
    inside = np.array([0.0, 0.1, 0.15, last, EDGE])
    rested = Surface(0.0, inside, np.zeros((5, 1)), np.array([EDGE]), np.zeros((1, 1)))
    duration = 1e-6
    update = field_update(rested, BODY, straight(duration, 0.0, 0.0, 0.0))
    assert update.was_at_rest
    path = ParabolicPath(EDGE, -1e-3, 0.0)
    after = surface_step(rested, BODY, update, path, np.array([0.5, 0.9]))(update)
    assert (np.diff(after.outside) > 0.0).all()
    assert after.outside[-1] == EDGE
    assert after.units[-1, 0] == 0.0
    assert after.units[-2, 0] < -0.01
    lost = rested.after_detachment(BODY)
    assert (np.diff(lost.outside) > 0.0).all()
    assert lost.units[-1, 0] == 0.0


def test_without_contact_there_is_nothing_to_crease() -> None:
    free = Surface(0.0, np.zeros(1), np.zeros((1, 1)), np.array([0.0, 0.1, 0.2]), np.zeros((3, 1)))
    assert len(free.with_edge_nodes_doubled().inside) == 1
    np.testing.assert_array_equal(free.with_edge_nodes_doubled().outside, free.outside)


@pytest.mark.parametrize("count", [41, 42])  # every other node may go: which depends on their number
def test_thinning_leaves_a_crease_and_its_neighbours(count: int) -> None:
    before = _surface(np.linspace(0.0, EDGE, count), np.linspace(EDGE, 0.3, 31)).with_edge_nodes_doubled()
    beyond = np.linspace(EDGE, 0.24, 60)[1:]
    inside = np.concatenate((before.inside, beyond))
    advanced = _surface(inside, np.linspace(0.24, 0.3, 31))
    few = advanced
    for _ in range(12):
        few = coarsened(few, 1e-2)
    assert len(few.inside) < 0.8 * len(inside)
    crease = int(np.flatnonzero(inside == EDGE)[0])
    for j in range(crease - 3, crease + 3):
        assert inside[j] in few.inside, j


@pytest.mark.slow
@pytest.mark.parametrize("shift", [1.0, pytest.param(0.998, marks=pytest.mark.exhaustive), 1.001])
def test_a_rough_profile_gives_back_no_more_than_it_got(shift: float) -> None:
    """Kinks of the load under a measured profile; slopes across them once led to roots that are none."""
    heights = (
        0.0, 0.0004472, 0.0017539, 0.0048372, 0.0096439, 0.0143089, 0.0186906, 0.0256311, 0.0325144,
        0.0421478, 0.0554478, 0.0690511, 0.0828128, 0.0963961, 0.1069411, 0.121135, 0.1390117, 0.162845,
        0.1764561, 0.2014106, 0.2254172, 0.243685, 0.265185, 0.296035, 0.3166889,
    )  # fmt: skip
    branches = (
        Branch(1.264, 3.741),
        Branch(0.7274, 2.851e-4),
        Branch(0.783, 0.4325),
        Branch(3.782, 3.076e-3),
    )
    table = Table((0.6622, 0.6981, 1.3482), (0.0059, 0.03 * shift, 0.0016))
    scene = Scene(
        Material(0.76, 0.49, branches),
        TabulatedProfile(tuple(np.linspace(0.0, 0.8, 25)), heights),
        Loading("relaxed", 0.00374, (table,)),
        Adhesion(9.814e-5, 0.0179),
    )
    trace = solve(scene, Options(resolution=8))
    effort = np.abs(trace.external_work).max()
    assert trace.stored_energy[-1] < 0.02 * effort
    assert 0.35 * effort < trace.dissipated_energy[-1] < 0.37 * effort


@pytest.mark.parametrize("resolution", [8, pytest.param(32, marks=pytest.mark.slow)])
def test_an_edge_almost_at_rest_stays_where_it_is(resolution: int) -> None:
    """Its tiny steps leave nodes in a crowd; slopes of what lies beyond must not be taken from them."""
    heights = (
        0.0, 0.0035296, 0.0116992, 0.0268032, 0.0427296, 0.0669504, 0.1005664, 0.138048, 0.178752, 0.247296,
        0.316608,
    )  # fmt: skip
    moduli = (0.0017619760464116293, 0.7961593504173188, 1.9319683170169242, 0.14125375446227545)
    times = (133.6595516546442, 2.202926463053456, 0.2570395782768864, 0.010115794542598982)
    branches = (*map(Branch, moduli, times), Branch(1.0092528860766845, 0.2529297996446145))
    scene = Scene(
        Material(1.0, 0.0, branches),
        TabulatedProfile(tuple(0.08 * np.arange(11)), heights),
        Loading("relaxed", 0.0069, (Force(0.000688, 0.38547835766577176),)),
    )
    trace = solve(scene, Options(resolution))
    after = trace.contact_radius[trace.time > 0.0]
    assert np.ptp(after) < 1e-6 * after[0]
    assert trace.counters.steps < 60
