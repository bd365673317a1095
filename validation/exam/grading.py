"""The grade of one answer: every number and curve it gives against the reference, and the decade it reaches.

An answer *passes at 1e-k* if every difference is at most 1e-k, or no larger than what the reference estimates
its own error there to be. The place of a maximum, and the edge where it loses its hold, are known to the root
of what the force is known to: their differences count squared. What an answer does not give is not graded.

Curves are compared over the time in which both runs are in contact; when contact is lost is a number of its
own. A difference is relative to the root mean square of the reference in that time, so that a column that is
wrong by a factor is wrong by that factor. Energies have to close, where the answer gives them:

    external work = change of stored energy + energy spent at the edge + loss

Spent at the edge is ``work`` for an area that opens; given back is ``work_closing`` for one that closes. On
a spring of stiffness ``k`` the work is that of the stage, and the spring stores ``F^2/(2 k)``. Where the work
of adhesion follows the speed of the edge the balance is not judged: radii do not hold that speed.

A cohesive law (Dugdale, Lennard-Jones) has no Griffith zone, so at a given range its answer is that of
another model; its answers have to tend to that of a vanishing zone as the range goes to zero (see
:func:`zone_of`). That is judged on elastic spheres: under relaxation the zone sets the speed scale, and there
is no limit.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from contact_scene import COLUMNS, Adhesion, OutcomeKind, Scene, Sphere, Trace
from validation.cases import Case
from validation.exam.answer import Answer
from validation.measure.curves import MOVEMENT, Distance, distance
from validation.measure.difference import Difference, of_movements, of_numbers
from validation.measure.events import is_located
from validation.measure.observables import measure
from validation.measure.scaling import LEAST_SHARE, column_of
from validation.measure.windows import cycle_times, windows
from validation.runs.run import Run
from validation.runs.run import run as run_solver
from validation.solvers import REFERENCE
from validation.solvers.contact_range import largest_contact_radius

FINEST, COARSEST = 6, 2
"""Finest decade that is certified: what the reference is good to at best; coarsest that passes."""
PLACES = (
    *("peak_time", "pull_off_time", "pull_off_penetration", "pull_off_radius"),
    *("detachment_radius", "detachment_force"),
)
"""Places of a maximum and states at a limit point: an error of the force moves them by its root."""
AT_LOSS = ("detachment_radius", "detachment_force")
"""States at the loss of contact that are zero without adhesion: the last row before is as good as another."""
ENERGIES = {"stored_energy", "external_work", "dissipated_energy"}
NEEDED = {
    "loop_energy": {"external_work"},
    "dissipated_energy": {"dissipated_energy", "contact_radius"},
    "start": set[str](),
    "approach": {"penetration"},
    "peak_force": set[str](),
    "peak_time": {"force"},
    "pull_off": {"force", "penetration"},
    "detachment": {"contact_radius"},
    "final": set[str](),
}
"""Columns that a number is measured on beside its own, by how its name begins; any other is not graded."""
LEAST_FACTOR, PLAIN_FACTOR = 1e-2, 0.1
"""A constant factor is told if it departs from 1 by more than passes and leaves no more than a tenth over."""
POSITIVE = {
    "force": "compression is positive",
    "penetration": "downwards is positive",
    "external_work": "work done on the half-space is positive",
}
BALANCE, OUTCOME, COVERED = "energy balance", "outcome", "time covered"
VANISHING = 1e-5
"""Zone over contact radius of the limit: its error, of first order in it, is below any decade graded."""
FEWEST, LEAST_ORDER = 3, 0.5
"""Answers from which an order is seen; least order of the error in the zone: theory gives 1 and more."""
SEEN_IN = "pull_off_force"
"""Quantity whose error is followed to the limit."""


@dataclass(frozen=True)
class Grade:
    """An answer, its differences, the decade they reach, and remarks on its columns; none if unreadable."""

    answer: Answer
    differences: tuple[Difference, ...] = ()
    decade: int = 0
    remarks: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether the answer is good to one percent or better."""
        return self.decade >= COARSEST

    @property
    def worst(self) -> Difference | None:
        """The difference that counts most."""
        return max(self.differences, key=counted, default=None)

    @property
    def counted(self) -> float:
        """What the worst difference counts; infinite of an answer that cannot be read."""
        return math.inf if self.answer.problem else max(map(counted, self.differences), default=0.0)

    @property
    def faults(self) -> list[str]:
        """What is told of the columns, and the worst difference: why this does not pass."""
        if self.worst is None:
            return [self.answer.problem or "the answer has no column that can be compared"]
        size = f": off by {abs(self.worst.error):.2g}" if math.isfinite(self.worst.error) else ""
        note = self.worst.note if self.worst.note not in self.remarks else ""
        return [*self.remarks, f"{self.worst.quantity}{size}{f' ({note})' if note else ''}"]

    def error(self, quantity: str) -> float | None:
        """One difference by name."""
        return next((one.error for one in self.differences if one.quantity == quantity), None)


