"""A study of scenes: every ladder of every scheme, timed where costs are compared.

Timed ladders run alone, in this process, after a warm-up run of their scheme; the others share the cores.
Everything is measured against the finest front tracking.
"""

from __future__ import annotations

from concurrent.futures import Executor
from dataclasses import dataclass

from contact_scene import SceneError, Trace
from validation.cases import Case
from validation.runs.pool import Task, TaskResult, one_line, processes, run_tasks
from validation.runs.progress import Progress
from validation.runs.provenance import fingerprint, stamp
from validation.runs.store import Store
from validation.solvers import REFERENCE
from validation.studies.convergence import (
    REPEATS,
    Convergence,
    LevelRun,
    read,
    run_level,
    scales,
    solve_level,
)
from validation.studies.ladders import Ladder, Level, finest, ladders
from validation.studies.schemes import Settings, scheme

FinestReference = tuple[Trace | None, int, str]
"""Of a scene, its resolution (0 without one), and what it is, or why there is none, in words."""


@dataclass(frozen=True)
class SceneStudy:
    """All ladders of one scene.

    Parameters
    ----------
    reference : str
        What errors are measured against, in words, or why there is no reference.
    uncertainty : dict of str to float
        Estimated relative error of the reference itself, by observable.
    ladders : list of Convergence
    """

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
    """Run all ladders of the given scenes.

    Parameters
    ----------
    cases : list of Case
    workers : int
        Processes for the ladders that are not timed.
    progress : Progress
        Closed at the end.
    store : Store or None
        Levels of an earlier attempt are taken over, run times included.
    max_steps : int or None
        Of every run; ``None``: the solver's own bound.

    Returns
    -------
    Study
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
    total = 1 + sum(len(ladder.levels) for ladder in all_ladders if not declined[ladder.scheme])
    done = 0

    def run(tasks: list[Task], executor: Executor | None = None) -> list[TaskResult]:
        nonlocal done
        results = run_tasks(tasks, executor, store, progress, done_before=done, total=total)
        done += len(tasks)
        return results

    key = fingerprint("finest reference", case.scene, max_steps)
    (answer,) = run(
        [Task(key, f"{case.name} reference", _finest_reference, (case, max_steps), FinestReference)]
    )
    reference, resolution, words = answer.value or (None, 0, f"no reference; {answer.failure}")
    tasks = [
        [] if declined[ladder.scheme] else _level_tasks(case, ladder, reference, max_steps)
        for ladder in all_ladders
    ]
    results = {i: run(tasks[i]) for i, ladder in enumerate(all_ladders) if ladder.timed}
    shared = [i for i in range(len(tasks)) if i not in results]
    with processes(min(workers, sum(len(tasks[i]) for i in shared))) as executor:
        answers = iter(run([task for i in shared for task in tasks[i]], executor))
    results |= {i: [next(answers) for _ in tasks[i]] for i in shared}
    size = {} if reference is None else scales(reference, case.scene)
    runs = [
        tuple(map(_level_run, results[i])) or _refused_levels(ladder, declined[ladder.scheme])
        for i, ladder in enumerate(all_ladders)
    ]
    convergences = [read(ladder, runs[i], size) for i, ladder in enumerate(all_ladders)]
    return SceneStudy(case, words, _uncertainty(resolution, convergences), convergences)


def _refusal(case: Case, name: str) -> str:
    """Why a scheme does not take a scene; empty if it does."""
    try:
        scheme(name).solver.check(case.scene)
    except SceneError as error:
        return f"refused: {error}"
    return ""


def _refused_levels(ladder: Ladder, reason: str) -> tuple[LevelRun, ...]:
    """The levels of a scheme that does not take the scene."""
    return tuple(LevelRun(level, failure=reason, refused=True) for level in ladder.levels)


def _level_tasks(case: Case, ladder: Ladder, reference: Trace | None, max_steps: int | None) -> list[Task]:
    """The levels of a ladder."""
    warmed_up = False

    def run_timed(
        case: Case, scheme: str, level: Level, reference: Trace | None, max_steps: int | None
    ) -> LevelRun:
        """:func:`run_level`, repeated; before the first of these levels, the coarsest is run to warm up.

        Parameters
        ----------
        case, scheme, level, reference, max_steps
            As of :func:`run_level`.

        Returns
        -------
        LevelRun
        """
        nonlocal warmed_up
        if not warmed_up:  # imports, caches, pages of memory
            run_level(case, scheme, ladder.levels[0], None, max_steps)
            warmed_up = True
        return run_level(case, scheme, level, reference, max_steps, REPEATS)

    return [
        Task(
            fingerprint("level", case.scene, ladder.scheme, ladder.kind, level, ladder.timed, max_steps),
            f"{case.name} {ladder.scheme} {ladder.kind} {level.label}",
            run_timed if ladder.timed else run_level,
            (case, ladder.scheme, level, _own_reference(reference, level), max_steps),
            LevelRun,
        )
        for level in ladder.levels
    ]


def _level_run(result: TaskResult) -> LevelRun:
    """The result of a level, or its failure where its process died."""
    if result.value is None:
        return LevelRun(result.task.arguments[2], failure=result.failure, details=result.details)
    return result.value


def _own_reference(reference: Trace | None, level: Level) -> Trace | None:
    """The reference of a level; there is none for a scene whose process zone was changed."""
    return reference if level.settings.zone_factor == 1.0 else None


def _finest_reference(case: Case, max_steps: int | None) -> FinestReference:
    """The finest front tracking that reaches its end, its resolution, and why the finer ones failed."""
    failures = []
    for resolution in finest(case.scene):
        try:
            level = Level(1.0 / resolution, "", Settings(resolution))
            trace = solve_level(case, REFERENCE, level, max_steps)
        except Exception as error:
            failures.append(f"{resolution} failed: {one_line(error)}")
            continue
        if trace.outcome.finished:
            return trace, resolution, "; ".join([f"front tracking at resolution {resolution}", *failures])
        failures.append(f"{resolution} failed: {trace.outcome.kind}: {trace.outcome.reason}")
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
