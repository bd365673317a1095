"""Dyadic steps and their error estimates."""

import pytest

from fem_solver.step_control import DyadicInterval, SlopeErrorEstimator


def test_interval_meets_the_end_exactly_with_few_distinct_steps():
    interval = DyadicInterval(0.1, 0.7)
    interval.limit(0.01, 1e-9)
    sizes, wishes = set(), [2, 1, 2, 2, 0, 2, 1, 2]
    steps = 0
    while not interval.done:
        assert interval.next_time == pytest.approx(interval.time + interval.dt, rel=1e-12)
        assert interval.next_time <= 0.7
        sizes.add(interval.dt)
        interval.advance()
        wish = wishes[steps % len(wishes)]
        steps += 1
        if wish == 2:
            interval.double()
        elif wish == 0:
            interval.halve()
    assert interval.time == 0.7
    assert len(sizes) < 10
    assert all(size in {0.6 * 2.0**-k for k in range(60)} or size > 0 for size in sizes)


def test_interval_never_goes_below_its_floor():
    interval = DyadicInterval(0.0, 1.0)
    interval.limit(1.0, 0.01)
    for _ in range(50):
        interval.halve()
    assert interval.shortest
    assert 0.005 < interval.dt <= 0.01


def test_estimator_sees_curvature_relative_to_its_scale_and_resets_at_kinks():
    estimator = SlopeErrorEstimator(tolerance=1e-3)
    assert estimator.error({"force": 5.0}, {"force": 1.0}, 0.1) == 0.0
    estimator.accept({"force": 5.0})
    small = estimator.error({"force": 5.1}, {"force": 1.0}, 0.1)
    assert small == pytest.approx(0.5 * 0.1 * 0.1 / 1e-3)
    assert estimator.error({"force": 5.1}, {"force": 10.0}, 0.1) == pytest.approx(small / 10)
    estimator.reset()
    assert estimator.error({"force": 50.0}, {"force": 1.0}, 0.1) == 0.0