def grade(answer: Answer, scene: Scene, base: Run) -> Grade:
    """Grade an answer against a run of the reference with its error estimates."""
    reference = base.trace
    if answer.problem or reference is None:
        return Grade(answer)
    trace, given = answer.trace(), set(answer.columns)
    run = Run(base.scene, answer.header.code, trace, measures=measure(trace, scene, 0.0))
    here, there = in_contact(trace), in_contact(reference)
    curves = list(_curves(here, there, given, base))
    found = [*curves, *_numbers(run, base, scene, given)]
    if cycle_times(scene.loading):  # curves relative to their excursion in the worst cycle or load step
        moved = replace(run, trace=here), replace(base, trace=there), windows(scene.loading, reference)
        for one in of_movements(*moved):
            column = one.quantity.removesuffix(MOVEMENT)
            if column in given and not one.missing:
                found.append(replace(one, quantity=f"{column}, movement"))
    found += _ending(given, trace, reference)
    left = balance_error(given, here, scene)
    if left is not None:
        found.append(Difference(BALANCE, left))
    return Grade(answer, tuple(found), decade(found, base), tuple(one.note for one in curves if one.note))


def counted(one: Difference) -> float:
    """A difference as it counts: nothing within what the reference knows, squared for places."""
    size = abs(one.error)
    if size <= (one.known_to or 0.0):
        return 0.0
    return size**2 if one.quantity in PLACES else size


def decade(differences: Iterable[Difference], base: Run) -> int:
    """The largest k at which all differences pass, as far as the reference is known; 0 if none does."""
    errors = [counted(one) for one in differences]
    if not errors:
        return 0
    worst = max(*errors, *(base.errors.get(name, 0.0) for name in ("force", "contact_radius")))
    if not math.isfinite(worst):
        return 0
    return min(max(math.floor(-math.log10(worst) + 1e-9), 0), FINEST) if worst > 0.0 else FINEST


def in_contact(trace: Trace) -> Trace:
    """The rows up to the last one in contact, of a run that lost it."""
    touching = np.flatnonzero(trace.contact_radius > 0.0)
    if trace.outcome.kind is not OutcomeKind.DETACHED or not touching.size:
        return trace
    columns = {name: getattr(trace, name)[: touching[-1] + 1] for name in COLUMNS}
    return Trace(trace.solver, **columns, outcome=trace.outcome, counters=trace.counters)


def _curves(here: Trace, there: Trace, given: set[str], base: Run) -> Iterator[Difference]:
    """Every column the answer has, noted where a constant factor explains what it is off by."""
    energy = max((base.errors.get(name, 0.0) for name in ("loop_energy", "dissipated_energy")), default=0.0)
    most = max(float(np.abs(getattr(there, name)).max()) for name in ENERGIES)
    for column in COLUMNS[1:]:
        apart = distance(here, there, column) if column in given else None
        if apart is None:
            continue
        # what an energy balance leaves may be next to nothing
        size = max(apart.level, LEAST_SHARE * most / apart.size if column in ENERGIES else 0.0)
        error = apart.rms / size if size > 0.0 else math.inf if apart.rms > 0.0 else 0.0
        known = base.errors.get(column, energy) * (float(apart.level > 0.0) / size if size > 0.0 else 1.0)
        yield Difference(f"{column}, curve", error, known_to=known, note=_factor_in_words(column, apart))


