"""Errors of a fit on problems whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest

from validation.fits.goodness import goodness, runs_test
from validation.fits.parameters import FitParameter
from validation.fits.statistics import (
    bound_notes,
    combinations,
    confused,
    correlation,
    covariance,
    estimates,
)


def test_signs_of_noise_pass_the_runs_test_and_those_of_a_bend_do_not():
    noise = np.random.default_rng(0).standard_normal(300)
    assert runs_test("noise", noise).probability > 0.01
    bend = noise + 2.0 * np.sin(np.linspace(0.0, 6.0, 300))
    found = runs_test("bend", bend)
    assert found.probability < 1e-6
    assert found.runs < 0.7 * found.expected


def test_the_runs_test_is_fair():
    draws = np.random.default_rng(1).standard_normal((2000, 200))
    share = np.mean([runs_test("", row).probability < 0.05 for row in draws])
    assert share == pytest.approx(0.05, abs=0.02)


def straight_line(noise=1.0):
    """Residuals at the best straight line through noise, and the derivatives."""
    x = np.linspace(-1.0, 1.0, 101)
    jacobian = np.column_stack([np.ones(101), x])
    data = noise * np.random.default_rng(3).standard_normal(101)
    best = np.linalg.lstsq(jacobian, data, rcond=None)[0]
    return jacobian, jacobian @ best - data


def test_the_covariance_of_a_straight_line_is_the_textbooks():
    jacobian, residuals = straight_line()
    found = goodness(residuals, 2, [("line", residuals)], np.inf)
    assert found.explained
    spread = covariance(jacobian, found)[0]
    x = jacobian[:, 1]
    assert spread == pytest.approx(np.diag([1.0 / x.size, 1.0 / np.sum(x**2)]), rel=1e-12, abs=1e-15)


def test_errors_grow_with_a_misfit_that_is_no_noise():
    jacobian, residuals = straight_line(noise=3.0)
    found = goodness(residuals, 2, [("line", residuals)], np.inf)
    assert not found.explained
    assert covariance(jacobian, found)[0][0, 0] == pytest.approx(found.reduced / 101, rel=1e-12)


def test_noise_known_from_few_rows_is_judged_by_them():
    _, residuals = straight_line(noise=1.3)
    many = goodness(residuals, 2, [], np.inf).probability
    few = goodness(residuals, 2, [], 20.0).probability
    assert many < 1e-3 < few


def test_what_is_only_seen_as_a_product_is_named():
    generator = np.random.default_rng(4)
    slope = generator.standard_normal(50)
    jacobian = np.column_stack([slope, 0.5 * slope, generator.standard_normal(50)])
    residuals = generator.standard_normal(50)
    found = goodness(residuals, 3, [], np.inf)
    spread, deviations, directions = covariance(jacobian, found)
    assert np.isinf(spread[0, 0])
    assert np.isinf(spread[1, 1])
    assert spread[2, 2] == pytest.approx(1.0 / np.sum(jacobian[:, 2] ** 2), rel=0.1)
    unknown, *known = combinations(["work", "zone", "modulus"], deviations, directions)
    assert not np.isfinite(unknown.deviation)
    assert set(unknown.powers) == {"work", "zone"}
    assert unknown.powers["work"] / unknown.powers["zone"] == pytest.approx(-0.5, rel=1e-6)
    assert all(np.isfinite(one.deviation) for one in known)


def test_parameters_that_are_hardly_told_apart_are_paired():
    generator = np.random.default_rng(5)
    slope = generator.standard_normal(50)
    jacobian = np.column_stack([slope, slope + 0.01 * generator.standard_normal(50)])
    spread = covariance(jacobian, goodness(generator.standard_normal(50), 2, [], np.inf))[0]
    [(first, second, value)] = confused(["a", "b"], correlation(spread))
    assert {first, second} == {"a", "b"}
    assert value < -0.99


def test_intervals_of_logarithms_are_factors_and_stay_within_bounds():
    parameter = FitParameter("work", 1.0, 0.9, 10.0, True)
    [one] = estimates([parameter], np.array([0.0]), np.array([[0.01]]), [""])
    assert one.high == pytest.approx(np.exp(0.1959964))
    assert one.low == pytest.approx(0.9)
    assert bound_notes([parameter], np.array([np.log(0.9)]), np.array([[0.01]])) == ["held by its bound"]
    assert bound_notes([parameter], np.array([0.5]), np.array([[1.0]])) == ["not determined by these data"]


@pytest.mark.parametrize(("size", "holds"), [(0.2, True), (1.0, False)])
def test_a_shape_below_the_noise_tells_nothing_of_the_model(size, holds):
    """Of a record without noise what is left is the solver's own error, and goes in waves."""
    waves = size * np.sqrt(2.0) * np.sin(np.linspace(0.0, 20.0, 400))
    assert goodness(waves, 3, [("one", waves)], 100.0).explained is holds
