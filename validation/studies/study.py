"""A study of scenes: every ladder of every scheme run, timed where costs are compared, and its orders.

Timed ladders run alone, in this process, after a warm-up run of their scheme; the others share the cores.
Everything is measured against the finest front tracking, and each observable is extrapolated from its values
alone. A level that failed keeps its place.
"""

from __future__ import annotations

import math
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field, replace

from contact_scene import SceneError
from validation.cases import Case
from validation.measure.curves import distance
from validation.measure.difference import of_numbers
from validation.measure.events import is_located
from validation.measure.scaling import Magnitudes
from validation.measure.windows import windows
from validation.runs.pool import Task, TaskResult, processes, run_tasks
from validation.runs.progress import Progress
from validation.runs.provenance import fingerprint, stamp
from validation.runs.run import Run
from validation.runs.store import Store
from validation.studies.ladders import REFERENCE, Ladder, Level, Settings, finest, ladders, scheme
from validation.studies.orders import Extrapolation, extrapolate, fitted_slope, reference_orders

SCALARS = (
    "start_force",
    "start_radius",
    "approach_force",
    "approach_radius",
    "pull_off_force",
    "detachment_penetration",
    "loop_energy",
    "dissipated_energy",
    "peak_cycle_loss",
)
NORMS = ("force, RMS", "force, mean", "force, largest", "radius, RMS")
"""Errors of curves, relative to the largest magnitude of the reference (:mod:`validation.measure.curves`)."""
REPEATS = 3
"""Largest number of runs of a timed level, of which the fastest counts."""
ENOUGH_SECONDS = 1.0
"""Wall time of all runs of a level after which it is not repeated: longer ones scatter little."""
FinestReference = tuple[Run | None, int, str]
"""Of a scene, its resolution (0 without one), and what it is, or why there is none, in words."""


@dataclass(frozen=True)
class LevelRun:
    """One level: its results, or why it has none.

    ``wall_seconds`` and ``cpu_seconds`` are the smallest of ``repeats`` runs, imports excluded, meshing and
    assembly included. ``errors`` are relative to the reference, signed but for norms. ``refused``: the scheme
    does not take the scene, which is no failure.
    """

    level: Level
    values: dict[str, float | None] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    counters: dict[str, int] = field(default_factory=dict)
    wall_seconds: float | None = None
    cpu_seconds: float | None = None
    repeats: int = 0
    outcome: str = ""
    failure: str = ""
    refused: bool = False
    details: str = ""

    @property
    def failed(self) -> bool:
        """Whether this level has no complete result."""
        return bool(self.failure)


@dataclass(frozen=True)
class TimedRun:
    """A run with the least times of several ``repeats``."""

    run: Run
    repeats: int

    @property
    def breakdown(self) -> str:
        """Why there is no answer, where another attempt may give one."""
        return self.run.breakdown


@dataclass(frozen=True)
class Row:
    """One observable on one ladder.

    ``values`` are by level, ``None`` for norms, which have no value but their error; ``errors`` against the
    reference, ``orders`` those of every two neighbouring levels, ``fitted`` the slope of ``log |error|`` over
    ``log h`` through all levels. Errors and bounds are relative to ``scale``; ``alone`` is read from the
    values alone.
    """

    observable: str
    values: tuple[float | None, ...]
    errors: tuple[float | None, ...]
    orders: tuple[float | None, ...]
    fitted: float | None
    scale: float
    alone: Extrapolation | None


@dataclass(frozen=True)
class Convergence:
    """A ladder with its runs and observables."""

    ladder: Ladder
    nominal: float
    runs: tuple[LevelRun, ...]
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class SceneStudy:
    """All ladders of one scene; ``reference`` in words, ``uncertainty`` its estimated relative errors."""

    case: Case
    reference: str
    uncertainty: dict[str, float]
    ladders: list[Convergence]

    @property
    def timed(self) -> list[Convergence]:
        """The ladders that make up error against run time."""
        return [study for study in self.ladders if study.ladder.timed]

    @property
    def failed(self) -> list[tuple[Convergence, LevelRun]]:
        """Levels without an answer to a scene that their scheme takes."""
        runs = [(study, run) for study in self.ladders for run in study.runs]
        return [(study, run) for study, run in runs if run.failed and not run.refused]


@dataclass(frozen=True)
class Study:
    """All scenes, where and how long they ran."""

    scenes: list[SceneStudy]
    environment: dict[str, object]
    wall_seconds: float