def _factor_in_words(column: str, apart: Distance) -> str:
    """What a constant factor that explains the difference of a column suggests; empty if none does."""
    factor, name = apart.factor, column.replace("_", " ")
    away = abs(factor - 1.0)
    if away <= LEAST_FACTOR or apart.rms >= math.hypot(1.0, PLAIN_FACTOR) * away * apart.level:
        return ""
    if abs(factor) < 1e-9:
        return f"{name} is zero throughout"
    if abs(factor + 1.0) < PLAIN_FACTOR:
        return f"{name} has the other sign: {POSITIVE.get(column, 'it is positive here')}"
    hint = ", a diameter?" if column == "contact_radius" and abs(factor - 2.0) < PLAIN_FACTOR else ""
    other = ", another unit or sign?" if not 0.1 < factor < 10.0 else hint
    return f"{name} is {factor:.4g} times the reference throughout{other}"


def _numbers(run: Run, base: Run, scene: Scene, given: set[str]) -> Iterator[Difference]:
    assert base.trace is not None
    lost = base.trace.outcome.kind is OutcomeKind.DETACHED
    for one in of_numbers(run, base, base.measures):
        name = one.quantity
        needed = next((columns for begin, columns in NEEDED.items() if name.startswith(begin)), None)
        if base.measures[name] is None or needed is None or not needed | ({column_of(name)} - {""}) <= given:
            continue
        after = lost and name.startswith("final")
        vanishes = name in AT_LOSS and not scene.is_adhesive
        outcome_says_so = run.measures.get(name) is None and name.startswith("detachment")
        if not (after or vanishes or outcome_says_so) and is_located(name, base.trace, scene.loading):
            yield replace(one, note=one.missing)


def _ending(given: set[str], trace: Trace, reference: Trace) -> Iterator[Difference]:
    """Whether contact is lost as in the reference, and how much of the run is missing."""
    kind, lost = reference.outcome.kind, trace.outcome.kind is OutcomeKind.DETACHED
    if kind in (OutcomeKind.COMPLETED, OutcomeKind.DETACHED):
        if lost and kind is OutcomeKind.COMPLETED:
            yield Difference(OUTCOME, math.inf, note=f"loses contact at t = {trace.outcome.time:.4g}")
        if not lost and kind is OutcomeKind.DETACHED and "contact_radius" in given:
            yield Difference(OUTCOME, math.inf, note="does not lose contact")
        if lost:
            return
    begin, end = reference.time[0], reference.time[-1]
    missing = max(end - trace.time[-1], 0.0) + max(trace.time[0] - begin, 0.0)
    if end > begin:
        yield Difference(COVERED, float(missing / (end - begin)))


def balance_error(given: set[str], rows: Trace, scene: Scene) -> float | None:
    """What the energies of rows in contact leave, relative to the largest; ``None`` if not to be judged."""
    compliance, adhesion = scene.loading.compliance, scene.adhesion
    needed = ENERGIES | {"contact_radius"} | ({"force"} if compliance > 0.0 else set())
    if not needed <= given or len(rows) < 2 or (adhesion is not None and adhesion.rate is not None):
        return None
    stored = rows.stored_energy + 0.5 * compliance * rows.force**2
    opened = -np.pi * np.diff(rows.contact_radius**2)
    work, closing = (0.0, 0.0) if adhesion is None else (adhesion.work, adhesion.closing)
    spent = np.concatenate(([0.0], np.cumsum(np.where(opened > 0.0, work, closing) * opened)))
    left = rows.external_work - stored - spent - rows.dissipated_energy
    largest = max(float(np.abs(term).max()) for term in (stored, rows.external_work, spent))
    return float(np.abs(left - left[0]).max()) / largest if largest > 0.0 else None


@dataclass(frozen=True)
class RangeError:
    """Signed relative error of ``SEEN_IN`` at a transition parameter, which stands for a zone."""

    transition: float
    zone: float
    error: float


