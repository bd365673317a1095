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
from support.faults.injection import Fault

PATH, FOLLOWING = "validation.reference.path", "fem_solver.following"


def _fewer_rows(count):
    return lambda true: lambda self, s, a, *_: true(self, s, a, count)


FAULTS = [
    Fault("bem", "straight path", "bem_solver.bent_path:BentPath.through",
          lambda true: lambda cls, rows, edge, duration, end, *_: cls.straight(edge, end)),
    Fault("bem", "path through one row less", "bem_solver.bent_path:BentPath.through",
          lambda true: lambda cls, rows, *given: true(cls, rows[:1], *given)),
    Fault("fem", "straight path", f"{FOLLOWING}.path:EdgePolynomial.through",
          lambda true: lambda cls, start, end, dt, before: true(cls, start, end, dt, ())),
    Fault("fem", "path through one row less", f"{FOLLOWING}.path:EdgePolynomial.through",
          lambda true: lambda cls, start, end, dt, before: true(cls, start, end, dt, before[:1])),
    Fault("fem", "one row less kept for the path", f"{FOLLOWING}.state:FollowingState.rows_and_this",
          lambda true: lambda self, dt: true(self, dt)[:1]),
    Fault("bem", "points passed a tenth too early", "bem_solver.bent_path:BentPath.left",
          lambda true: lambda self, radius: 1.1 * true(self, radius)),
    Fault("fem", "nodes passed at the end of the step", f"{FOLLOWING}.path:EdgePolynomial.passed",
          lambda true: lambda self, radii: np.where(true(self, radii) > 0.0, 1.0, 0.0)),
    Fault("fem", "nodes passed 1 % too early", f"{FOLLOWING}.path:EdgePolynomial.passed",
          lambda true: lambda self, radii: 0.99 * true(self, radii)),
    Fault("reference", "points passed 1 % too early", f"{PATH}.polynomials:inverse",
          lambda true: lambda way, rise: 0.99 * true(way, rise)),
    Fault("reference", "path through one row less", f"{PATH}.path:Rows.segment", _fewer_rows(3)),
    Fault("reference", "parabolic path", f"{PATH}.path:Rows.segment", _fewer_rows(2)),
    Fault("reference", "straight path", f"{PATH}.path:Rows.segment", _fewer_rows(1)),
]  # fmt: skip
