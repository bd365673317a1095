"""Observed orders, Richardson values, bounds and prices on sequences whose answer is known."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from validation.cases import load
from validation.studies.ladders import Ladder, Level, Settings
from validation.studies.orders import extrapolate, fitted_slope, observed_order, reference_orders
from validation.studies.prices import busy, cheapest, cost, growth, in_words, left_out, measures, price
from validation.studies.study import Convergence, LevelRun, read

HALVED = (1.0, 0.5, 0.25, 0.125, 0.0625)
MEASURE = "force, RMS"


def power_law(sizes, exact, factor, order):
    return [exact + factor * h**order for h in sizes]


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("sizes", [HALVED, (1 / 4, 1 / 6, 1 / 8, 1 / 12)])
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


ROOT = math.sqrt(2.0) - 1.0


@pytest.mark.parametrize(
    ("values", "orders", "richardson", "bound", "verdict"),
    [
        ([0.0, 1.0, 3.0, 7.0], (-1.0, -1.0), None, 12.0 / ROOT, "the differences grow"),
        ([1.0, 1.1, 1.05, 1.07], (None, None), None, 0.06 / ROOT, "the values go to and fro"),
        ([3.0] * 4, (None, None), 3.0, 0.0, "no level differs"),
        ([1.3, 1.1, 1.1, 1.1], (None, None), None, 0.6, "the finest two do not differ"),
        ([h + 10.0 * h**4 for h in HALVED[:4]], None, None, None, "not asymptotic"),
        (power_law(HALVED[:4], 1.0, 1.0, 4.0), (4.0, 4.0), 1.0, 0.25**4 - 0.125**4, "asymptotic"),
        ([2.0 + h**2 for h in HALVED[:3]], (2.0,), 2.0, None, "no fourth level"),
        ([1.0, None, None, 2.0], (None, None), None, None, "fewer than three levels"),
    ],
)
def test_what_is_no_plain_power_law(values, orders, richardson, bound, verdict):
    """A high order is not trusted beyond the nominal one, 2."""
    found = extrapolate(HALVED[: len(values)], values, 2.0, 1.0)
    assert found.verdict.startswith(verdict)
    if orders is not None:
        assert found.orders == pytest.approx(orders)
    if richardson is not None or verdict.startswith("the "):
        assert found.richardson == (None if richardson is None else pytest.approx(richardson))
    if bound is not None:
        assert found.bound == pytest.approx(bound)


@pytest.mark.parametrize("failed", [0, 2, 3])
def test_a_failed_level_costs_its_orders_only(failed):
    values = power_law(HALVED, 2.0, 1.0, 2.0)
    values[failed] = None
    found = extrapolate(HALVED, values, 2.0, 2.0)
    assert [order is None for order in found.orders] == [i <= failed <= i + 2 for i in range(3)]
    assert found.richardson == pytest.approx(2.0)


def test_orders_against_the_reference_are_signed():
    found = reference_orders(HALVED, [-1e-2, 5e-3, -2e-2, None, 0.0])
    assert found[:2] == pytest.approx((1.0, -2.0))
    assert found[2:] == (None, None)
    for call in (lambda: extrapolate((1.0, 1.0, 0.5), [1.0, 2.0, 3.0], 2.0, 1.0),
                 lambda: reference_orders((0.5, 1.0), [1.0, 2.0])):  # fmt: skip
        with pytest.raises(ValueError, match="fall from level to level"):
            call()


def test_fitted_slope():
    sizes = [1.0, 0.5, 0.25]
    assert fitted_slope(sizes, [3.0 * h**1.7 for h in sizes]) == pytest.approx(1.7)
    for across, up in ((sizes, [1.0, None, 2.0]), (sizes, [1.0, 0.0, 2.0]), ([1.0] * 3, [1.0, 2.0, 3.0])):
        assert fitted_slope(across, up) is None


def made_up(scheme: str, errors: list[float | None], seconds: list[float], **counters: int) -> Convergence:
    """A ladder of halved sizes; ``None`` makes a failed level."""
    levels = tuple(Level(0.5**i, str(i), Settings(4)) for i in range(len(errors)))
    runs = tuple(
        LevelRun(level, failure="fell over")
        if error is None
        else LevelRun(
            level, {}, {MEASURE: error}, {"steps": 10 * 2**i, **counters}, spent, spent, 1, "completed"
        )
        for i, (level, error, spent) in enumerate(zip(levels, errors, seconds, strict=True))
    )
    return read(Ladder(scheme, "together", "everything", levels), runs, None, load("cycle-v0.02"))


@pytest.mark.parametrize(
    ("errors", "seconds", "asked", "found"),
    [
        ([1e-1, 1e-3], [1.0, 4.0], 1e-2, (2.0, False)),  # between two levels
        ([1e-3, 1e-4], [1.0, 4.0], 1e-2, (1.0, True)),  # the coarsest level only bounds the price
        ([1e-1, 1e-2], [1.0, 2.0], 1e-4, (None, False)),
        ([None, None], [1.0, 2.0], 1e-1, (None, False)),
        ([1e-1, 0.0], [1.0, 4.0], 1e-2, (4.0, False)),
        ([1e-5, 1e-2, 1e-4], [1.0, 2.0, 4.0], 1e-3, (2.0 * math.sqrt(2.0), False)),  # a lucky coarse level
    ],
)
def test_prices(errors, seconds, asked, found):
    best = price(made_up("bem", errors, seconds), MEASURE, asked)
    assert best.seconds == (None if found[0] is None else pytest.approx(found[0]))
    assert best.at_most == found[1]


def test_the_cheapest_scheme_is_named():
    studies = [
        made_up("bem", [1e-1, 1e-3, 1e-5], [1.0, 2.0, 4.0]),
        made_up("paper-scheme", [1e-1, 1e-2, 1e-3], [0.1, 1.0, 10.0]),
    ]
    assert cheapest(studies, MEASURE, 1e-1)[0].scheme == "paper-scheme"
    assert cheapest(studies, MEASURE, 1e-3)[0].scheme == "bem"
    assert cheapest(studies, MEASURE, 1e-9)[0] is None
    said = in_words(studies)
    assert "At 1e-01 paper-scheme is cheapest: at most 0.1 s" in said[0]
    assert "At 1e-04 bem is cheapest: 2.8 s (paper-scheme does not reach it)" in said[3]
    assert in_words(studies, "pull_off_force") == ["there is none in this scene."]
    assert measures(studies) == [MEASURE]
    assert len(measures([made_up("bem", [None], [1.0])])) == 6  # where all failed everything stays visible


def test_exponents_of_cost():
    study = made_up("bem", [1e-1, 1e-2, 1e-3, 1e-4], [1.0, 8.0, 64.0, 512.0])
    found = growth(study, "wall_seconds")
    assert (found.with_resolution, found.with_error) == pytest.approx((3.0, 0.90309), rel=1e-4)
    assert growth(study, "steps").with_resolution == pytest.approx(1.0)
    assert growth(study, "linear_solves").with_resolution is None
    assert busy([study]) == 1.0
    assert [cost(run, "wall_seconds") for run in made_up("bem", [1e-1, None], [1.0, 2.0]).runs] == [1.0, None]


def test_what_was_left_out_comes_from_the_counters():
    lazy = made_up("fem", [1e-1], [1.0], closure_evaluations=0, volume_solves=0, history_updates=7)
    said = "fem: no closure was evaluated; no solution in the volume within the time loop."
    assert left_out([lazy]) == [said]
    assert left_out([made_up("bem", [1e-1], [1.0], closure_evaluations=3, volume_solves=0)]) == []
    assert left_out([made_up("bem", [None], [1.0])]) == []
