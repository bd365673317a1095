"""Search for the edge where the residual rises through zero."""

from __future__ import annotations

from dataclasses import dataclass

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from bem_solver.root_search import rising_root


@dataclass(frozen=True)
class Trial:
    residual: float


@given(bend=st.floats(-0.45, 0.45), slope=st.floats(0.3, 3.0), guess=st.floats(-0.9, 0.9))
def test_a_parabola_takes_few_trials(bend, slope, guess):
    """Three tell all of it. Before a limit point, where the slope falls to zero, secants took up to nine."""
    tried = []

    def trial(x):
        tried.append(x)
        return Trial(x + bend * x**2)

    found = rising_root(trial, guess, slope, -1.0, 1.0, 1e-9)
    assert found.position == "converged"
    assert abs(found.x) <= 1e-9
    edges = sum(abs(x) == 1.0 for x in tried)  # a slope that is far off leads to the ends of the interval
    assert len(tried) - edges <= 5


def test_the_slope_that_is_handed_on_is_the_last_secant():
    found = rising_root(lambda x: Trial(x + 0.3 * x**2), 0.5, 1.0, -1.0, 1.0, 1e-3)
    assert_allclose(found.slope, 1.0, rtol=0.05)


@pytest.mark.parametrize("slope", [0.0, 0.5, 1.0, 20.0])
def test_a_residual_that_does_not_fall_below_zero_has_its_root_below(slope):
    found = rising_root(lambda x: Trial(0.1 + (x - 0.2) ** 2), 0.5, slope, -1.0, 1.0, 1e-6)
    assert found.position == "below"
    assert found.x == -1.0