def study(
    cases: list[Case],
    workers: int,
    progress: Progress,
    store: Store | None = None,
    max_steps: int | None = None,
) -> Study:
    """Run all ladders of the given scenes; ``workers`` are processes for what is not timed.

    ``progress`` is closed at the end. Levels of an earlier attempt are taken over from ``store``, run times
    included.
    """
    store = store or Store()
    try:
        scenes = [_study_scene(case, workers, progress, store, max_steps) for case in cases]
    finally:
        progress.close()
    return Study(scenes, stamp(), store.seconds)


def _study_scene(
    case: Case, workers: int, progress: Progress, store: Store, max_steps: int | None
) -> SceneStudy:
    """The reference first; then the timed ladders, alone; then the others together."""
    all_ladders = ladders(case.scene)
    declined = {ladder.scheme: _refusal(case, ladder.scheme) for ladder in all_ladders}
    taken = [ladder for ladder in all_ladders if not declined[ladder.scheme]]
    total, done = 1 + sum(len(ladder.levels) for ladder in taken), 0

    def run(tasks: list[Task], executor: Executor | None = None) -> list[TaskResult]:
        nonlocal done
        results = run_tasks(tasks, executor, store, progress, done_before=done, total=total)
        done += len(tasks)
        return results

    key = fingerprint("finest reference", case.scene, max_steps)
    arguments = (case, max_steps)
    (found,) = run([Task(key, f"{case.name} reference", _finest_reference, arguments, FinestReference)])
    reference, resolution, words = found.value or (None, 0, f"no reference; {found.failure}")
    tasks = {ladder: _level_tasks(case, ladder, max_steps) for ladder in taken}
    results = {ladder: run(tasks[ladder]) for ladder in taken if ladder.timed}
    shared = [ladder for ladder in taken if not ladder.timed]
    with processes(min(workers, sum(len(tasks[ladder]) for ladder in shared))) as executor:
        answers = iter(run([task for ladder in shared for task in tasks[ladder]], executor))
    results |= {ladder: [next(answers) for _ in tasks[ladder]] for ladder in shared}
    convergences = []
    for ladder in all_ladders:
        reason = declined[ladder.scheme]
        runs = [LevelRun(level, failure=reason, refused=True) for level in ladder.levels]
        if not reason:
            answered = zip(ladder.levels, results[ladder], strict=True)
            runs = [measured(case, level, result, reference) for level, result in answered]
        convergences.append(read(ladder, tuple(runs), reference, case))
    return SceneStudy(case, words, _uncertainty(resolution, convergences), convergences)


def _refusal(case: Case, name: str) -> str:
    """Why a scheme does not take a scene; empty if it does."""
    try:
        scheme(name).solver.check(case.scene)
    except SceneError as error:
        return f"refused: {error}"
    return ""


def _level_tasks(case: Case, ladder: Ladder, max_steps: int | None) -> list[Task]:
    """The levels of a ladder; timed ones are repeated, and the coarsest is run before to warm up."""
    warmed_up = False

    def run_timed(case: Case, name: str, level: Level, max_steps: int | None) -> TimedRun:
        nonlocal warmed_up
        if not warmed_up:  # imports, caches, pages of memory
            run_level(case, name, ladder.levels[0], max_steps)
            warmed_up = True
        return run_level(case, name, level, max_steps, REPEATS)

    return [
        Task(
            fingerprint("level", case.scene, ladder.scheme, ladder.kind, level, ladder.timed, max_steps),
            f"{case.name} {ladder.scheme} {ladder.kind} {level.label}",
            run_timed if ladder.timed else run_level,
            (case, ladder.scheme, level, max_steps),
            TimedRun,
        )
        for level in ladder.levels
    ]


def run_level(
    case: Case, name: str, level: Level, max_steps: int | None = None, repeats: int = 1
) -> TimedRun:
    """Run a level of a scheme, up to ``repeats`` times while that is cheap."""
    runs: list[Run] = []
    while len(runs) < repeats and sum(one.wall_seconds for one in runs) <= ENOUGH_SECONDS:
        runs.append(scheme(name).run(case, level.settings, max_steps))
        if runs[-1].trace is None:
            break
    wall, cpu = (min(getattr(one, clock) for one in runs) for clock in ("wall_seconds", "cpu_seconds"))
    return TimedRun(replace(runs[-1], wall_seconds=wall, cpu_seconds=cpu), len(runs))


