"""The subtraction of two runs: every number and curve of one against those of another.

What a difference is relative to is stated in :mod:`validation.measure.scaling` for numbers, in
:mod:`validation.measure.norms` for curves and in :mod:`validation.measure.movement_norms` for their movement.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

from contact_scene import Trace
from contact_scene.trace import Array
from validation.measure.check import disagreement
from validation.measure.error_estimate import MOVEMENT
from validation.measure.movement_norms import movement_distance
from validation.measure.norms import CURVES, distance
from validation.measure.scaling import Magnitudes, column_of

NO_TIME = "no common interval of time"


class MeasuredRun(Protocol):
    """A run as far as it is compared: its rows, numbers by name, and what it estimates its errors at."""

    @property
    def curves(self) -> Trace | None: ...
    @property
    def measures(self) -> Mapping[str, float | None]: ...
    @property
    def errors(self) -> Mapping[str, float]: ...


@dataclass(frozen=True)
class Difference:
    """One number or curve of a run against that of another, beside the error estimates of both.

    ``error`` is relative, signed for numbers; infinite where one of the runs gives none, and ``missing`` says
    which. ``note`` says where a curve is farthest off.
    """

    quantity: str
    error: float
    own: float | None = None
    known_to: float | None = None
    note: str = ""
    missing: str = ""

    def disagreement(self, tolerance: float) -> str:
        """Why this is no agreement within a relative tolerance, in words; empty if it is."""
        return self.missing or disagreement(self.error, tolerance, self.own, self.known_to)


def of_numbers(
    run: MeasuredRun, base: MeasuredRun, names: Iterable[str], of_largest: Collection[str] = ()
) -> Iterator[Difference]:
    """Differences of the named numbers, as far as either run has them.

    Those ``of_largest`` are relative to the largest magnitude of their column in the second run.
    """
    sizes = None if base.curves is None else Magnitudes.of_trace(base.curves)
    for name in names:
        value, expected = run.measures.get(name), base.measures.get(name)
        estimates = run.errors.get(name), base.errors.get(name)
        if value is not None and expected is not None and sizes is not None:
            size = sizes.columns[column_of(name)] if name in of_largest else sizes.scale(name, expected)
            yield Difference(name, relative(value - expected, size), *estimates)
        elif value is not None or expected is not None:
            missing = "the reference gives none" if value is not None else "the run does not give it"
            yield Difference(name, math.inf, *estimates, missing=missing)


def of_curves(run: MeasuredRun, base: MeasuredRun, spans: Array | None = None) -> Iterator[Difference]:
    """RMS differences of force and contact radius over the time that both runs cover."""
    for column in CURVES:
        estimates = run.errors.get(column), base.errors.get(column)
        one, other = run.curves, base.curves
        apart = distance(one, other, column, spans) if one and other else None
        if apart is None:
            yield Difference(column, math.inf, *estimates, missing=NO_TIME)
        else:
            largest = f"largest {apart.largest:.2g} at t = {apart.at:.4g}"
            yield Difference(column, apart.rms, *estimates, largest)


def of_movements(run: MeasuredRun, base: MeasuredRun, spans: Array) -> Iterator[Difference]:
    """Differences of the movement of these curves in their worst window, by column with ``MOVEMENT``."""
    for column in CURVES if len(spans) else ():
        key = column + MOVEMENT
        estimates = run.errors.get(key), base.errors.get(key)
        one, other = run.curves, base.curves
        moved = movement_distance(one, other, spans, column) if one and other else None
        if moved is None:
            yield Difference(key, math.inf, *estimates, missing=NO_TIME)
        else:
            worst = f"worst from t = {moved.begin:.4g} to {moved.end:.4g}"
            yield Difference(key, moved.rms, *estimates, worst)


def relative(gap: float, size: float) -> float:
    """The gap over the size; infinite where the size is zero and the gap is not."""
    return gap / size if size > 0.0 else math.copysign(math.inf, gap) if gap else 0.0
