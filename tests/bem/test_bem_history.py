"""History of the surface: interpolation on nodes that stay, kinks, and coarsening."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from support.bem_runs import observed_order

from bem_solver.history import (
    NodalVariables,
    SurfaceHistory,
    distinct,
    graded_nodes,
    midpoints_of_wide_intervals,
    nodes_beyond,
    updated_kinks,
)

UNEVEN = np.cumsum([0.0, 1.0, 0.3, 0.7, 2.0, 0.1, 0.5, 1.4]) / 6.0
BETWEEN = np.linspace(0.0, 1.0, 203)


def columns(*values):
    return np.stack(values, axis=1)


def test_parabolas_are_exact_on_uneven_nodes():
    def state(r):
        return columns(1.0 - 2.0 * r + 3.0 * r**2, r, 0.0 * r + 4.0)

    assert_allclose(NodalVariables(UNEVEN, state(UNEVEN)).at(BETWEEN), state(BETWEEN), atol=1e-13)


def test_roots_of_the_distance_are_exact_beyond_a_kink():
    """Parabolas in the radius before the first kink, in the root of the distance beyond each."""
    first, second = UNEVEN[2], UNEVEN[5]

    def state(r):
        x, y = np.sqrt(np.maximum(r - first, 0.0)), np.sqrt(np.maximum(r - second, 0.0))
        late = 2.0 - (second - first) + 3.0 * np.sqrt(second - first) + y - 2.0 * y**2
        value = np.where(r <= second, 2.0 + 3.0 * x - x**2, late)
        return columns(np.where(r <= first, 2.0 + (r - first) ** 2, value))

    exact = NodalVariables(UNEVEN, state(UNEVEN), (first, second))
    assert_allclose(exact.at(BETWEEN), state(BETWEEN), atol=1e-13)
    blind = NodalVariables(UNEVEN, state(UNEVEN))
    assert np.abs(blind.at(BETWEEN) - state(BETWEEN)).max() > 0.05


def test_order_of_interpolation():
    errors = []
    for count in (20, 40, 80):
        at = np.linspace(0.0, 1.0, count + 1) ** 1.3
        track = NodalVariables(at, columns(np.exp(2.0 * at)))
        errors.append(np.abs(track.at(BETWEEN)[:, 0] - np.exp(2.0 * BETWEEN)).max())
    assert 2.7 < observed_order(errors) < 3.7, errors
    assert errors[-1] < 2e-5


def test_values_at_nodes_are_exact_with_few_nodes_too():
    random = np.random.default_rng(0)
    state = random.normal(size=(8, 3))
    for kinks in ((), (UNEVEN[3],), (UNEVEN[0], UNEVEN[3])):
        assert_allclose(NodalVariables(UNEVEN, state, kinks).at(UNEVEN), state, atol=1e-13)
    assert_array_equal(NodalVariables(np.empty(0), np.empty((0, 3))).at(UNEVEN), np.zeros((8, 3)))
    assert_array_equal(NodalVariables(UNEVEN[:1], state[:1]).at(UNEVEN), np.repeat(state[:1], 8, axis=0))
    assert_allclose(
        NodalVariables(np.array([0.0, 1.0]), np.array([[0.0], [2.0]])).at(np.array([0.25])),
        [[0.5]],
        rtol=1e-14,
    )


@pytest.mark.parametrize("tolerance", [0.0, 1e-6, 1e-3])
def test_coarsening_keeps_to_its_tolerance(tolerance):
    radius = np.unique(np.random.default_rng(5).uniform(0.0, 1.0, 400))
    state = columns(np.sin(3.0 * radius), np.exp(-10.0 * radius))
    spacing, track = np.full(len(radius), 0.05), NodalVariables(radius, state)
    thin = track.coarsened(tolerance, spacing, 0)
    straight = columns(*(np.interp(radius, thin.radius, thin.values[:, k]) for k in range(2)))
    assert np.abs(straight - state).max() <= tolerance * (1.0 + 1e-9)
    assert np.diff(thin.radius).max() <= 0.05
    assert (len(thin.radius) == len(radius)) == (tolerance == 0.0)
    if tolerance == 1e-3:
        assert len(thin.radius) < 0.6 * len(radius)


def test_coarsening_keeps_ends_kinks_and_spacing():
    radius = np.linspace(0.0, 1.0, 41)
    track = NodalVariables(radius, np.zeros((41, 2)), (radius[10], radius[23]))
    for parity in (0, 1):
        bare = track.coarsened(1.0, np.full(41, 1.0), parity)
        assert {0.0, 1.0, radius[10], radius[23]} <= set(bare.radius)
        assert len(bare.radius) < 25
        assert bare.kinks == track.kinks
        assert len(track.coarsened(1.0, np.full(41, 0.049), parity).radius) == 41


def test_coarsening_in_the_root_of_the_distance():
    radius = np.linspace(0.0, 1.0, 41)
    root = columns(np.sqrt(radius))
    aware = NodalVariables(radius, root, (0.0,)).coarsened(1e-9, np.full(41, 1.0), 0)
    blind = NodalVariables(radius, root).coarsened(1e-9, np.full(41, 1.0), 0)
    assert len(aware.radius) == 21
    assert len(blind.radius) == 41


@given(
    st.lists(st.floats(0.0, 1.0), min_size=1, max_size=40),
    st.lists(st.floats(0.0, 1.0), max_size=3, unique=True),
    st.floats(1e-6, 0.2),
)
def test_distinct_radii(radii, fixed, smallest):
    kept = distinct(np.array(radii), tuple(fixed), smallest)
    assert np.all(np.diff(kept) > 0.0)
    assert set(fixed) <= set(kept)
    assert set(kept) <= {*radii, *fixed}
    close = np.diff(kept) < smallest
    both_fixed = np.isin(kept[1:], fixed) & np.isin(kept[:-1], fixed)
    assert not np.any(close & ~both_fixed)
    # nothing is dropped without a reason: every radius has a kept one nearby
    assert max(np.abs(kept - r).min() for r in radii) <= 2.0 * smallest


def test_an_edge_that_nears_the_last_node_has_more_of_them():
    edge, length = 1.0, 0.01
    first = nodes_beyond(edge, length)
    assert first[0] == pytest.approx(edge + length)
    assert first[-1] > 100.0 * edge
    assert len(nodes_beyond(edge, length, first[-1])) == 0
    grown = nodes_beyond(50.0 * edge, length, first[-1])
    assert grown.min() > first[-1]
    assert grown.max() == pytest.approx(50.0 * first[-1], rel=0.02)


def track_to(edge):
    return NodalVariables(np.array([0.0, edge]), np.zeros((2, 1)))


def test_kinks_near_the_edge_are_dropped_and_all_others_kept():
    many = tuple(0.01 * k for k in range(1, 20))
    before = SurfaceHistory(
        track_to(0.5), NodalVariables(np.array([0.5, 1.0]), np.zeros((2, 1)), (*many, 0.5)), 1, None
    )
    kinks, *_ = updated_kinks(before, 0.5, 0.51, 1e-4, 1e-6)
    assert kinks == many
    kinks, *_ = updated_kinks(before, 0.5, 0.1501, 1e-3, 1e-6)
    assert min(abs(k - 0.1501) for k in kinks) >= 1e-3


def test_a_kink_that_the_edge_comes_near_is_held_until_it_is_far():
    before = SurfaceHistory(
        track_to(0.2), NodalVariables(np.array([0.2, 1.0]), np.zeros((2, 1)), (0.15, 0.2)), -1, None
    )
    kinks, _, turning, _ = updated_kinks(before, 0.2, 0.1501, 1e-3, 1e-6)
    assert (kinks, turning) == ((), 0.15)
    before = SurfaceHistory(
        track_to(0.1501), NodalVariables(np.array([0.1501, 1.0]), np.zeros((2, 1)), (0.1501,)), -1, 0.15
    )
    kinks, _, turning, _ = updated_kinks(before, 0.1501, 0.14, 1e-3, 1e-6)
    assert (kinks, turning) == ((0.15,), None)
    kinks, _, turning, _ = updated_kinks(before, 0.1501, 0.15 + 1e-8, 1e-3, 1e-6)
    assert turning == 0.15


def test_nodes_around_an_edge():
    radii = np.array([0.1, 0.5, 0.9, 0.99])
    assert_allclose(graded_nodes(radii, 2.0, 0.3), [1.8, 1.98, 2.0, 2.2, 2.02])
    assert_allclose(midpoints_of_wide_intervals(np.array([0.0, 0.1, 1.0]), np.array([0.2, 0.2])), [0.55])
    assert_array_equal(SurfaceHistory.blank(3).radius, np.empty(0))


def test_beyond_the_last_node_strains_fall_as_far_from_a_load():
    empty = NodalVariables(np.empty(0), np.empty((0, 2)))
    history = SurfaceHistory(empty, NodalVariables(np.array([1.0, 4.0]), np.array([[8.0, 4.0], [2.0, 1.0]])))
    assert_allclose(
        history.outside(np.array([4.0, 8.0, 40.0])), [[2.0, 1.0], [1.0, 0.5], [0.2, 0.1]], rtol=1e-15
    )
