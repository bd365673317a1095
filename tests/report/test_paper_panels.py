"""Curves of the paper's figures, drawn from made-up traces."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from matplotlib.figure import Figure
from support.synthetic_traces import trace

from validation.cases import load
from validation.measure.dimensionless import unit_sizes
from validation.report.figures.paper_panels import oscillation


def test_lowest_forces_of_an_oscillation_hold_one_row_a_cycle():
    """A wiggle by a rounding on the way down is no lowest force of its own."""
    time = np.arange(200.0)
    force = -np.sin(0.35 * time)
    falling = int(np.argmin(np.diff(force)))
    force[falling + 1] = force[falling] + 1e-12
    figure = Figure()
    oscillation(figure, SimpleNamespace(trace=lambda scene: trace(time, force)))
    line = next(one for one in figure.axes[0].lines if one.get_label() == r"$\tilde{\omega}$ = 0.35")
    drawn = np.asarray(line.get_xdata()) * unit_sizes(load("oscillation-w0.35").scene)["length"]
    cycles = np.floor(0.35 * drawn / (2.0 * np.pi))
    assert drawn.size > 10
    assert np.unique(cycles).size == cycles.size
