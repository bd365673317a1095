"""Heat of an edge that opens, turns and closes past where it set off.

One branch relaxes over a hundred times the duration, one over a thousandth of it: the tip's release changes a
hundredfold where the edge turns and where it meets the place again. No check of a scene sees that forgotten:
the step control answers with up to a quarter more steps, and no observable of the quick suite moves beyond
1.1e-3.
"""

from __future__ import annotations

import numpy as np
import pytest
from support.bem_runs import bem, front
from support.faults.injection import gives, seeded, table, times
from support.paper_scenes import scene

from bem_solver import Options, solve
from contact_scene import Branch, Material, Ramp

QUESTION = scene(
    Ramp(0.03, 0.01),
    Ramp(0.036, 0.01),
    start="relaxed",
    at=0.032,
    material=Material(0.75, 0.5, (Branch(2.0, 1e-3), Branch(9.0, 100.0))),
)
MOST = 5e-3
"""Error relative to front tracking, three times that of the boundary elements, a fifth of that of a fault."""


def error_of_heat(trace):
    expected = front(QUESTION).extra["branch_dissipation"][-1]
    return abs(trace.extra["branch_dissipation"][-1] / expected - 1.0)


def test_heat_of_a_turned_edge_is_that_of_front_tracking():
    assert error_of_heat(bem(QUESTION, resolution=9)) < MOST


FAULTS = table("bem", "bem_solver", [
    ("no kink where the edge turned", "history:updated_kinks", gives(lambda found: ((), *found[1:]))),
    ("inverse root inside the old edge left out", "surface:EdgeKinks.strengths", times(0.0)),
])  # fmt: skip
SLOW = "bem: no kink where the edge turned"


@pytest.mark.parametrize(
    "fault",
    [pytest.param(one, id=one.key, marks=pytest.mark.slow if one.key == SLOW else ()) for one in FAULTS],
)
def test_a_fault_shows(fault):
    with np.errstate(all="ignore"), seeded(fault) as calls:
        assert error_of_heat(solve(QUESTION, Options(9))) > MOST
    assert calls.count > 0
