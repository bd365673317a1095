"""Dyadic steps and their error estimates."""

import itertools
import math

import numpy as np
import pytest

from fem_solver.step_control import DyadicInterval, Slopes, missed_peak


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


def test_the_begin_of_a_long_hold_is_resolved_in_its_own_time():
    interval = DyadicInterval(2.0, 1e17)
    interval.limit(1.0 / 32.0, 1e-6)
    assert 1.0 / 64.0 < interval.dt <= 1.0 / 32.0
    steps = 0
    while not interval.done:
        assert interval.next_time > interval.time
        interval.advance()
        interval.double()
        steps += 1
    assert interval.time == 1e17
    assert steps < 70


def test_a_step_taken_back_is_taken_in_halves():
    interval = DyadicInterval(0.0, 1.0)
    interval.limit(0.25, 1e-3)
    interval.advance()
    first = interval.position
    interval.advance()
    assert interval.divisible(first)
    interval.take_back(first)
    assert (interval.time, interval.dt) == (0.25, 0.125)
    interval.limit(0.25, 0.25)
    interval.advance()
    assert not interval.divisible(first)


def test_missed_peak_is_the_corner_above_the_chord():
    # up at slope 2 for a time of 0.3, then down at slope 4: the row at 1 misses the corner
    level = 0.6 - 4.0 * 0.7
    assert missed_peak(2.0, level, 4.0, 1.0) == pytest.approx(0.6 - level)
    assert missed_peak(math.inf, 1.0, 3.0, 0.5) == 1.5
    assert missed_peak(3.0, 1.0, math.inf, 0.5) == 1.0
    assert missed_peak(1.0, 2.0, 3.0, 1.0) == 0.0  # convex: no corner above the chord


@pytest.mark.parametrize("allowed", [1e-3, 1e-2])
def test_an_error_is_what_rows_miss_of_a_curve_relative_to_what_is_allowed(allowed):
    """A line behind a kink, then a parabola, whose third order is told as the square of the step."""
    lengths, cubic = (0.1, 0.3, 0.2), np.polynomial.Polynomial((1.0, -2.0, 3.0, 7.0))
    times = np.cumsum((0.0, *lengths))
    slopes, errors = Slopes(), []
    for begin, end in itertools.pairwise(times):
        slope = {"force": (cubic(end) - cubic(begin)) / (end - begin)}
        errors.append(slopes.error(slope, {"force": allowed}, end - begin))
        slopes = slopes.followed(slope, end - begin)
    assert errors[0] == 0.0
    first, second = np.diff(cubic(times[:3])) / lengths[:2]
    assert errors[1] == pytest.approx(0.5 * abs(second - first) * 0.3 / allowed)
    missed = 7.0 * 0.2 * 0.5 * 0.6  # the last divided difference is 7
    assert errors[2] == pytest.approx((0.5 * missed / allowed) ** (2.0 / 3.0))


def test_steps_grow_up_to_the_ceiling():
    interval, lengths = DyadicInterval(1.0, 3.0, ceiling=0.25), []
    interval.limit(1.0, 1e-6)
    assert interval.dt == 0.25
    interval.halve()
    while not interval.done:
        lengths.append(interval.dt)
        interval.advance()
        interval.double()
    assert lengths == [0.125, 0.125, *[0.25] * 7]
