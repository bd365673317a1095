"""The subtraction of two runs: every number and curve of one against those of another.

What a difference is relative to is stated in :mod:`validation.measure.scaling` for numbers, in
:mod:`validation.measure.norms` for curves and in :mod:`validation.measure.movement_norms` for their movement.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

from contact_scene import Trace
from contact_scene.trace import Array
from validation.measure.check import disagreement
from validation.measure.error_estimate import MOVEMENT
from validation.measure.movement_norms import movement_distance
from validation.measure.norms import CURVES, distance
from validation.measure.scaling import Magnitudes


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

    ``error`` is relative, signed for numbers; infinite where the run gives none.
    """

    quantity: str
    error: float
    own: float | None = None
    known_to: float | None = None
    note: str = ""

    def disagreement(self, tolerance: float) -> str:
        """Why this is no agreement within a relative tolerance, in words; empty if it is."""
        error = None if self.note == NO_VALUE else self.error
        return disagreement(error, tolerance, self.own, self.known_to)


NO_VALUE = "the run does not give it"


def of_numbers(run: MeasuredRun, base: MeasuredRun, names: Iterable[str]) -> Iterator[Difference]:
    """Differences of the named numbers, as far as the second run has them."""
    if base.curves is None:
        return
    sizes = Magnitudes.of_trace(base.curves)
    for name in names:
        value, expected = run.measures.get(name), base.measures.get(name)
        if expected is None:
            continue
        estimates = run.errors.get(name), base.errors.get(name)
        if value is None:
            yield Difference(name, math.inf, *estimates, NO_VALUE)
        else:
            yield Difference(name, relative(value - expected, sizes.scale(name, expected)), *estimates)


def of_curves(run: MeasuredRun, base: MeasuredRun, spans: Array | None = None) -> Iterator[Difference]:
    """RMS differences of force and contact radius over the time that both runs cover."""
    if run.curves is None or base.curves is None:
        return
    for column in CURVES:
        apart = distance(run.curves, base.curves, column, spans)
        if apart is not None:
            note = f"largest {apart.largest:.2g} at t = {apart.at:.4g}"
            yield Difference(column, apart.rms, run.errors.get(column), base.errors.get(column), note)


def of_movements(run: MeasuredRun, base: MeasuredRun, spans: Array) -> Iterator[Difference]:
    """Differences of the movement of these curves in their worst window, by column with ``MOVEMENT``."""
    if run.curves is None or base.curves is None or not len(spans):
        return
    for column in CURVES:
        moved = movement_distance(run.curves, base.curves, spans, column)
        if moved is not None:
            key, note = column + MOVEMENT, f"worst from t = {moved.begin:.4g} to {moved.end:.4g}"
            yield Difference(key, moved.rms, run.errors.get(key), base.errors.get(key), note)


def relative(gap: float, size: float) -> float:
    """The gap over the size; infinite where the size is zero and the gap is not."""
    return gap / size if size > 0.0 else math.copysign(math.inf, gap) if gap else 0.0
