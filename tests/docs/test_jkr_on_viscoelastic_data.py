"""The numbers that the page on JKR and viscoelastic data states in words, from its own cells."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from support.pages import code_cells

import crosscontact as cc
from validation.reference.batch import solve
from validation.reference.steady_crack import opening


@pytest.fixture(scope="module")
def page():
    matplotlib.use("agg")
    names: dict = {}
    scenes, _, edges, fits = code_cells("jkr-on-viscoelastic-data")
    for cell in (scenes, edges, fits):
        exec(cell, names)
    return names


def pulled(page, preload, *speeds):
    found = solve([page["withdrawn"](preload, v) for v in speeds])
    return np.array([one.pull_off_force for one in found]) / page["unit"]


def test_pull_off_forces_after_a_rest(page):
    speeds = 1e-7, 1e-6, 1e-5, 1e-2
    rested = pulled(page, 10, *speeds)
    assert rested[[0, -1]] == pytest.approx([2.23, 10.02], abs=0.01)
    assert 0.87 < min(pulled(page, 1, *speeds) / rested) < 0.88


def test_an_edge_that_passes_a_tenth_of_a_zone_in_the_retardation_time(page):
    retardation = page["tau"] * page["ratio"]
    assert opening(page["rubber"], page["zone"], 0.1 * page["zone"] / retardation) == pytest.approx(
        1.1, abs=0.005
    )


def test_a_fast_ball_that_does_not_rest_meets_the_true_work(page):
    force = cc.solve(page["withdrawn"](10, 1e-2, 0.0)).pull_off.force
    assert force / page["unit"] == pytest.approx(1.03, abs=0.01)


def test_force_and_radius_follow_the_steady_edge_behind_the_start(page):
    for travel, speed, G in page["measured"].values():
        steady = opening(page["rubber"], page["zone"], speed)
        assert np.all(np.abs(G / steady - 1.0)[travel > 5.0] < 0.02)
    travel, speed, G = page["measured"][100, 1e-4]
    assert np.any((G / opening(page["rubber"], page["zone"], speed))[travel < 1.0] < 0.5)


def test_fits_of_whole_retractions(page):
    nearest = page["nearest"]
    for speed in (3e-8, 3e-7):
        modulus, work, _ = nearest[100, speed]
        assert modulus == pytest.approx(1.0, abs=0.01)
        assert work / pulled(page, 100, speed)[0] == pytest.approx(0.85, abs=0.015)
    assert nearest[1, 3e-3] == pytest.approx((15.1, 32.8, 0.0052), rel=0.02)
    assert nearest[100, 3e-3][1] == pytest.approx(782, rel=0.02)


def test_a_frozen_retraction_begins_as_a_punch_on_the_glassy_body(page):
    (run,) = solve([page["withdrawn"](10, 1e-2)])
    slope = (run.force[0] - run.force[1]) / (run.penetration[0] - run.penetration[1])
    glassy = page["ratio"] * page["rested"].plane_modulus
    assert slope == pytest.approx(2.0 * run.contact_radius[0] * glassy, rel=0.01)
