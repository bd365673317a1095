"""The numbers that the page on the end of small-scale viscoelasticity states in words, from its own cells."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from support.pages import code_cells

from benchmarks import small_scale
from validation.reference.elastic_layer import ElasticLayer
from validation.reference.jkr import JKR


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


@pytest.mark.slow
def test_the_border_of_a_punch_and_of_layers(page):
    """What the page says of them; frozen forces are closed forms of the work over ``k``, but for the zone."""
    before, _, after = code_cells("small-scale")[-1].partition("0.4, 0.7, 1.0, 1.4, 3.0")
    exec(f"{before}0.4, 1.0, 3.0{after}", page)
    for name, (before, at, behind) in page["border"].items():
        assert abs(before) < 0.025
        assert 0.5 < at < 0.7
        assert 0.75 < behind < (0.8 if name == "flat punch" else 0.96)
    assert page["frozen"]["flat punch"] == pytest.approx(0.03**-0.5, rel=5e-3)
    for name, case in list(page["cases"].items())[1:]:
        scene, _, unit = page["resting"](0.03, **case)
        layer = ElasticLayer(scene.body, 0.5, scene.indenter)
        closed = -layer.pull_off(scene.adhesion.work / 0.03, "force").force / unit
        assert page["frozen"][name] == pytest.approx(closed, rel=5e-3)


@pytest.fixture(scope="module")
def drawn():
    """The names of the cells of the map."""
    matplotlib.use("agg")
    names: dict = {}
    definitions, *cells = code_cells("small-scale")
    for cell in (definitions, *(cell for cell in cells if "drawn" in cell)):
        exec(cell, names)
    return names


def spread(values, *shares):
    """Quantiles of what is a number."""
    return np.nanquantile(values, shares)


def test_the_border_of_the_map_is_one_number(drawn):
    """Whatever radius and exponent, by the pull to the frozen pull-off; not by that to Griffith's limit."""
    N, reach, half = (drawn[name] for name in ("N", "reach", "half"))
    assert spread(N[half], 0.5) == pytest.approx(0.93, abs=0.01)
    assert spread(N[half & (reach > 1.0)], 0.05, 0.95) == pytest.approx([0.85, 0.99], abs=0.01)
    assert spread(N[half & (reach < 1.0)], 0.05, 0.95) == pytest.approx([0.75, 1.3], abs=0.02)
    assert (N * drawn["drawn"]["pull"] / drawn["drawn"]["griffith"])[half].max() > 4.0


def test_rules_of_the_map(drawn):
    """Small-scale and frozen forces, what is left to rise, and cycles instead of rest."""
    N, zones, reach, runs = (drawn[name] for name in ("N", "zones", "reach", "drawn"))
    small, frozen = (runs["force"] / runs[name] - 1.0 for name in ("small", "frozen"))
    assert np.abs(spread(small[N < 0.4], 0.01, 0.99)).max() < 0.03
    assert np.abs(spread(small[(N < 0.4) & (zones > 3.0)], 0.01, 0.99)).max() < 0.007
    assert np.abs(spread(frozen[N > 3.0], 0.01, 1.0)).max() < 0.03
    there = (N > 0.8) & (N < 1.25) & (zones > 1.0) & (zones < 100.0)
    low, middle, high = spread((drawn["rise"] * zones)[there], 0.05, 0.5, 0.95)
    assert (0.05 < low < 0.06, 0.11 < middle < 0.13, high < 0.6) == (True, True, True)
    pressed = N * runs["pull"] / runs["depth"]
    cycle, slow = runs["cycle"] / runs["force"], (pressed > 0.01) & (pressed < 0.1)
    assert np.abs(spread(cycle[slow & (reach > 1.2)], 0.01, 0.99) - 1.0).max() < 0.02
    assert spread(cycle[(pressed > 1e-3) & (pressed < 0.01) & (reach < 0.8)], 0.5) == pytest.approx(
        0.9, abs=0.01
    )


def test_all_of_the_map_is_there_but_cycles_that_begin_shorter_than_their_zone(drawn):
    """As many as the page says, also behind its two numbers of cycles; nothing comes off without a force."""
    runs, n, reach = drawn["drawn"], drawn["n"], drawn["reach"]
    assert all(np.isfinite(runs[name]).all() for name in runs if name != "cycle")
    assert all(np.nanmin(runs[name]) > 0.0 for name in small_scale.RUNS)
    cycles = runs["depth"] > 0.0
    none = cycles & np.isnan(runs["cycle"])
    assert (cycles.sum(), none.sum()) == (15_503, 471)
    assert n[none].max() < 2.03
    points = small_scale.drawn(20_000)
    for row in np.flatnonzero(none):
        contact = JKR(points[row].indenter, 1.0 / points[row].k, points[row].work).at_penetration(0.0)
        assert points[row].zone * points[row].reach * small_scale.THRESHOLD > contact.contact_radius
    pressed = drawn["N"] * runs["pull"] / np.where(cycles, runs["depth"], np.nan)
    slow, slower = (pressed > 0.01) & (pressed < 0.1), (pressed > 1e-3) & (pressed < 0.01)
    for some, counts in ((slow & (reach > 1.2), (3_698, 120)), (slower & (reach < 0.8), (234, 29))):
        assert (some.sum(), (some & none).sum()) == counts


@pytest.mark.slow
def test_the_map_is_that_of_its_command(drawn):
    """Also a retraction that the reference solves, and a cycle that there is not."""
    points, rows = small_scale.drawn(20_000), [*range(8), 38, 16_616]
    assert np.isnan(drawn["drawn"]["cycle"][38])
    for name, column in small_scale.solved([points[row] for row in rows]).items():
        assert column == pytest.approx(drawn["drawn"][name][rows], rel=1e-4, nan_ok=True)
