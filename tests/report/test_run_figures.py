"""Figures of one scene, drawn from made-up curves."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from validation.drawing.curves import SCENE_UNITS, RunCurves
from validation.drawing.run_figures import PANELS, draw

RANGES = [(0.0, 1.0), (-3e-9, 7e-9), (-2.4e8, 1.1e9), (0.24515012, 0.2451503), (-9876.54, -9876.5)]


@pytest.mark.parametrize(("low", "high"), RANGES)
def test_nothing_is_cut_off_and_numbers_do_not_touch(low, high):
    values = np.linspace(low, high, 40)
    columns = dict.fromkeys(("time", "penetration", "force", "contact_radius"), values)
    figure = draw(PANELS[0], [RunCurves("bem", "bem", columns)], SCENE_UNITS)
    figure.draw_without_rendering()
    box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
    assert min(box.x0, box.y0, width - box.x1, height - box.y1) >= 0.0
    assert box.x0 < 0.1  # inches
    (axes,) = figure.axes
    shown = [one.get_window_extent() for one in axes.get_xticklabels() if one.get_text()]
    assert all(left.x1 < right.x0 for left, right in pairwise(shown))
