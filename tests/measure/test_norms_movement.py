"""Curves between sparse rows, and differences relative to what a curve does in a window of the run."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from contact_scene import (
    Counters,
    Force,
    ForceRamp,
    Hold,
    Loading,
    Oscillate,
    Outcome,
    OutcomeKind,
    Ramp,
    Sweep,
    Trace,
)
from validation.measure.curves import (
    LEAST_EXCURSION,
    POINTS,
    WEIGHTS,
    RowCurve,
    column_curve,
    distance,
    interpolation_error,
    movement_bound,
    movement_distance,
    parting_time,
)
from validation.measure.windows import corners, windows


def run(time, force, radius=None, penetration=None) -> Trace:
    t = np.asarray(time, float)
    zero = np.zeros_like(t)
    return Trace(
        solver="bem",
        time=t,
        penetration=zero if penetration is None else np.asarray(penetration, float),
        force=np.asarray(force, float),
        contact_radius=zero + 1.0 if radius is None else np.asarray(radius, float),
        stored_energy=zero,
        external_work=zero,
        dissipated_energy=zero,
        outcome=Outcome(OutcomeKind.COMPLETED, "by hand", float(t[-1])),
        counters=Counters(),
    )


def test_points_and_weights_integrate_the_square_of_a_cubic():
    for power in range(7):
        assert WEIGHTS @ POINTS**power == pytest.approx(1.0 / (power + 1.0))


def test_a_parabola_is_followed_between_sparse_rows():
    """Straight lines through nine rows would miss it by h^2/8 = 0.2 %."""
    sparse, dense = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 801)
    apart = distance(run(sparse, sparse + sparse**2), run(dense, dense + dense**2))
    assert apart.largest < 2.5e-4
    assert interpolation_error(run(sparse, sparse + sparse**2), "force") == pytest.approx(apart.rms, rel=1e-6)


def test_a_value_between_rows_is_on_the_curve_of_the_norms():
    """A parabola over nine rows, whose straight lines are off by h^2/4 = 0.4 % in the middle."""
    rows = np.linspace(0.0, 1.0, 9)
    curve = RowCurve(rows, rows + rows**2)
    for middle in rows[1:-2] + 0.0625:
        assert curve.at(float(middle)) == pytest.approx(middle + middle**2, abs=4e-4)
    assert curve.at(float(rows[3])) == pytest.approx(rows[3] + rows[3] ** 2, rel=1e-14)
    straight = np.interp(0.5625, rows, rows + rows**2)
    assert straight - (0.5625 + 0.5625**2) > 3e-3


@pytest.mark.parametrize("rows", [13, 25, 49])
def test_the_interpolation_error_is_of_the_size_of_the_true_one(rows):
    sparse, dense = np.linspace(0.0, 3.0, rows) ** 1.25, np.linspace(0.0, 3.0**1.25, 4001)
    shown = run(sparse, np.sin(2.0 * sparse))
    apart = distance(shown, run(dense, np.sin(2.0 * dense)))
    assert 0.3 * apart.rms < interpolation_error(shown, "force") < 10.0 * apart.rms


def test_corners_and_jumps_are_not_rounded():
    t = np.array([0.0, 1.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0])
    corner = np.array([0.0, 1.0, 2.0, 3.0, 7.0, 5.0, 3.0, 1.0])
    assert np.allclose(RowCurve(t, corner).within(np.arange(4.0))[2], [0.5, 1.5, 2.5])
    assert np.allclose(RowCurve(t, corner).within(np.arange(3.0, 7.0))[2], [6.0, 4.0, 2.0])
    roof = 3.0 - np.abs(np.arange(7.0) - 3.0)
    assert np.allclose(
        RowCurve(np.arange(7.0), roof).within(np.arange(7.0))[2], roof[:-1] + 0.5 * np.diff(roof)
    )


def test_a_corner_between_long_and_short_steps_is_not_rounded():
    """Beyond it the curve bends on a scale that the long steps before it know nothing of."""
    short = 0.01 * np.cumsum(1.3 ** np.arange(12.0))
    t = np.concatenate((np.arange(4.0), 3.0 + short))
    force = np.minimum(t, 3.0) - 0.4 * (1.0 - np.exp(-np.maximum(t - 3.0, 0.0) / 0.2))
    assert RowCurve(t, force).at(2.5) == pytest.approx(2.5, abs=1e-12)
    assert RowCurve(t[-1] - t[::-1], force[::-1]).at(t[-1] - 2.5) == pytest.approx(2.5, abs=1e-12)


@pytest.mark.parametrize("kind", [distance, movement_distance])
def test_a_curve_has_a_corner_where_an_edge_at_rest_sets_off(kind):
    """The slope changes there no more than over the short steps after it: no corner by itself."""
    time = np.concatenate((np.arange(6.0), 5.0 + 1e-3 * np.arange(1.0, 8.0)))
    force = np.where(time < 5.0, time, 5.0 + 1e3 * ((time - 5.0) ** 2 - 2e-3 * (time - 5.0)))
    radius = np.where(time <= 5.0, 1.0, 6.0 - time)
    spans = () if kind is distance else (np.array([[0.0, time[-1]]]),)
    dense = np.union1d(time, np.linspace(0.0, 5.0, 501))
    line = run(dense, np.interp(dense, time, force), np.interp(dense, time, radius))
    assert kind(run(time, force, radius), line, *spans).rms < 1e-12
    assert kind(run(time, force), line, *spans).rms > 0.005
    assert column_curve(run(time, force, radius), "force").at(4.5) == pytest.approx(4.5, abs=1e-12)


def test_no_curve_leaves_the_range_of_its_two_rows():
    rng = np.random.default_rng(5)
    for _ in range(50):
        t = np.cumsum(10.0 ** rng.uniform(-9, 0, 12))
        x = np.cumsum(rng.normal(size=12) * 10.0 ** rng.uniform(-6, 3, 12))
        at = RowCurve(t, x).within(t)
        slack = 1e-12 * np.abs(x).max()
        assert np.all(at >= np.minimum(x[1:], x[:-1]) - slack)
        assert np.all(at <= np.maximum(x[1:], x[:-1]) + slack)


RAMP, SHAKE = Ramp(1.0, 1.0), Oscillate(0.01, 2.0 * np.pi, 4.0)
LOADING = Loading("relaxed", 0.0, (RAMP, SHAKE))
TIME = np.linspace(0.0, 5.0, 2001)
EDGE = np.minimum(TIME, 1.0) + np.where(TIME > 1.0, 0.005 * np.sin(2.0 * np.pi * (TIME - 1.0)), 0.0)


def moved(other, loading=LOADING):
    base = run(TIME, TIME, EDGE, np.minimum(TIME, 1.0))
    return movement_distance(run(TIME, TIME, other), base, windows(loading, base), "contact_radius")


def test_an_edge_that_freezes_in_a_small_oscillation_stands_out():
    """It travels by 1 % of the radius; frozen in the last cycle it is 0.1 % of the whole off."""
    frozen = np.where(TIME > 4.0, 1.0, EDGE)
    base = run(TIME, TIME, EDGE)
    apart = distance(run(TIME, TIME, frozen), base, "contact_radius")
    assert apart.rms < 2e-3
    found = moved(frozen)
    assert found.rms == pytest.approx(np.sqrt(0.5) / 2.0, rel=1e-3)
    assert (found.begin, found.end) == pytest.approx((4.0, 5.0))


def test_a_contact_too_large_by_a_constant_moves_as_it_should():
    assert moved(EDGE + 0.003).rms < 1e-6
    assert moved(EDGE).rms == 0.0
    assert (
        moved(np.where(TIME > 1.0, EDGE + 0.003, EDGE)).rms < 0.1
    )  # the ramp's end, in the first window only


def test_what_hardly_moves_is_divided_by_no_less_than_the_tolerance_of_curves():
    base = run(TIME, TIME, np.ones_like(TIME))
    shaken = run(TIME, TIME, 1.0 + 1e-6 * np.sin(TIME))
    found = movement_distance(shaken, base, windows(LOADING, base), "contact_radius")
    assert found.rms <= 1e-6 / LEAST_EXCURSION
    assert movement_distance(base, shaken, windows(LOADING, base), "contact_radius").rms < 1e-3


def test_the_bound_of_the_movement_covers_every_window():
    base = run(TIME, TIME, EDGE)
    frozen = run(TIME, TIME, np.where(TIME > 4.0, 1.0, EDGE))
    spans = windows(LOADING, base)
    size = distance(frozen, base, "contact_radius").rms
    assert movement_distance(frozen, base, spans, "contact_radius").rms <= size * movement_bound(
        base, spans, "contact_radius"
    )


def test_windows_are_the_run_its_load_steps_and_its_whole_cycles():
    base = run([0.0, 1.0, 4.5], [0, 0, 0], penetration=[0.0, 1.0, 1.0])
    spans = [(0.0, 4.5), (0.0, 1.0), (1.0, 4.5), (1.0, 2.0), (2.0, 3.0), (3.0, 4.0)]
    assert windows(LOADING, base) == pytest.approx(np.array(spans))
    chirped = Loading("relaxed", 0.0, (Sweep(0.1, 4.0 * np.pi, 2.0), Hold(1.0)))
    ends = [0.0, 1.0, np.sqrt(2.0), np.sqrt(3.0), 2.0]
    spans = [(0.0, 3.0), (0.0, 2.0), *pairwise(ends), (2.0, 3.0)]
    assert windows(chirped, run([0.0, 3.0], [0, 0])) == pytest.approx(np.array(spans))


def test_the_state_in_which_a_load_step_begins_is_that_of_the_run():
    """Under force control the penetration is found by the run: 0.5 when the ramp to 2 begins."""
    steps = Force(1.0, 1.0), ForceRamp(3.0, 2.0), Ramp(2.0, 1.0), Hold(1.0)
    loading = Loading("relaxed", 0.0, steps)
    base = run([0.0, 1.0, 2.0, 3.5, 4.5], [1.0, 1.0, 3.0, 9.0, 8.0], penetration=[0.0, 0.25, 0.5, 2.0, 2.0])
    spans = [(0.0, 4.5), (0.0, 1.0), (1.0, 2.0), (2.0, 3.5), (3.5, 4.5)]
    assert windows(loading, base) == pytest.approx(np.array(spans))


def test_a_load_step_that_ends_at_a_level_does_so_where_the_run_reaches_it():
    """Cycles after it have windows of their own; a level that is not reached ends with the ramp."""
    steps = Ramp(1.0, 0.1, until_force=4.0), Hold(1.0), Oscillate(0.1, 2.0 * np.pi, 2.0)
    base = run([0.0, 1.0, 2.0, 3.0, 5.0], [0.0, 1.0, 4.0, 3.5, 3.0], penetration=[0.0, 0.1, 0.2, 0.2, 0.2])
    spans = [(0.0, 5.0), (0.0, 2.0), (2.0, 3.0), (3.0, 5.0), (3.0, 4.0), (4.0, 5.0)]
    assert windows(Loading("relaxed", 0.0, steps), base) == pytest.approx(np.array(spans))
    assert corners(Loading("relaxed", 0.0, steps), base) == pytest.approx([0.0, 2.0, 3.0, 5.0])
    never = Loading("relaxed", 0.0, (replace(steps[0], until_force=9.0), *steps[1:]))
    assert windows(never, base) == pytest.approx(np.array([(0.0, 5.0), (0.0, 5.0)]))


def test_a_curve_turns_where_a_load_step_begins_even_if_the_rows_before_are_sparse():
    """A hold in long steps, then a ramp in short ones: their ratio hides the corner."""

    def force(t):
        past = np.maximum(t - 10.0, 0.0)
        return 1e-4 * (10.0 - np.minimum(t, 10.0)) - 0.4 * past + 1.5 * past**2

    sparse = np.concatenate([np.linspace(0.0, 10.0, 65), 10.0 + 0.005 * np.arange(1, 17)])
    dense = np.concatenate([np.linspace(0.0, 10.0, 641), 10.0 + 5e-5 * np.arange(1, 1601)])
    end = np.nextafter(10.0, 0.0)  # of the step, to round-off
    spans = np.array([[0.0, end], [end, 10.08]])
    moved = movement_distance(run(sparse, force(sparse)), run(dense, force(dense)), spans)
    assert moved.rms < 1e-5


def test_curves_have_corners_where_load_steps_end():
    """A ramp, then a swing three times as steep: too little to be told from a bend."""

    def force(t):
        return np.where(t < 0.5, t, 0.5 + 0.03 * np.sin(100.0 * (t - 0.5)))

    before, after = np.linspace(0.0, 0.5, 6), 0.5 + 0.005 * np.arange(1, 101)
    rows, dense = np.concatenate([before, after]), np.linspace(0.0, 1.0, 4001)
    one, two = run(rows, force(rows)), run(dense, force(dense))
    spans = np.array([[0.0, 1.0], [0.0, 0.5], [0.5, 1.0]])
    assert distance(one, two, spans=spans).rms < 4e-4 < 4e-3 < distance(one, two).rms
    assert interpolation_error(one, "force", spans) < 3e-4 < 4e-3 < interpolation_error(one, "force")


def test_a_jump_at_times_that_rounding_holds_apart_is_one():
    jump = np.nextafter(0.5, 1.0)
    one = run([0.0, 0.5, 0.5, 1.0], [0.0, 0.0, 1.0, 1.0])
    two = run([0.0, jump, jump, 1.0], [0.0, 0.0, 1.0, 1.0])
    apart, spans = distance(one, two), np.array([[0.0, 1.0], [0.5, 1.0]])
    assert (apart.rms, apart.mean, apart.largest) == (0.0, 0.0, 0.0)
    assert movement_distance(one, two, spans).rms == 0.0
    assert parting_time(one, two, 1e-3) is None
    later = run([0.0, 0.51, 0.51, 1.0], [0.0, 0.0, 1.0, 1.0])
    assert distance(one, later).rms == pytest.approx(0.1)


@pytest.mark.parametrize("exponent", [2.0, 3.0, 10.0])
@pytest.mark.parametrize("ends", [False, True])
def test_a_radius_that_begins_as_any_root_of_the_time_is_uncertain_by_more_than_the_rows_miss(exponent, ends):
    fine = np.concatenate(([0.0], np.geomspace(1e-12, 1.0, 4000)))
    t = np.concatenate(([0.0], fine[fine > 1e-2]))
    times, exact = (1.0 - t[::-1], 1.0 - fine[::-1]) if ends else (t, fine)
    radius = [(1.0 - one if ends else one) ** (1.0 / exponent) for one in (times, exact)]
    rough, right = (run(one, 0.0 * one, a) for one, a in zip((times, exact), radius, strict=True))
    missed = distance(rough, right, "contact_radius").rms
    assert missed <= interpolation_error(rough, "contact_radius") <= 6.0 * missed
