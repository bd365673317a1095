"""Steps onto limit points: found over the radius, in few evaluations, as accurate as other steps."""

import math
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.typing import NDArray
from support.paper_scenes import ZONE, cycle

from validation.measure.observables import observe
from validation.reference.tracking import Options, solve
from validation.reference.tracking.edge_path import PathOverRadius, path_over_radius
from validation.reference.tracking.limit_point_search import LimitPointSearch, expected_limit_point
from validation.reference.tracking.node_placement import NodePlacement
from validation.reference.tracking.recorder import stretch_over_radius
from validation.reference.tracking.row_extrapolation import RowExtrapolation
from validation.reference.tracking.step_error import StepErrorEstimator
from validation.reference.tracking.step_history import FORCE, PENETRATION, RADIUS, StepHistory
from validation.reference.tracking.trial import Trial

FINE = {
    0.002: (0.0107163265, 5.9286200e-4, 43.384602005),
    0.02: (0.0101854490, 4.7447486e-4, 2.5368103188),
    0.1: (0.0040323573, 2.3462057e-4, 0.5976143501),
}
"""Pull-off force, loop integral and detachment time of the cycles, with 60 steps per process zone."""
EVALUATIONS = {0.002: 535, 0.02: 420, 0.1: 415}
"""With 6 steps per process zone; 300 more where limit points are bisected."""


def _search(arrival: Callable[[float], float], reach: float, rows: list[tuple[float, float]]):  # type: ignore[no-untyped-def]
    """A search in a made-up problem, whose edge arrives at a distance at a known time."""
    asked: list[float] = []

    def residual(duration: float, radius: float) -> float:
        asked.append(radius)
        return (duration - arrival(radius - 1.0)) * (1.0 if reach < 0.0 else -1.0)

    def duration_to_radius(radius: float, longest: float) -> float | None:
        asked.append(radius)
        return arrival(radius - 1.0) if arrival(radius - 1.0) > 0.0 else None

    trial = SimpleNamespace(
        surface=SimpleNamespace(radius=1.0),
        condition=SimpleNamespace(tolerance=1e-12),
        residual=residual,
        duration_to_radius=duration_to_radius,
    )
    return LimitPointSearch(trial, rows, reach, 10.0), asked  # type: ignore[arg-type]


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_limit_point_is_found_in_few_evaluations(side: float) -> None:
    """The time of arrival has its maximum at 0.3, in either direction; the rows before show it at 0.29."""

    def arrival(distance: float) -> float:
        x = side * distance - 0.3
        return 0.05 + x**3 * 0.5 - x**2 - x**4 - (0.05 - 0.3**3 * 0.5 - 0.3**2 - 0.3**4)

    rows = [(0.0, 0.0), *((-side * x, arrival(-side * x) * 1.01) for x in (0.2, 0.4, 0.6))]
    search, asked = _search(arrival, side * 0.5, rows)
    found = search.find(1e-6, 1e-6)
    assert found is not None
    assert found[0] == pytest.approx(side * 0.3, abs=2e-5)
    assert found[1] == pytest.approx(arrival(side * 0.3), abs=1e-9)
    assert len(asked) < 25


def test_an_edge_that_only_slows_down_has_no_limit_point() -> None:
    search, _ = _search(lambda distance: -distance + 0.5 * distance**2, -0.5, [(0.0, 0.0)])
    found = search.find(1e-3, 1e-6)
    assert found is None or found[0] == pytest.approx(-0.5, abs=2e-3)


def test_an_edge_beyond_its_limit_point_is_not_taken_further() -> None:
    search, asked = _search(lambda distance: distance, -0.5, [(0.0, 0.0)])
    assert search.find(1e-3, 1e-6) is None
    assert len(asked) < 20


def test_expected_limit_point_is_that_of_the_cubic() -> None:
    points = [(x, 3.0 * x - x**3) for x in (0.0, -0.4, -0.7, 0.3)]
    assert expected_limit_point(points, 0.0, 2.0) == pytest.approx((1.0, 2.0))
    assert expected_limit_point(points, 0.0, 0.9) is None
    assert expected_limit_point(points[:2], 0.0, 2.0) is None
    assert expected_limit_point([(x, x * x) for x in (0.0, -0.4, 0.3)], -1.0, 1.0) is None


def test_path_towards_a_limit_point_is_a_parabola_of_the_time() -> None:
    """Exact for it, with the rows before on the same parabola; the edge arrives with unlimited speed."""
    rows = RowExtrapolation((0.0, 0.1, 0.2), tuple((d + 0.3) ** 2 * -1.0 + 0.09 for d in (0.0, 0.1, 0.2)))
    path = path_over_radius(rows, 0.08, 1.0, 0.8)
    x = np.linspace(0.8, 1.0, 9)
    np.testing.assert_allclose(path.passing(x), (0.09 - (x - 1.0 + 0.3) ** 2) / 0.08, atol=1e-14)
    np.testing.assert_allclose(path(path.passing(x)), x, atol=1e-14)
    assert path.end_slope == pytest.approx(0.08 / (-2.0 * 0.1))
    onto = path_over_radius(rows, 0.09, 1.0, 0.7)
    assert abs(onto.end_slope) >= 50.0 * 0.3
    assert not PathOverRadius(1.0, 0.0, (0.0,)).passing(x).any()


