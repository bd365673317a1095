"""The numbers that the page on statements from the literature states in words, from its own cells."""

from __future__ import annotations

import math

import matplotlib
import numpy as np
import pytest
from support.pages import code_cells

import crosscontact as cc
from validation.reference.batch import solve

pytestmark = pytest.mark.slow  # the cells of the page


@pytest.fixture(scope="module")
def page():
    matplotlib.use("agg")
    names: dict = {}
    for cell in code_cells("claims-of-others")[:-1]:  # the last, of oscillations, says its numbers itself
        if "peaks = " not in cell:
            exec(cell, names)
    return names


def test_the_fast_limit_is_far(page):
    for k in (0.3, 0.1, 0.01):
        for share in (0.05, 0.01):
            assert page["fast"](k, share) == pytest.approx((1 - k) / (2 * share), rel=0.08)
    assert float(page["opening"](page["rubber"](0.1), 1.0, 1.0)) * 0.1 == pytest.approx(0.68, abs=0.02)


def test_the_full_factor_needs_the_threshold_radius(page):
    for k in (0.1, 0.01):
        assert page["plateau"](k, 0.8) * k == pytest.approx(0.92, abs=0.01)
        assert page["plateau"](k, 1.0) * k == pytest.approx(1.0, abs=1e-3)
        assert page["plateau"](k, 1.5) * k == pytest.approx(1.0, abs=1e-9)


def cycle(page, k, share, speed):
    """Pull-off force over that of JKR times k, of a cycle at a speed in ``a^2/R tau``."""
    ball, work = page["ball"], 1e-6
    top = page["JKR"](ball, 1.0, work).at_force(45 * math.pi * work)
    a, D = top.contact_radius, top.penetration
    steps = cc.Ramp(D, speed * a**2), cc.Ramp(-2 * D, speed * a**2)
    scene = cc.Scene(page["rubber"](k), ball, cc.Loading("jump-in", 0.0, steps), cc.Adhesion(work, share * a))
    return solve([scene])[0].pull_off_force * k / (1.5 * math.pi * work)


@pytest.mark.parametrize("k", [0.1, 0.01])
def test_the_falling_side_does_not_know_the_zone(page, k):
    tangent = math.sqrt(k)
    largest = cycle(page, k, 1e-2, 0.27 * tangent)
    fallen = [cycle(page, k, share, tangent) for share in (1e-2, 1e-3, 1e-4)]
    assert np.ptp(fallen) < 0.005
    assert 0.5 < fallen[0] / largest < 0.75
    assert cycle(page, k, 1e-2, 0.03 * tangent) < 0.85 * largest


def test_the_work_has_a_maximum_and_the_force_rises(page):
    for k, end in ((0.1, 1.12), (0.01, 1.6)):
        force, work = (one[np.isfinite(one)] for one in page["separation"][k])
        assert np.all(np.diff(force) > -1e-4 * force[1:])
        assert 0 < np.argmax(work) < len(work) - 1
        assert work[-1] == pytest.approx(end, abs=0.02)


def test_a_punch_that_was_pressed_in_comes_off_as_the_closure_says(page):
    torn = page["torn"]
    assert torn[10.0, 0.0] == pytest.approx(math.sqrt(10), rel=5e-3)
    assert torn[10.0, 0.1] == pytest.approx(12.12, abs=0.01)
    b = 11 * 0.1
    x = (b + math.sqrt(b**2 - 40 * (0.01 - 2e-3 * math.pi))) / 20  # (10 x - D)(x - D) = 2 pi a w
    assert 2 * (10 * x - 0.1) / page["kendall"] == pytest.approx(12.17, abs=0.01)
