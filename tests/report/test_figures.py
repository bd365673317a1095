"""Curves of figures, drawn from made-up traces."""

from __future__ import annotations

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from support.synthetic_traces import trace

from validation.cases import load
from validation.claims.paper_figures import oscillation
from validation.drawing.curves import RunCurves, labels, with_differences
from validation.drawing.run_figures import PANELS, draw
from validation.measure.scaling import unit_sizes

RANGES = [(0.0, 1.0), (-3e-9, 7e-9), (-2.4e8, 1.1e9), (0.24515012, 0.2451503), (-9876.54, -9876.5)]


@pytest.mark.parametrize(("low", "high"), RANGES)
def test_nothing_is_cut_off_and_numbers_do_not_touch(low, high):
    values = np.linspace(low, high, 40)
    columns = dict.fromkeys(("time", "penetration", "force", "contact_radius"), values)
    figure = draw(PANELS[0], [RunCurves("bem", "bem", columns)], labels(load("cycle-v0.1").scene))
    figure.draw_without_rendering()
    box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    assert min(box.x0, box.y0, width - box.x1, height - box.y1) >= 0.0
    assert box.x0 < 0.1  # inches
    (axes,) = figure.axes
    shown = [one.get_window_extent() for one in axes.get_xticklabels() if one.get_text()]
    assert all(left.x1 < right.x0 for left, right in pairwise(shown))


def test_lowest_forces_of_an_oscillation_hold_one_row_a_cycle():
    """A wiggle by a rounding on the way down is no lowest force of its own."""
    time = np.arange(200.0)
    force = -np.sin(0.35 * time)
    falling = int(np.argmin(np.diff(force)))
    force[falling + 1] = force[falling] + 1e-12
    figure = Figure()
    oscillation(figure.subplots(), SimpleNamespace(trace=lambda scene: trace(time, force)))
    line = next(one for one in figure.axes[0].lines if one.get_label() == r"$\tilde{\omega}$ = 0.35")
    drawn = np.asarray(line.get_xdata()) * unit_sizes(load("oscillation-w0.35").scene)["length"]
    cycles = np.floor(0.35 * drawn / (2.0 * np.pi))
    assert drawn.size > 10
    assert np.unique(cycles).size == cycles.size


def test_a_jump_is_compared_side_by_side():
    """One run has its rows elsewhere, and two amid the jump at t = 1; it is a hundredth of 4 too high."""
    base = {"time": np.array([0.0, 1.0, 1.0, 2.0]), "force": np.array([0.0, 1.0, -4.0, -3.0])}
    time = np.array([0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.5, 2.0, 2.5])
    force = np.array([0.0, 0.5, 1.0, -1.0, -2.0, -4.0, -3.5, -3.0, 9.0]) + 0.04
    curves = [RunCurves("base", "reference", base), RunCurves("run", "bem", {"time": time, "force": force})]
    found = with_differences(curves, "reference")[1].columns
    np.testing.assert_array_equal(found["shared_time"], [0.0, 0.5, 1.0, 1.0, 1.5, 2.0])
    np.testing.assert_allclose(found["difference"], 0.01, rtol=1e-12)
