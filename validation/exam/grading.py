"""The grade of one answer: every number and curve it gives against the reference, and the decade it reaches.

An answer *passes at 1e-k* if every difference is at most 1e-k, or no larger than what the reference estimates
its own error there to be. The place of a maximum, and the edge where it loses its hold, are known to the root
of what the force is known to: their differences count squared. What an answer does not give is not graded.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from contact_scene import COLUMNS, OutcomeKind, Scene, Trace
from validation.exam.answer import Answer
from validation.exam.curve_errors import curve_error, factor_in_words, in_contact
from validation.exam.energy_balance import balance_error
from validation.execution.runs import Run
from validation.measure.approach import is_located
from validation.measure.cycles import cycle_times
from validation.measure.error_estimate import MOVEMENT
from validation.measure.movement_norms import movement_distance
from validation.measure.scalars import measure
from validation.measure.scaling import Magnitudes, column_of
from validation.measure.windows import windows

FINEST = 6
"""Finest decade that is certified: what the reference is good to at best."""
COARSEST = 2
"""Coarsest decade that passes: beyond one percent an answer is wrong."""
PLACES = (
    "peak_time",
    "pull_off_time",
    "pull_off_penetration",
    "pull_off_radius",
    "detachment_radius",
    "detachment_force",
)
"""Places of a maximum and states at a limit point: an error of the force moves them by its root."""
VANISHING = ("detachment_radius", "detachment_force")
"""States at the loss of contact that are zero without adhesion: the last row before is as good as another."""
OF_ENERGY = {"loop_energy": "external_work", "dissipated_energy": "dissipated_energy"}
_PARTS = ("start", "approach", "peak_force", "peak_time", "pull_off", "detachment", "final")
BALANCE = "energy balance"
OUTCOME = "outcome"
COVERED = "time covered"


@dataclass(frozen=True)
class Difference:
    """One number or curve of an answer against the reference.

    Parameters
    ----------
    quantity : str
    error : float
        Relative; infinite where the answer has what the reference has not.
    known_to : float
        What the reference estimates its own error at.
    note : str
    """

    quantity: str
    error: float
    known_to: float = 0.0
    note: str = ""

    @property
    def counted(self) -> float:
        """The difference as it counts: nothing within what the reference knows, squared for places."""
        size = abs(self.error)
        if size <= self.known_to:
            return 0.0
        return size**2 if self.quantity in PLACES else size


@dataclass(frozen=True)
class Grade:
    """All differences of an answer, the decade they reach, and what is told of its columns."""

    differences: tuple[Difference, ...]
    decade: int
    remarks: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether the answer is good to one percent or better."""
        return self.decade >= COARSEST

    @property
    def worst(self) -> Difference | None:
        """The difference that counts most."""
        return max(self.differences, key=lambda one: one.counted, default=None)

    def error(self, quantity: str) -> float | None:
        """One difference by name."""
        return next((abs(one.error) for one in self.differences if one.quantity == quantity), None)


def grade(answer: Answer, scene: Scene, base: Run) -> Grade:
    """Grade an answer that can be read against a run of the reference.

    Parameters
    ----------
    answer : Answer
        That can be read.
    scene : Scene
    base : Run
        Of the reference, with its error estimates.

    Returns
    -------
    Grade
    """
    reference, trace = base.trace, answer.trace()
    assert reference is not None, "an exam is held only where the reference has an answer"
    told: list[str] = []
    differences = [
        *_curves(answer, trace, reference, base, told),
        *_scalars(answer, trace, scene, reference, base),
        *_movements(answer, trace, scene, reference, base),
        *_ending(answer, trace, reference),
    ]
    left = balance_error(set(answer.columns), in_contact(trace), scene)
    if left is not None:
        differences.append(Difference(BALANCE, left))
    return Grade(tuple(differences), decade(differences, base), tuple(told))


def decade(differences: list[Difference], base: Run) -> int:
    """The largest k at which all differences pass, as far as the reference is known; 0 if none does."""
    if not differences:
        return 0
    known = max((base.errors.get(name, 0.0) for name in ("force", "contact_radius")), default=0.0)
    finest = min(FINEST, _digits(known))
    return max(min(finest, *(_digits(one.counted) for one in differences)), 0)


