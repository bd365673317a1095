"""Observed orders, Richardson values and grid convergence indices on sequences whose answer is known."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from validation.studies.extrapolation import extrapolate, fitted_slope, observed_order, reference_orders

HALVED = (1.0, 0.5, 0.25, 0.125, 0.0625)


def power_law(sizes, exact, factor, order):
    return [exact + factor * h**order for h in sizes]


@pytest.mark.parametrize("order", [0.5, 1.0, 1.8, 2.0, 4.0])
@pytest.mark.parametrize("sizes", [HALVED, (1 / 4, 1 / 6, 1 / 8, 1 / 12), (1.0, 0.7, 0.3, 0.1)])
@pytest.mark.parametrize("factor", [0.3, -0.3])
def test_a_power_law_is_read_exactly(order, sizes, factor):
    found = extrapolate(sizes, power_law(sizes, 2.0, factor, order), order, 2.0)
    assert found.orders == pytest.approx((order,) * (len(sizes) - 2), rel=1e-6)
    assert found.richardson == pytest.approx(2.0, rel=1e-7)
    assert found.asymptotic == pytest.approx(1.0, rel=1e-5)
    assert found.safety == 1.25
    error = abs(factor) * sizes[-1] ** order / 2.0
    assert found.bound == pytest.approx(1.25 * error, rel=1e-5)
    assert found.verdict == "asymptotic"


@given(st.floats(0.3, 6.0), st.floats(1.1, 4.0), st.floats(1.1, 4.0))
def test_any_ratio_gives_the_order_back(order, first, second):
    sizes = (first * second, second, 1.0)
    assert observed_order(sizes, power_law(sizes, 0.0, 1.0, order), 1.0) == pytest.approx(order, rel=1e-6)


def test_growing_differences_have_a_negative_order():
    found = extrapolate(HALVED[:4], [0.0, 1.0, 3.0, 7.0], 2.0, 1.0)
    assert found.orders == pytest.approx((-1.0, -1.0))
    assert found.richardson is None
    assert found.verdict == "the differences grow: not convergent here"
    assert found.bound == pytest.approx(3.0 * 4.0 / (math.sqrt(2.0) - 1.0))


def test_a_logarithm_is_of_order_zero():
    values = [math.log(h) for h in (1.0, 0.5, 0.25)]
    assert observed_order(HALVED[:3], values, 1.0) == pytest.approx(0.0, abs=1e-9)


def test_values_to_and_fro_have_no_order_but_a_bound():
    found = extrapolate(HALVED[:4], [1.0, 1.1, 1.05, 1.07], 2.0, 1.0)
    assert found.orders == (None, None)
    assert found.richardson is None
    assert found.asymptotic is None
    assert found.safety == 3.0
    assert found.bound == pytest.approx(3.0 * 0.02 / (math.sqrt(2.0) - 1.0))
    assert "to and fro" in found.verdict


def test_exact_values_have_nothing_to_extrapolate():
    found = extrapolate(HALVED[:4], [3.0] * 4, 2.0, 3.0)
    assert found.orders == (None, None)
    assert (found.richardson, found.bound) == (3.0, 0.0)
    assert found.verdict == "no level differs"


def test_a_value_that_moves_in_jumps_is_not_called_exact():
    found = extrapolate(HALVED, [1.0, 1.3, 1.1, 1.1, 1.1], 1.0, 2.0)
    assert found.richardson is None
    assert found.bound == pytest.approx(3.0 * 0.2 / 2.0)
    assert "jump" in found.verdict


def test_an_order_that_changes_is_not_asymptotic():
    values = [h + 10.0 * h**4 for h in HALVED[:4]]
    found = extrapolate(HALVED[:4], values, 1.0, 1.0)
    assert found.asymptotic is not None
    assert found.asymptotic > 1.4
    assert found.verdict.startswith("not asymptotic")


def test_a_high_order_is_not_trusted_beyond_the_nominal_one():
    found = extrapolate(HALVED[:4], power_law(HALVED[:4], 1.0, 1.0, 4.0), 2.0, 1.0)
    step = 0.25**4 - 0.125**4
    assert found.safety == 3.0
    assert found.bound == pytest.approx(3.0 * step / (2.0**2 - 1.0))


@pytest.mark.parametrize("failed", [0, 1, 2, 3])
def test_a_failed_level_costs_its_orders_only(failed):
    values = power_law(HALVED, 2.0, 1.0, 2.0)
    values[failed] = None
    found = extrapolate(HALVED, values, 2.0, 2.0)
    assert len(found.orders) == 3
    assert [order is None for order in found.orders] == [i <= failed <= i + 2 for i in range(3)]
    assert found.richardson == pytest.approx(2.0)


@pytest.mark.parametrize("values", [[None] * 4, [1.0, None, None, 2.0]])
def test_too_few_levels_say_so(values):
    found = extrapolate(HALVED[:4], values, 2.0, 1.0)
    assert found.bound is None
    assert found.verdict == "fewer than three levels have a value"


def test_three_levels_cannot_be_checked():
    found = extrapolate(HALVED[:3], power_law(HALVED[:3], 2.0, 1.0, 2.0), 2.0, 2.0)
    assert found.asymptotic is None
    assert found.richardson == pytest.approx(2.0)
    assert found.verdict == "no fourth level to check with"


def test_orders_against_the_reference_are_signed():
    errors = [-1e-2, 5e-3, -2e-2, None, 0.0]
    found = reference_orders(HALVED, errors)
    assert found[:2] == pytest.approx((1.0, -2.0))
    assert found[2:] == (None, None)


def test_fitted_slope():
    sizes = [1.0, 0.5, 0.25]
    assert fitted_slope(sizes, [3.0 * h**1.7 for h in sizes]) == pytest.approx(1.7)
    assert fitted_slope(sizes, [1.0, None, 2.0]) is None
    assert fitted_slope(sizes, [1.0, 0.0, 2.0]) is None
    assert fitted_slope([1.0, 1.0, 1.0], [1.0, 2.0, 3.0]) is None


def test_sizes_must_fall():
    with pytest.raises(ValueError, match="fall from level to level"):
        extrapolate((1.0, 1.0, 0.5), [1.0, 2.0, 3.0], 2.0, 1.0)
    with pytest.raises(ValueError, match="fall from level to level"):
        reference_orders((0.5, 1.0), [1.0, 2.0])
