"""The limit point of a curve that ripples as the edge passes the nodes."""

from __future__ import annotations

import numpy as np
import pytest

from fem_solver.limit_point import limit_point

ELEMENT, LOST, RIPPLE = 0.1, 1.0, 1e-3


def rows(phase, spacing=0.01, ripple=RIPPLE):
    """Rows down to the last one that the ripple lets an edge reach under prescribed penetration."""
    radius = np.arange(LOST + 6.0 * ELEMENT, LOST - 2.0 * ELEMENT, -spacing)
    away = radius - LOST
    depth = away**2 + 0.2 * away**3 + ripple * np.sin(2.0 * np.pi * radius / ELEMENT + phase)
    force = -0.5 * radius
    rising = np.flatnonzero(np.diff(depth) > 0.0)
    end = int(rising[0]) + 1
    return np.column_stack([depth, force, radius])[:end]


@pytest.mark.parametrize("phase", np.linspace(0.0, 2.0 * np.pi, 8, endpoint=False))
def test_the_limit_point_is_free_of_a_ripple_from_node_to_node(phase):
    last = rows(phase)
    point = limit_point(last, ELEMENT, "penetration")
    if point is None:  # the ripple lets the edge come as near as the fit can tell
        assert abs(last[-1, 2] - LOST) < 0.1 * ELEMENT
    else:
        assert abs(point.radius - LOST) < 0.02 * ELEMENT
        assert point.force == pytest.approx(-0.5 * point.radius)
        assert abs(point.penetration) < 0.1 * RIPPLE


def test_rows_alone_miss_a_good_part_of_an_element():
    assert max(rows(phase)[-1, 2] - LOST for phase in np.linspace(0.0, 6.0, 12)) > 0.2 * ELEMENT


def test_on_a_spring_and_under_a_force_the_extremum_is_that_of_what_is_prescribed():
    last = rows(2.0)
    stage = last.copy()
    stage[:, 0] -= 2.0 * stage[:, 1]
    assert limit_point(stage, ELEMENT, "stage", 2.0).radius == pytest.approx(LOST, abs=0.02 * ELEMENT)
    assert limit_point(last[:, [1, 0, 2]], ELEMENT, "force").radius == pytest.approx(LOST, abs=0.02 * ELEMENT)


@pytest.mark.parametrize("case", ["short", "coarse", "turned", "no extremum"])
def test_rows_that_do_not_tell_a_limit_point_leave_the_last_row(case):
    last = rows(0.0)
    if case == "short":
        last = last[-20:]
    elif case == "coarse":
        last = last[::-1][::6][::-1]
    elif case == "turned":
        last[-5] = last[-3]
    else:
        last[:, 0] = last[:, 2]
    assert limit_point(last, ELEMENT, "penetration") is None