@dataclass(frozen=True)
class GriffithTrack:
    """Answers of one code over the range of its attraction, the longest first.

    ``order`` is the fitted exponent of the error over the zone, ``remaining`` the error that is left where
    the zone is extrapolated to zero. A code without a zone has no points, and the ``decade`` of its whole
    answer at the Griffith limit.
    """

    points: tuple[RangeError, ...]
    order: float = 0.0
    remaining: float = 0.0
    decade: int = 0

    @property
    def converges(self) -> bool:
        """Whether the errors fall with the range, to nothing as far as can be seen."""
        if not self.points:
            return self.decade >= COARSEST
        falling = all(abs(after.error) < abs(before.error) for before, after in pairwise(self.points))
        return falling and self.order >= LEAST_ORDER and abs(self.remaining) <= 10.0**-COARSEST

    @property
    def in_words(self) -> str:
        """One line."""
        if not self.points:
            return f"an edge without a zone: at the Griffith limit good to 1e-{self.decade}"
        first, last = self.points[0], self.points[-1]
        return (
            f"against the Griffith limit {SEEN_IN.replace('_', ' ')} is off by {abs(first.error):.2g} at "
            f"transition {first.transition:g}, {abs(last.error):.2g} at {last.transition:g}: as zone^"
            f"{self.order:.2f}, {abs(self.remaining):.1e} left at zero"
        )


def zone_of(transition: float, radius: float, plane_modulus: float, work: float) -> float:
    """Length ``pi (16 pi/9)^(-2/3) lambda^-2 (dg R^2/E*)^(1/3)`` of the zone of Maugis' parameter ``lambda``.

    With ``lambda = 2 s0/(pi dg K^2/R)^(1/3)``, ``K = 4 E*/3`` (D. Maugis, J. Colloid Interface Sci. 150, 243,
    1992) that is ``d = (pi/8) (K_I/s0)^2``, over which a constant stress ``s0`` acts at a crack tip of energy
    release rate ``K_I^2/(2 E*) = dg`` (D.S. Dugdale, J. Mech. Phys. Solids 8, 100, 1960).
    """
    unit = np.cbrt(work * radius**2 / plane_modulus)
    return float(np.pi * (16.0 * np.pi / 9.0) ** (-2.0 / 3.0) / transition**2 * unit)


def griffith_track(answers: Iterable[Answer], case: Case) -> GriffithTrack | None:
    """The track of a code on a scene; ``None`` where it states too few transition parameters for one."""
    scene, sphere, adhesion = case.scene, case.scene.indenter, case.scene.adhesion
    stated = {one.header.transition: one for one in answers if one.header.transition and not one.problem}
    if (len(stated) < FEWEST and math.inf not in stated) or adhesion is None or not scene.is_adhesive:
        return None
    plain = adhesion.rate is None and adhesion.work_closing is None and scene.material.is_elastic
    if not plain or not isinstance(sphere, Sphere):
        return None
    at_limit = replace(scene, adhesion=Adhesion(adhesion.work, VANISHING * largest_contact_radius(scene)))
    limit = run_solver(replace(case, scene=at_limit), REFERENCE, estimate=True)
    if limit.curves is None:
        return None
    if math.inf in stated:
        return GriffithTrack((), decade=grade(stated[math.inf], at_limit, limit).decade)
    points = []
    for transition, answer in sorted(stated.items()):
        error = grade(answer, at_limit, limit).error(SEEN_IN)
        if error is not None and math.isfinite(error):
            zone = zone_of(transition, sphere.radius, scene.material.relaxed_plane_modulus, adhesion.work)
            points.append(RangeError(transition, zone, error))
    return None if len(points) < FEWEST else track_of(points)


def track_of(points: list[RangeError]) -> GriffithTrack:
    """Order by least squares of logarithms; what is left by extrapolation of the last two with it."""
    sizes = [max(abs(point.error), np.finfo(float).tiny) for point in points]
    order = float(np.polyfit(np.log([point.zone for point in points]), np.log(sizes), 1)[0])
    before, last = points[-2:]
    ratio = (before.zone / last.zone) ** order - 1.0
    remaining = last.error - (before.error - last.error) / ratio if ratio > 0.0 else last.error
    return GriffithTrack(tuple(points), order, float(remaining))
