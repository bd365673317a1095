"""Single faults in norms, verdicts and meshes, which no run of a true solver can show.

``scenes`` holds the check of :mod:`compare.test_verdict_faults`, a number worked out on paper, that has to
show the fault.
"""

from __future__ import annotations

from dataclasses import replace

from support.faults.injection import Fault

NORMS, COMPARE = "validation.measure.curves", "validation.compare"
MOVEMENT = "validation.measure.curves"


def _squared(true):
    def distance(*given):
        found = true(*given)
        return replace(found, rms=found.rms**2)

    return distance


def _next_row(true):
    def worst(grid, apart, values, spans, *given):
        step = grid[1] - grid[0]
        return true(grid, apart, values, spans + step, *given)

    return worst


FAULTS = [
    Fault("reference", "RMS without its root", f"{NORMS}:distance", _squared, ("rms",), True),
    Fault("reference", "mean of a difference with its sign", f"{NORMS}:_mean_magnitude",
          lambda true: lambda apart: 0.5 * (apart[0] + apart[-1]), ("mean",), True),
    Fault("reference", "windows one row late", f"{MOVEMENT}:_worst_window", _next_row, ("window",), True),
    Fault("reference", "mean of a window left in", f"{MOVEMENT}:_worst_window",
          lambda true: lambda grid, apart, values, spans, *_: true(grid, apart, values, spans, 0.0),
          ("window",), True),
    Fault("reference", "sign of a difference dropped", "validation.measure.difference:relative",
          lambda true: lambda *given: abs(true(*given)), ("sign",), True),
    Fault("reference", "verdict of one side", "validation.measure.difference:disagreement",
          lambda true: lambda difference, *limits: true(difference and max(difference, 0.0), *limits),
          ("sides",), True),
    Fault("reference", "check values of one side", f"{COMPARE}.checks:_stated",
          lambda true: lambda *given: replace(true(*given), passed=true(*given).difference < 0.01),
          ("sides",), True),
    Fault("reference", "estimates three times too generous", "validation.measure.difference:agreement_limit",
          lambda true: lambda tolerance, *errors: true(tolerance, *(e and 3.0 * e for e in errors)),
          ("limit",), True),
    Fault("fem", "grading 1 % too steep", "meshes.surface:graded",
          lambda true: lambda start, stop, size, grading: true(start, stop, size, 1.01 * grading),
          ("grading",)),
    Fault("fem", "sizes 1 % too large", "meshes.surface:graded",
          lambda true: lambda start, stop, size, grading: true(start, stop, 1.01 * size, grading),
          ("grading",)),
    Fault("fem", "fine strip of the followed edge 1 % off", "meshes.around_edge:EdgeMeshes.scale",
          lambda true: lambda self, place: 1.01 * true(self, place), ("place",)),
]  # fmt: skip
