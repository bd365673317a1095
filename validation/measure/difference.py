"""The subtraction of two runs, every number and curve of one against those of another, and the verdict on it.

What a difference is relative to is stated in :mod:`validation.measure.scaling` for numbers and in
:mod:`validation.measure.curves` for curves and their movement. Two runs agree where they differ by no more
than both error estimates together, at most by the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Protocol

from contact_scene import Trace
from contact_scene.trace import Array
from validation.measure.curves import CURVES, MOVEMENT, distance, movement_distance
from validation.measure.scaling import ROUND_OFF, Magnitudes, column_of

NO_TIME = "no common interval of time"
SEVERAL = 3.5
"""Largest error estimate, relative to the tolerance, of a run that is worth comparing. Estimates hold a
safety factor of three, so a run beyond it differs from its own coarser run by more than the tolerance, and
agrees with the reference by accident. The largest estimate that is needed is 3.1: the force at which finite
elements lose a contact that was pulled fast (``retraction-fast``), where the edge runs away."""


class Compared(Protocol):
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
        if self.missing:
            return self.missing
        for whose, error in (("the run", self.own), ("the reference", self.known_to)):
            if error is not None and not 0.0 <= error <= SEVERAL * tolerance:
                return f"{whose} estimates its own error at {error:.2g}: the tolerance is {tolerance:.2g}"
        limit, apart = agreement_limit(tolerance, self.own, self.known_to), abs(self.error)
        return "" if apart <= limit else f"differs by {apart:.2g}, not within {limit:.2g}"


@dataclass(frozen=True)
class Check:
    """What a run was expected to show, what it showed, and whether that is within tolerance.

    The form in which all evidence states what passed and what failed: which ``quantity`` of which run, and
    the ``source`` of the expectation. ``found`` is ``None`` if the run does not give it. ``difference`` is
    relative, signed where a sign makes sense, and ``tolerance`` its largest magnitude (``None`` for words and
    one-sided limits); where both runs estimate their errors, their sum is the limit and the tolerance its
    cap. ``relation`` is ``"="``, ``"<="`` or ``">="``; the ``note`` says why, where numbers do not.
    """

    scene: str
    solver: str
    quantity: str
    source: str
    expected: float | str | None
    found: float | str | None
    passed: bool
    unit: str = ""
    difference: float | None = None
    tolerance: float | None = None
    relation: str = "="
    note: str = ""
    estimate: float | None = None
    base_estimate: float | None = None

    @property
    def limit(self) -> float | None:
        """Largest magnitude of ``difference`` that passes."""
        if self.tolerance is None:
            return None
        return agreement_limit(self.tolerance, self.estimate, self.base_estimate)


def of_numbers(
    run: Compared, base: Compared, names: Iterable[str], of_largest: Collection[str] = ()
) -> Iterator[Difference]:
    """Differences of the named numbers, as far as either run has them.

    Those ``of_largest`` are relative to the largest magnitude of their column in the second run. Without its
    rows the largest of its numbers stands for that of a column.
    """
    sizes = Magnitudes.of_measures(base.measures) if base.curves is None else Magnitudes.of_trace(base.curves)
    for name in names:
        value, expected = run.measures.get(name), base.measures.get(name)
        estimates = run.errors.get(name), base.errors.get(name)
        if value is not None and expected is not None:
            size = sizes.columns[column_of(name)] if name in of_largest else sizes.scale(name, expected)
            yield Difference(name, relative(value - expected, size), *estimates)
        elif value is not None or expected is not None:
            missing = "the reference gives none" if value is not None else "the run does not give it"
            yield Difference(name, math.inf, *estimates, missing=missing)


def of_curves(run: Compared, base: Compared, spans: Array | None = None) -> Iterator[Difference]:
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


def of_movements(run: Compared, base: Compared, spans: Array) -> Iterator[Difference]:
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


def agreement_limit(tolerance: float, estimate: float | None, base_estimate: float | None) -> float:
    """Largest relative difference that counts as agreement: the sum of both estimates, at most the tolerance.

    The tolerance alone where one of the runs has no estimate.
    """
    if estimate is None or base_estimate is None:
        return tolerance
    return min(tolerance, estimate + base_estimate + ROUND_OFF)
