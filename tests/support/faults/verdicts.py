"""Single faults in norms, verdicts and meshes, which no run of a true solver can show.

``scenes`` holds the check of :mod:`compare.test_verdict_faults`, a number worked out on paper, that has to
show the fault.
"""

from __future__ import annotations

from dataclasses import replace

from support.faults.injection import by, changed, gives, table, takes, times


def _next_row(true):
    def worst(grid, apart, values, spans, *given):
        return true(grid, apart, values, spans + grid[1] - grid[0], *given)

    return worst


FAULTS = table("reference", "validation", [
    ("RMS without its root", "measure.curves:distance", gives(changed(rms=lambda rms: rms**2)), "rms"),
    ("mean of a difference with its sign", "measure.curves:_mean_magnitude",
     lambda true: lambda apart: 0.5 * (apart[0] + apart[-1]), "mean"),
    ("windows one row late", "measure.curves:_worst_window", _next_row, "window"),
    ("mean of a window left in", "measure.curves:_worst_window", takes(centred=by(0.0)), "window"),
    ("sign of a difference dropped", "measure.difference:relative", gives(abs), "sign"),
    ("verdict of one side", "measure.difference:Difference.disagreement",
     takes(self=changed(error=lambda size: max(size, 0.0))), "sides"),
    ("check values of one side", "compare.checks:_stated",
     gives(lambda check: replace(check, passed=check.difference < 0.01)), "sides"),
    ("estimates three times too generous", "measure.difference:agreement_limit",
     lambda true: lambda tolerance, *errors: true(tolerance, *(e and 3.0 * e for e in errors)), "limit"),
], shared=True)  # fmt: skip
FAULTS += table("fem", "meshes", [
    ("grading 1 % too steep", "surface:graded", takes(grading=by(1.01)), "grading"),
    ("sizes 1 % too large", "surface:graded", takes(size=by(1.01)), "grading"),
    ("fine strip of the followed edge 1 % off", "around_edge:EdgeMeshes.scale", times(1.01), "place"),
])  # fmt: skip