def _digits(error: float) -> int:
    """Largest k with error <= 1e-k."""
    if not math.isfinite(error):
        return 0
    return FINEST if error <= 0.0 else math.floor(-math.log10(error) + 1e-9)


def _curves(
    answer: Answer, trace: Trace, reference: Trace, base: Run, told: list[str]
) -> Iterator[Difference]:
    """Every column the answer has; what a factor suggests goes to ``told``."""
    there, here = in_contact(reference), in_contact(trace)
    energy = max((base.errors.get(name, 0.0) for name in OF_ENERGY), default=0.0)
    for column in COLUMNS[1:]:
        if column not in answer.columns:
            continue
        found = curve_error(here, there, column)
        if found is None:
            continue
        known = base.errors.get(column, energy)
        note = "" if found.factor is None else factor_in_words(column, found.factor)
        if note:
            told.append(note)
        yield Difference(f"{column}, curve", found.error, known * found.amplitude, note)


def _scalars(answer: Answer, trace: Trace, scene: Scene, reference: Trace, base: Run) -> Iterator[Difference]:
    measured = measure(trace, scene, 0.0)
    sizes = Magnitudes.of_trace(reference)
    for name, expected in base.measures.items():
        needed = _needed(name)
        if expected is None or not needed or not needed <= set(answer.columns):
            continue
        if not is_located(name, reference, scene.loading):
            continue
        if name.startswith("final") and reference.outcome.kind is OutcomeKind.DETACHED:
            continue
        if name in VANISHING and not scene.is_adhesive:
            continue
        value, size = measured.get(name), sizes.scale(name, expected)
        if value is None:
            if not name.startswith("detachment"):  # the outcome says so
                yield Difference(name, math.inf, note="the answer has none")
        elif size > 0.0:
            yield Difference(name, (value - expected) / size, base.errors.get(name, 0.0))
        elif value != expected:
            yield Difference(name, math.inf, note="the reference has zero")


def _needed(name: str) -> set[str]:
    """Columns that a scalar is measured on; none for what is not graded."""
    if name in OF_ENERGY:
        return {OF_ENERGY[name]} | ({"contact_radius"} if name == "dissipated_energy" else set())
    part = next((part for part in _PARTS if name.startswith(part)), None)
    if part is None:
        return set()
    more = {"approach": {"penetration"}, "peak_time": {"force"}, "pull_off": {"force", "penetration"}}
    return {column_of(name)} | more.get(part, {"contact_radius"} if part == "detachment" else set())


def _movements(
    answer: Answer, trace: Trace, scene: Scene, reference: Trace, base: Run
) -> Iterator[Difference]:
    """In scenes with cycles the curves relative to their excursion in the worst cycle or load step."""
    if not cycle_times(scene.loading):
        return
    spans = windows(scene.loading, reference)
    for column in ("force", "contact_radius"):
        if column in answer.columns:
            moved = movement_distance(in_contact(trace), in_contact(reference), spans, column)
            if moved is not None:
                known = base.errors.get(column + MOVEMENT, 0.0)
                note = f"worst from t = {moved.begin:.4g} to {moved.end:.4g}"
                yield Difference(f"{column}, movement", moved.rms, known, note)


def _ending(answer: Answer, trace: Trace, reference: Trace) -> Iterator[Difference]:
    """Whether contact is lost as in the reference, and how much of the run is missing."""
    if reference.outcome.kind in (OutcomeKind.COMPLETED, OutcomeKind.DETACHED):
        lost = trace.outcome.kind is OutcomeKind.DETACHED
        if lost and reference.outcome.kind is OutcomeKind.COMPLETED:
            yield Difference(OUTCOME, math.inf, note=f"loses contact at t = {trace.outcome.time:.4g}")
            return
        if "contact_radius" in answer.columns and lost != (reference.outcome.kind is OutcomeKind.DETACHED):
            yield Difference(OUTCOME, math.inf, note="does not lose contact")
        if lost:
            return
    span = float(reference.time[-1] - reference.time[0])
    missing = max(float(reference.time[-1] - trace.time[-1]), 0.0)
    missing += max(float(trace.time[0] - reference.time[0]), 0.0)
    if span > 0.0:
        yield Difference(COVERED, missing / span)
