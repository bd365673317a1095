"""Single faults in the path of the edge through a step over many process zones: order and moments.

No check of a scene sees an order one lower. The step control answers to the error of a step: the steps become
a few per cent more, and on ``pdms-retraction-100nm`` no observable moves by more than the error of the true
solver (finite elements: 4e-5 of allowed 5e-3, boundary elements 1e-6 of 1e-3, front tracking 3.6e-5 in the
force at which contact is lost, where it is off by 1.5e-4). What sees them is the order itself:
:mod:`all_solvers.test_path_order`. With wrong moments finite elements find no end on a scene, which is seen
but takes minutes; the same test sees them at once.
"""

from __future__ import annotations

import numpy as np
from support.faults.injection import gives, table, takes, times


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