def test_path_towards_a_limit_point_over_zones_is_the_polynomial_through_all_rows() -> None:
    """Exact for a time that is a cubic of the radius, in steps that pass over process zones."""

    def time(distance: NDArray[np.float64]) -> NDArray[np.float64]:
        return 0.3 * (0.09 - (distance + 0.3) ** 2) - 0.4 * (distance**3 + 0.027) + 0.4 * 0.027

    distances = np.array([0.0, 0.1, 0.2, 0.35])
    rows = RowExtrapolation(tuple(distances), tuple(time(distances)))
    path = path_over_radius(rows, float(time(np.array(-0.25))), 1.0, 0.75, whole=True)
    x = np.linspace(0.75, 1.0, 9)
    np.testing.assert_allclose(path.passing(x), time(x - 1.0) / time(np.array(-0.25)), atol=1e-13)
    fractions = np.linspace(0.0, 1.0, 9)
    nodes = path(fractions)
    assert (np.diff(nodes) < 0.0).all()
    np.testing.assert_allclose(nodes[[0, -1]], (1.0, 0.75), atol=1e-13)


def test_path_goes_on_smoothly_beyond_a_limit_point() -> None:
    """Trial steps of the search end there: a kink would be taken for the limit point."""
    rows = RowExtrapolation((0.0, 0.1, 0.2), tuple((d + 0.3) ** 2 * -1.0 + 0.09 for d in (0.0, 0.1, 0.2)))
    ends = 0.7 + np.linspace(-0.02, 0.02, 9)
    durations = 0.09 - (ends - 0.7) ** 2
    paths = [path_over_radius(rows, float(t), 1.0, float(a)) for t, a in zip(durations, ends, strict=True)]
    steps = zip(durations, paths, strict=True)
    passed = np.array([duration * path.passing(np.array([0.8]))[0] for duration, path in steps])
    np.testing.assert_allclose(passed, 0.08, atol=1e-13)
    assert paths[0].bends[0] < -1.0 < paths[-1].bends[0]
    for path in paths:
        inner = path(np.linspace(0.1, 0.95, 20))
        assert (np.diff(inner) < 0.0).all()
        assert path.end_slope < 0.0


@pytest.mark.parametrize("outward", [False, True])
def test_expected_duration_saves_evaluations(outward: bool) -> None:
    """An edge that arrives at a known time; a guess beyond the search interval is no harm."""
    trial = object.__new__(Trial)
    asked: list[float] = []
    side = -1.0 if outward else 1.0

    def residual(duration: float, _: float) -> float:
        asked.append(duration)
        return side * (math.expm1(duration) - math.expm1(0.3))

    given = {
        "surface": SimpleNamespace(radius=1.0),
        "condition": SimpleNamespace(tolerance=1e-10),
        "nodes": SimpleNamespace(shortest=1.0),
        "residual": residual,
    }
    for name, value in given.items():
        object.__setattr__(trial, name, value)
    counts = []
    for guess in (0.30002, 0.0, 2.0):
        asked.clear()
        found = trial.duration_to_radius(1.1 if outward else 0.9, 1.0, guess)
        assert found == pytest.approx(0.3, abs=1e-9)
        counts.append(len(asked))
    assert counts[0] <= 4 < counts[1] == counts[2]


def test_time_at_a_limit_point_has_no_slope_there() -> None:
    history = StepHistory()
    for radius in (1.3, 1.2, 1.1, 1.0):
        history.add((5.0 - (radius - 1.0) ** 2 * (2.0 + radius), radius, 0.0, 0.0))
    quotient = history.time_over_radius().over_square()
    assert quotient.value_after(0.05) == pytest.approx(-3.05)
    history.add((6.0, 1.05, 0.0, 0.0))
    assert len(history.time_over_radius().times) == 2  # the edge has turned


def test_rows_before_a_limit_point_are_even_in_the_root_of_the_distance() -> None:
    """Straight lines between so many rows leave the root by no more than what is allowed."""
    history = StepHistory([(0.0, 1.0, 1.0, 0.0)])
    estimator = StepErrorEstimator(
        history, 1e-4, (RADIUS, FORCE), {RADIUS: 1.0, FORCE: 1.0, PENETRATION: 1.0}
    )
    for left in (0.0, 0.01):
        count = estimator.intervals_before_limit_point((1.0, 0.99, 0.99, 0.0), left, 1.0)
        root = np.linspace(np.sqrt(0.01 + left), np.sqrt(left), count + 1)
        time = np.linspace(-(root[0] ** 4), -(root[-1] ** 4), 4001)
        off = np.interp(time, -(root**4), root**2) - np.sqrt(-time)
        assert np.abs(off).max() <= 1.05e-4
        assert count <= 8


def test_a_stretch_over_the_radius_ends_where_the_edge_turned() -> None:
    radius = np.array([1.0, 0.9, 1.0, 0.8, 0.7, 0.6])
    assert stretch_over_radius(radius, 4, 0) == 2
    assert stretch_over_radius(radius, 4, 3) == 3


def test_nodes_in_a_relaxing_layer_come_closer_with_the_tolerance() -> None:
    nearest = [
        1.0 - NodePlacement(1.0, 1e-3, ZONE, 16.0, deviation).fractions(1.0)[-1]
        for deviation in (8e-5, 1e-5, 1.25e-6)
    ]
    assert nearest[0] < 0.2
    np.testing.assert_allclose(nearest[:2], np.array(nearest[1:]) * 2.0, rtol=0.15)


@pytest.mark.parametrize("rate", [0.002, pytest.param(0.02, marks=pytest.mark.slow), 0.1])
def test_cycles_of_the_paper_take_few_evaluations(rate: float) -> None:
    trace = solve(cycle(rate), Options(resolution=6))
    assert trace.counters.closure_evaluations < EVALUATIONS[rate]
    seen = observe(trace)
    force, work, time = FINE[rate]
    assert seen.pull_off_force == pytest.approx(force, rel=1e-6)
    assert seen.loop_energy == pytest.approx(work, rel=1e-6)
    assert seen.detachment_time == pytest.approx(time, rel=5e-7)
