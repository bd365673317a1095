"""The numbers that the page on the end of small-scale viscoelasticity states in words, from its own cells."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from support.pages import code_cells


@pytest.fixture(scope="module")
def page():
    matplotlib.use("agg")
    names: dict = {}
    definitions, _, shares, *_ = code_cells("small-scale")
    exec(definitions, names)
    exec(shares.partition("N = np.geomspace")[0], names)
    return names


@pytest.mark.parametrize(("k", "reach"), [(0.3, 1.0), (0.1, 1.0), (0.01, 1.0), (0.3, 2.0), (0.03, 1.5)])
def test_small_scale_holds_to_two_fifths_of_the_border(page, k, reach):
    gone = page["share"](k, reach, 1e-3, np.array([0.2, 0.4]))
    assert np.all(np.abs(gone) < (0.01 if reach == 1.0 else 0.052))


@pytest.mark.parametrize("cone", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_the_border_at_the_threshold_radius_is_at_one(page, cone):
    for zone in (1e-3, 1e-4):
        low, middle, high = page["share"](0.1, 1.0, zone, np.array([0.7, 1.0, 3.0]), cone)
        assert low < 0.1
        assert middle == pytest.approx(0.53, abs=0.04)
        assert 0.85 < high < 0.95


@pytest.mark.parametrize(("cone", "limit"), [(False, 10.0), (True, 100.0)])
def test_frozen_forces(page, cone, limit):
    _, (force,) = page["pull_offs"](0.1, 1.0, 1e-4, [1e6], cone)
    assert force == pytest.approx(limit, rel=1e-4)
