"""Order of the path of the edge in a step over many process zones: error of its moments against step length.

The edge is known, ``a = 1 + exp(-t)``; each solver is given rows on it, as its run keeps them, and the end of
the next step. No check of a scene sees an order one lower: the step control answers with a few per cent more
steps, and on ``pdms-retraction-100nm`` no observable moves by more than the error of the true solver. With
wrong moments finite elements find no end on a scene, which takes minutes.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from support.faults.injection import gives, seeded, table, takes, times

from bem_solver.motion import BentPath
from fem_solver.edge_path import EdgePolynomial
from fem_solver.state import ComponentState
from validation.reference.path import numerics
from validation.reference.path.path import Rows

ORDER = {"bem": 3, "fem": 4, "reference": 5}
"""Rows that the path goes through, the end of the step among them."""
STEPS = {"bem": (0.05, 0.025), "fem": (0.2, 0.1), "reference": (0.2, 0.1)}
MOST = 1e-4
"""Error of a moment, in steps, at the shorter step."""
SHARES = np.linspace(0.1, 0.9, 9)
EARLIER = 5
"""Rows before the step: more than any solver keeps."""


def edge(time):
    return 1.0 + np.exp(-time)


def by_boundary_elements(h, radii):
    return 1.0 - BentPath.through((h, float(edge(-h))), float(edge(0.0)), h, float(edge(h))).left(radii)


def by_finite_elements(h, radii):
    none = np.zeros(0)
    state = ComponentState(None, none, np.zeros((0, 0)), none, radius=float(edge(-EARLIER * h)))
    for n in range(EARLIER - 1, -1, -1):
        state = replace(state, radius=float(edge(-n * h)), before=state.rows_and_this(h))
    return EdgePolynomial.through(state.radius, float(edge(h)), h, state.before).passed(radii)


def by_the_path(h, radii):
    rows = Rows.at(0.0, np.zeros(1))
    for n in range(EARLIER - 1, -1, -1):
        rows.append(h, h, float(edge(-n * h) - edge(-(n + 1) * h)), 0.0, np.zeros(1))
    way = rows.segment(h, float(edge(h) - edge(0.0))).way
    return numerics.inverse(way, radii - float(edge(0.0)))


MOMENTS = {"bem": by_boundary_elements, "fem": by_finite_elements, "reference": by_the_path}


def has_its_order(solver):
    """Whether moments converge at the order of the solver's path, from above and below, and are close."""
    long, short = (h * np.abs(MOMENTS[solver](h, edge(h * SHARES)) - SHARES).max() for h in STEPS[solver])
    order = math.log2(long / short)
    return abs(order - ORDER[solver]) < 0.3 and short < MOST * STEPS[solver][1]


@pytest.mark.parametrize("solver", MOMENTS)
def test_the_path_has_its_order(solver):
    assert has_its_order(solver)


def _three_kept(true):
    def append(self, *row):
        true(self, *row)
        self.table = self.table[-3:]

    return append


ONE_LESS, ONE_KEPT = "path through one row less", "one row less kept for the path"
FAULTS = table("bem", "bem_solver", [
    ("straight path", "motion:BentPath.through",
     lambda true: lambda cls, rows, edge, duration, end, *_: cls.straight(edge, end)),
    ("points passed a tenth too early", "motion:BentPath.left", times(1.1)),
])  # fmt: skip
FAULTS += table("fem", "fem_solver", [
    ("straight path", "edge_path:EdgePolynomial.through", takes(before=lambda _: ())),
    (ONE_LESS, "edge_path:EdgePolynomial.through", takes(before=lambda rows: rows[:1])),
    (ONE_KEPT, "state:ComponentState.rows_and_this", gives(lambda rows: rows[:1])),
    ("nodes passed at the end of the step", "edge_path:EdgePolynomial.passed",
     gives(lambda share: np.where(share > 0.0, 1.0, 0.0))),
    ("nodes passed 1 % too early", "edge_path:EdgePolynomial.passed", times(0.99)),
])  # fmt: skip
FAULTS += table("reference", "validation.reference.path", [
    ("points passed 1 % too early", "numerics:inverse", times(0.99)),
    (ONE_LESS, "path:Rows.segment", takes(order=lambda order: order - 1)),
    ("parabolic path", "path:Rows.segment", takes(order=lambda _: 2)),
    ("straight path", "path:Rows.segment", takes(order=lambda _: 1)),
    (ONE_KEPT, "path:Rows.append", _three_kept),
])  # fmt: skip


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.key)
def test_a_fault_shows(fault):
    with seeded(fault) as calls:
        assert not has_its_order(fault.solver)
    assert calls.count > 0
