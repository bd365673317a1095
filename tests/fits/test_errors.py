"""Errors of a fit on problems whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest

from validation.fits.model import correlation_length, misfitting_stretch
from validation.fits.parameters import Unknown
from validation.fits.result import (
    Estimate,
    Goodness,
    combinations,
    confused,
    correlation,
    covariance,
    runs_test,
)


def test_the_runs_test_is_fair_and_sees_a_bend():
    draws = np.random.default_rng(1).standard_normal((2000, 200))
    share = np.mean([runs_test("", row)["probability"] < 0.05 for row in draws])
    assert share == pytest.approx(0.05, abs=0.02)
    bend = runs_test("bend", draws[0] + 2.0 * np.sin(np.linspace(0.0, 6.0, 200)))
    assert bend["probability"] < 1e-6
    assert bend["runs"] < 0.7 * bend["expected"]


@pytest.mark.parametrize("memory", [0.0, 0.6, 0.9])
def test_deviations_of_a_mean_of_correlated_rows_are_those_that_means_have(memory):
    """Rows that remember a share of the row before: the mean of n has the variance of n (1 - m)/(1 + m)."""
    generator, lengths, means = np.random.default_rng(2), [], []
    for _ in range(200):
        rows = generator.standard_normal(600)
        for place in range(1, rows.size):
            rows[place] += memory * rows[place - 1]
        rows *= np.sqrt(1.0 - memory**2)
        lengths.append(correlation_length(rows))
        means.append(rows.mean() / np.sqrt(lengths[-1] / rows.size))
    assert np.mean(lengths) == pytest.approx((1.0 + memory) / (1.0 - memory), rel=0.15)
    assert np.std(means) == pytest.approx(1.0, abs=0.15)


def test_the_stretch_that_a_model_misses_is_marked_and_none_in_noise():
    rows = np.random.default_rng(5).standard_normal(400)
    rows[100:160] += 4.0
    found = misfitting_stretch(rows)
    assert abs(found.start - 100) < 5
    assert abs(found.stop - 160) < 5
    quiet = misfitting_stretch(np.full(50, 0.5))
    assert quiet.start == quiet.stop


def straight_line(noise=1.0):
    """Residuals at the best straight line through noise, and the derivatives."""
    x = np.linspace(-1.0, 1.0, 101)
    jacobian = np.column_stack([np.ones(101), x])
    data = noise * np.random.default_rng(3).standard_normal(101)
    return jacobian, jacobian @ np.linalg.lstsq(jacobian, data, rcond=None)[0] - data


def test_the_covariance_of_a_straight_line_is_the_textbooks():
    jacobian, _ = straight_line()
    spread, x = covariance(jacobian, 2.0)[0], jacobian[:, 1]
    assert spread == pytest.approx(2.0 * np.diag([1.0 / x.size, 1.0 / np.sum(x**2)]), rel=1e-12, abs=1e-15)


def goodness(probability, signs, share=0.1, within=None):
    tests = (runs_test("one", signs),)
    return Goodness(1.0, 1, np.inf, probability, tests, 1.0, share, within, 1.0)


def test_what_explains_data_is_their_noise_or_the_share_that_was_asked_for():
    noise = np.random.default_rng(0).standard_normal(300)
    wave = np.sin(np.linspace(0.0, 20.0, 300))
    assert goodness(0.5, noise).explained
    assert not goodness(1e-6, noise).explained
    assert not goodness(0.5, wave).explained
    assert goodness(1.0, wave).explained  # less than noise can be: the solver's error
    assert goodness(0.0, wave, 0.009, within=0.01).explained
    assert not goodness(0.5, noise, 0.011, within=0.01).explained


def test_what_is_only_seen_as_a_product_is_named():
    generator = np.random.default_rng(4)
    slope = generator.standard_normal(50)
    jacobian = np.column_stack([slope, 0.5 * slope, generator.standard_normal(50)])
    spread = covariance(jacobian, 1.0)[0]
    assert np.isinf(spread[0, 0])
    assert np.isinf(spread[1, 1])
    assert spread[2, 2] == pytest.approx(1.0 / np.sum(jacobian[:, 2] ** 2), rel=0.1)
    names, positive = ["work", "zone", "modulus"], np.ones(3, bool)
    unknown, *known = combinations(names, jacobian, positive, 1.0)
    assert not np.isfinite(unknown.deviation)
    assert set(unknown.powers) == {"work", "zone"}
    assert unknown.powers["work"] / unknown.powers["zone"] == pytest.approx(-0.5, rel=1e-6)
    assert all(np.isfinite(one.deviation) for one in known)


def test_parameters_that_are_hardly_told_apart_are_paired():
    generator = np.random.default_rng(5)
    slope = generator.standard_normal(50)
    jacobian = np.column_stack([slope, slope + 0.01 * generator.standard_normal(50)])
    [(first, second, value)] = confused(["a", "b"], correlation(covariance(jacobian, 1.0)[0]))
    assert {first, second} == {"a", "b"}
    assert value < -0.99


def test_intervals_of_logarithms_are_factors_and_stay_within_bounds():
    work = Unknown("work", 1.0, 0.9, 10.0, True)
    one = Estimate.of(work, 0.0, 0.01)
    assert one.high == pytest.approx(np.exp(0.1959964))
    assert one.low == pytest.approx(0.9)
    assert Estimate.of(work, np.log(0.9), 0.01).note == "held by its bound"
    assert Estimate.of(work, 0.5, 1.0).note == "not determined by these data"
