"""Dyadic steps and their judgement."""

import pytest

from fem_solver.step_control import Clock, Judge


def test_clock_meets_the_end_exactly_with_few_distinct_steps():
    clock = Clock(0.1, 0.7)
    clock.limit(0.01, 1e-9)
    sizes, wishes = set(), [2, 1, 2, 2, 0, 2, 1, 2]
    steps = 0
    while not clock.done:
        assert clock.next_time == pytest.approx(clock.time + clock.dt, rel=1e-12)
        assert clock.next_time <= 0.7
        sizes.add(clock.dt)
        clock.advance()
        wish = wishes[steps % len(wishes)]
        steps += 1
        if wish == 2:
            clock.double()
        elif wish == 0:
            clock.halve()
    assert clock.time == 0.7
    assert len(sizes) < 10
    assert all(size in {0.6 * 2.0**-k for k in range(60)} or size > 0 for size in sizes)


def test_clock_never_goes_below_its_floor():
    clock = Clock(0.0, 1.0)
    clock.limit(1.0, 0.01)
    for _ in range(50):
        clock.halve()
    assert clock.shortest
    assert 0.005 < clock.dt <= 0.01


def test_judge_sees_curvature_relative_to_its_scale_and_forgets_at_kinks():
    judge = Judge(tolerance=1e-3, travel=1.0)
    assert judge.error({"force": 5.0}, {"force": 1.0}, 0.1) == 0.0
    judge.accept({"force": 5.0})
    small = judge.error({"force": 5.1}, {"force": 1.0}, 0.1)
    assert small == pytest.approx(0.5 * 0.1 * 0.1 / 1e-3)
    assert judge.error({"force": 5.1}, {"force": 10.0}, 0.1) == pytest.approx(small / 10)
    judge.forget()
    assert judge.error({"force": 50.0}, {"force": 1.0}, 0.1) == 0.0