def measured(case: Case, level: Level, result: TaskResult, reference: Run | None) -> LevelRun:
    """What came of a level; there are errors where the reference has an answer to the same scene."""
    if result.value is None:
        return LevelRun(level, failure=result.failure, details=result.details)
    run, repeats = result.value.run, result.value.repeats
    if run.trace is None:
        return LevelRun(level, failure=run.failure, details=run.details)
    times = {"wall_seconds": run.wall_seconds, "cpu_seconds": run.cpu_seconds, "repeats": repeats}
    found = LevelRun(level, counters=asdict(run.trace.counters), outcome=run.outcome, **times)
    if not run.finished:
        return replace(found, failure=run.ending)
    values = {name: run.measures.get(name) for name in SCALARS}
    base = reference if level.settings.zone_factor == 1.0 else None
    return replace(found, values=values, errors=_errors(run, base, case))


def _errors(result: Run, reference: Run | None, case: Case) -> dict[str, float]:
    """Signed relative errors of the scalars of a run, and norms of its curves (:data:`NORMS`)."""
    if reference is None or reference.trace is None or result.trace is None:
        return {}
    located = [name for name in SCALARS if is_located(name, reference.trace, case.scene.loading)]
    numbers = of_numbers(result, reference, located)
    errors = {one.quantity: one.error for one in numbers if math.isfinite(one.error)}
    spans = windows(case.scene.loading, result.trace)
    curves = "force", "contact_radius"
    force, radius = (distance(result.trace, reference.trace, one, spans) for one in curves)
    if force is not None and radius is not None:
        norms = (force.rms, force.mean, force.largest, radius.rms)
        errors |= dict(zip(NORMS, norms, strict=True))
    return errors


def read(ladder: Ladder, runs: tuple[LevelRun, ...], reference: Run | None, case: Case) -> Convergence:
    """Orders, extrapolations and bounds of every observable of a ladder, runs by level, coarse to fine.

    What errors are relative to is stated in :mod:`validation.measure.scaling`; without a reference an
    observable is relative to its own finest value.
    """
    nominal = ladder.nominal or scheme(ladder.scheme).nominal
    largest = None if reference is None or reference.trace is None else Magnitudes.of_trace(reference.trace)
    sizes = [run.level.size for run in runs]
    rows = []
    for name in (*SCALARS, *NORMS):
        values = tuple(run.values.get(name) for run in runs)
        errors = tuple(run.errors.get(name) for run in runs)
        if all(entry is None for entry in (*values, *errors)):
            continue
        known = [abs(value) for value in values if value]
        size = known[-1] if known else 1.0
        if largest is not None and reference is not None and reference.trace is not None:
            expected = reference.measures.get(name)
            if expected is not None and is_located(name, reference.trace, case.scene.loading):
                size = largest.scale(name, expected) or 1.0
        alone = None if name in NORMS else extrapolate(sizes, values, nominal, size)
        relative = [None if error is None else abs(error) for error in errors]
        orders = reference_orders(sizes, errors)
        rows.append(Row(name, values, errors, orders, fitted_slope(sizes, relative), size, alone))
    return Convergence(ladder, nominal, runs, tuple(rows))


def _finest_reference(case: Case, max_steps: int | None) -> FinestReference:
    """The finest front tracking that reaches its end, its resolution, and why the finer ones failed."""
    failures: list[str] = []
    for resolution in finest(case.scene):
        found = scheme(REFERENCE).run(case, Settings(resolution), max_steps)
        if found.finished:
            words = "; ".join([f"front tracking at resolution {resolution}", *failures])
            return found, resolution, words
        failures.append(f"{resolution} failed: {found.failure or found.ending}")
    return None, 0, "; ".join(["no reference", *failures])


def _uncertainty(resolution: int, convergences: list[Convergence]) -> dict[str, float]:
    """Error of the finest front tracking, from its distance to the finest level of the ladder.

    With second order and a step ``n`` times smaller, ``(n^2 - 1)`` times less than that distance.
    """
    for entry in convergences:
        coarser = [run for run in entry.runs if not run.failed and run.level.settings.resolution < resolution]
        if entry.ladder.scheme == REFERENCE and entry.ladder.timed and coarser:
            finer = resolution / coarser[-1].level.settings.resolution
            return {name: abs(e) / (finer**2 - 1.0) for name, e in coarser[-1].errors.items()}
    return {}
