"""Curves between sparse rows, windows of a run, and differences of curves by size and by movement."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from support.synthetic_traces import by_hand

import contact_scene as cs
from validation.measure import curves
from validation.measure.windows import corners, windows


def run(time, force, radius=1.0, penetration=0.0) -> cs.Trace:
    return by_hand(time, force=force, contact_radius=radius, penetration=penetration)


def test_points_and_weights_integrate_the_square_of_a_cubic():
    for power in range(7):
        assert curves.WEIGHTS @ curves.POINTS**power == pytest.approx(1.0 / (power + 1.0))


def test_a_parabola_is_followed_between_sparse_rows():
    """Straight lines through nine rows would miss it by h^2/8 = 0.2 % of 2."""
    sparse, dense = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 801)
    for rise in (1.0, -0.53):  # with an extremum between two rows
        apart = curves.distance(run(sparse, rise * sparse + sparse**2), run(dense, rise * dense + dense**2))
        assert apart.largest < 1e-13
        assert 0.0 < curves.interpolation_error(run(sparse, rise * sparse + sparse**2), "force") < 2e-2


@pytest.mark.parametrize("rows", [13, 25, 49])
def test_the_interpolation_error_is_of_the_size_of_the_true_one(rows):
    sparse, dense = np.linspace(0.0, 3.0, rows) ** 1.25, np.linspace(0.0, 3.0**1.25, 4001)
    shown = run(sparse, np.sin(2.0 * sparse))
    apart = curves.distance(shown, run(dense, np.sin(2.0 * dense)))
    assert 0.3 * apart.rms < curves.interpolation_error(shown, "force") < 10.0 * apart.rms


@pytest.mark.parametrize("exponent", [2.0, 3.0, 10.0])
@pytest.mark.parametrize("ends", [False, True])
def test_a_radius_that_begins_as_any_root_of_the_time_is_uncertain_by_more_than_the_rows_miss(exponent, ends):
    fine = np.concatenate(([0.0], np.geomspace(1e-12, 1.0, 4000)))
    t = np.concatenate(([0.0], fine[fine > 1e-2]))
    times, exact = (1.0 - t[::-1], 1.0 - fine[::-1]) if ends else (t, fine)
    radius = [(1.0 - one if ends else one) ** (1.0 / exponent) for one in (times, exact)]
    rough, right = (run(one, 0.0 * one, a) for one, a in zip((times, exact), radius, strict=True))
    missed = curves.distance(rough, right, "contact_radius").rms
    assert missed <= curves.interpolation_error(rough, "contact_radius") <= 6.0 * missed


def test_jumps_and_corners_are_not_rounded_and_a_curve_leaves_its_rows_by_no_more_than_it_bends_at_both():
    t = np.array([0.0, 1.0, 2.0, 3.0, 3.0, 4.0, 5.0, 6.0])
    force = np.array([0.0, 1.0, 2.0, 3.0, 7.0, 5.0, 3.0, 1.0])
    assert np.allclose(curves.RowCurve(t, force).within(np.arange(4.0))[2], [0.5, 1.5, 2.5])
    assert np.allclose(curves.RowCurve(t, force).within(np.arange(3.0, 7.0))[2], [6.0, 4.0, 2.0])
    short = 0.01 * np.cumsum(1.3 ** np.arange(12.0))  # beyond long steps, on a scale they know nothing of
    t = np.concatenate((np.arange(4.0), 3.0 + short))
    force = np.minimum(t, 3.0) - 0.4 * (1.0 - np.exp(-np.maximum(t - 3.0, 0.0) / 0.2))
    assert curves.RowCurve(t, force).at(2.5) == pytest.approx(2.5, abs=1e-12)
    assert curves.RowCurve(t[-1] - t[::-1], force[::-1]).at(t[-1] - 2.5) == pytest.approx(2.5, abs=1e-12)
    rng = np.random.default_rng(5)
    for _ in range(50):
        t = np.cumsum(10.0 ** rng.uniform(-9, 0, 12))
        x = np.cumsum(rng.normal(size=12) * 10.0 ** rng.uniform(-6, 3, 12))
        bend = 2.0 * np.diff(np.diff(x) / np.diff(t)) / (t[2:] - t[:-2])
        smaller = np.minimum(np.abs(bend[1:]), np.abs(bend[:-1])) * (bend[1:] * bend[:-1] > 0.0)
        more = 0.25 * np.diff(t) ** 2 * np.concatenate(([0.0], smaller, [0.0]))
        at, slack = curves.RowCurve(t, x).within(t), 1e-12 * np.abs(x).max() + more
        assert np.all(at >= np.minimum(x[1:], x[:-1]) - slack)
        assert np.all(at <= np.maximum(x[1:], x[:-1]) + slack)


@pytest.mark.parametrize("kind", [curves.distance, curves.movement_distance])
def test_a_curve_has_a_corner_where_an_edge_at_rest_sets_off(kind):
    """The slope changes there no more than over the short steps after it: no corner by itself."""
    time = np.concatenate((np.arange(6.0), 5.0 + 1e-3 * np.arange(1.0, 8.0)))
    force = np.where(time < 5.0, time, 5.0 + 1e3 * ((time - 5.0) ** 2 - 2e-3 * (time - 5.0)))
    radius = np.where(time <= 5.0, 1.0, 6.0 - time)
    spans = () if kind is curves.distance else (np.array([[0.0, time[-1]]]),)
    dense = np.union1d(time, np.linspace(0.0, 5.0, 501))
    line = run(dense, np.interp(dense, time, force), np.interp(dense, time, radius))
    assert kind(run(time, force, radius), line, *spans).rms < 1e-12
    assert kind(run(time, force), line, *spans).rms > 0.005


SMOOTH = {
    "decay": lambda t: 1.0 + np.exp(-t),
    "growth": np.exp,
    "root": np.sqrt,
    "power": lambda t: t**3.7,
    "tanh": lambda t: np.tanh(t - 8.0),
    "swing": lambda t: 2.0 + np.sin(2.0 * t),
}


@pytest.mark.parametrize("step", [0.3, 1.0, 2.0])
@pytest.mark.parametrize("edge", SMOOTH)
def test_a_smooth_motion_of_the_edge_has_no_corner_however_coarse_its_rows(edge, step):
    time = np.arange(0.0, 20.0, step)
    assert curves.edge_turns(time, SMOOTH[edge](time)).size == 0


def test_the_interpolation_error_of_a_coarse_decay_is_of_the_size_of_the_true_one():
    sparse, dense = np.arange(0.0, 12.1, 1.5), np.linspace(0.0, 12.0, 1201)
    rough, right = (run(t, np.exp(-t), 1.0 + np.exp(-t)) for t in (sparse, dense))
    missed = curves.distance(rough, right).rms
    assert 0.3 * missed < curves.interpolation_error(rough, "force") < 10.0 * missed


@pytest.mark.parametrize("size", [1e-300, 1e-4, 1.0])
def test_an_edge_turns_where_it_sets_off_and_where_it_comes_to_rest(size):
    """Between two rows at one time it does not rest."""
    time = np.array([0.0, 1.0, 2.0, 2.5, 3.0, 3.0, 4.0, 5.0, 6.0])
    radius = size * np.array([1.0, 1.0, 1.0, 1.5, 2.0, 2.0, 3.0, 3.0, 3.0])
    assert curves.edge_turns(time, radius).tolist() == [2.0, 4.0]


@pytest.mark.parametrize("after", [-0.5, -1e-6, 1e-6, 0.1, 10.0])
def test_an_edge_turns_where_its_speed_jumps_between_smooth_motions(after):
    time = np.concatenate((np.arange(0.0, 2.1, 0.2), 2.0 + 1e-2 * np.arange(1.0, 9.0)))
    smooth = 0.02 * np.sin(time)
    radius = 1.0 + np.minimum(time, 2.0) + after * np.maximum(time - 2.0, 0.0) + min(after, 1.0) * smooth
    assert curves.edge_turns(time, radius) == pytest.approx([2.0])


def test_curves_have_corners_where_load_steps_end():
    """A ramp, then a swing three times as steep: too little to be told from a bend."""

    def force(t):
        return np.where(t < 0.5, t, 0.5 + 0.03 * np.sin(100.0 * (t - 0.5)))

    before, after = np.linspace(0.0, 0.5, 6), 0.5 + 0.005 * np.arange(1, 101)
    rows, dense = np.concatenate([before, after]), np.linspace(0.0, 1.0, 4001)
    one, two = run(rows, force(rows)), run(dense, force(dense))
    end = np.nextafter(0.5, 0.0)  # of the step, to round-off
    spans = np.array([[0.0, 1.0], [0.0, end], [end, 1.0]])
    assert curves.distance(one, two, spans=spans).rms < 4e-4 < 4e-3 < curves.distance(one, two).rms
    assert (
        curves.interpolation_error(one, "force", spans)
        < 3e-4
        < 4e-3
        < curves.interpolation_error(one, "force")
    )


@pytest.mark.parametrize(
    ("one", "two", "expected"),
    [
        (([0, 2], [0, 4]), ([0, 1, 2], [0, 2, 2]), (0.25, (4 / 3 / 2) ** 0.5 / 2, 1.0, 2.0)),
        (([0, 2], [-1, 1]), ([0, 2], [1, -1]), (1.0, (4 / 3) ** 0.5, 2.0, 0.0)),  # across zero
        (([0, 1, 1, 2], [0, 0, 2, 2]), ([0, 1.5, 1.5, 2], [0, 0, 2, 2]), (0.25, 0.5, 1.0, 1.0)),
        (([0, 0, 1], [5, 1, 1]), ([0, 1], [1, 1]), (0.0, 0.0, 0.0, 0.0)),  # a jump at the first row
        (([0, 1], [1, 1]), ([0, 4], [1, 1]), (0.0, 0.0, 0.0, 0.0)),  # as far as the shorter goes
    ],
)
def test_norms_by_hand(one, two, expected):
    apart = curves.distance(run(*one), run(*two))
    found = apart.mean, apart.rms, apart.largest, apart.at
    assert found == pytest.approx(expected)


def test_jumps_that_rounding_holds_apart_are_one_and_others_part():
    jump, spans = np.nextafter(0.5, 1.0), np.array([[0.0, 1.0], [0.5, 1.0]])
    one, two = (run([0.0, at, at, 1.0], [0.0, 0.0, 1.0, 1.0]) for at in (0.5, jump))
    apart = curves.distance(one, two)
    assert (apart.rms, apart.mean, apart.largest) == (0.0, 0.0, 0.0)
    assert curves.movement_distance(one, two, spans).rms == 0.0
    assert curves.parting_time(one, two, 1e-3) is None
    later = run([0.0, 0.51, 0.51, 1.0], [0.0, 0.0, 1.0, 1.0])
    assert curves.parting_time(one, later, 1e-3) == 0.5
    assert curves.distance(run([0], [1]), one) is None


RAMP, SHAKE = cs.Ramp(1.0, 1.0), cs.Oscillate(0.01, 2.0 * np.pi, 4.0)
LOADING = cs.Loading("relaxed", 0.0, (RAMP, SHAKE))
TIME = np.linspace(0.0, 5.0, 2001)
EDGE = np.minimum(TIME, 1.0) + np.where(TIME > 1.0, 0.005 * np.sin(2.0 * np.pi * (TIME - 1.0)), 0.0)


def moved(other, base=EDGE):
    right = run(TIME, TIME, base, np.minimum(TIME, 1.0))
    return curves.movement_distance(run(TIME, TIME, other), right, windows(LOADING, right), "contact_radius")


def test_movement_is_relative_to_the_excursion_in_the_worst_window():
    """A swing travels by 1 % of the radius; frozen in the last cycle it is 0.1 % of the whole off."""
    frozen = np.where(TIME > 4.0, 1.0, EDGE)
    right, spans = run(TIME, TIME, EDGE), windows(LOADING, run(TIME, TIME, EDGE, np.minimum(TIME, 1.0)))
    size = curves.distance(run(TIME, TIME, frozen), right, "contact_radius").rms
    found = moved(frozen)
    assert size < 2e-3
    assert found.rms == pytest.approx(np.sqrt(0.5) / 2.0, rel=1e-3)
    assert (found.begin, found.end) == pytest.approx((4.0, 5.0))
    assert found.rms <= size * curves.movement_bound(right, spans, "contact_radius")
    assert moved(EDGE + 0.003).rms < 1e-6  # a contact too large by a constant moves as it should
    assert moved(np.where(TIME > 1.0, EDGE + 0.003, EDGE)).rms < 0.1
    flat = np.ones_like(TIME)  # what hardly moves is divided by no less than the tolerance of curves
    assert moved(flat + 1e-6 * np.sin(TIME), flat).rms <= 1e-6 / curves.LEAST_EXCURSION


STEPS = cs.Ramp(1.0, 0.1, until_force=4.0), cs.Hold(1.0), cs.Oscillate(0.1, 2.0 * np.pi, 2.0)
LEVEL = run([0.0, 1.0, 2.0, 3.0, 5.0], [0.0, 1.0, 4.0, 3.5, 3.0], penetration=[0.0, 0.1, 0.2, 0.2, 0.2])


@pytest.mark.parametrize(
    ("steps", "base", "spans"),
    [
        (
            (RAMP, SHAKE),
            run([0.0, 1.0, 4.5], [0, 0, 0], penetration=[0.0, 1.0, 1.0]),
            [(0.0, 4.5), (0.0, 1.0), (1.0, 4.5), (1.0, 2.0), (2.0, 3.0), (3.0, 4.0)],
        ),
        (
            (cs.Sweep(0.1, 4.0 * np.pi, 2.0), cs.Hold(1.0)),
            run([0.0, 3.0], [0, 0]),
            [(0.0, 3.0), (0.0, 2.0), *pairwise([0.0, 1.0, 2.0**0.5, 3.0**0.5, 2.0]), (2.0, 3.0)],
        ),
        (  # under a force the penetration is found by the run: 0.5 when the ramp to 2 begins
            (cs.Force(1.0, 1.0), cs.ForceRamp(3.0, 2.0), cs.Ramp(2.0, 1.0), cs.Hold(1.0)),
            run([0, 1, 2, 3.5, 4.5], [1.0, 1.0, 3.0, 9.0, 8.0], penetration=[0.0, 0.25, 0.5, 2.0, 2.0]),
            [(0.0, 4.5), (0.0, 1.0), (1.0, 2.0), (2.0, 3.5), (3.5, 4.5)],
        ),
        (STEPS, LEVEL, [(0.0, 5.0), (0.0, 2.0), (2.0, 3.0), (3.0, 5.0), (3.0, 4.0), (4.0, 5.0)]),
        ((replace(STEPS[0], until_force=9.0), *STEPS[1:]), LEVEL, [(0.0, 5.0), (0.0, 5.0)]),
    ],
)
def test_windows_are_the_run_its_load_steps_as_it_went_and_its_whole_cycles(steps, base, spans):
    assert windows(cs.Loading("relaxed", 0.0, steps), base) == pytest.approx(np.array(spans))
    if steps is STEPS:
        assert corners(cs.Loading("relaxed", 0.0, steps), base) == pytest.approx([0.0, 2.0, 3.0, 5.0])
