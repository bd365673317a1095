"""Curves of figures, drawn from made-up traces."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from matplotlib.figure import Figure
from support.synthetic_traces import trace

from validation.cases import load
from validation.claims.paper_figures import oscillation
from validation.drawing.curves import RunCurves, with_differences
from validation.measure.scaling import unit_sizes


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
