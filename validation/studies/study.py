"""A study of scenes: every ladder of every scheme, timed where time is the question.

What is timed runs alone, in this process, after a warm-up run of its scheme; the other ladders then share the
cores. Everything is measured against the finest front tracking.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import as_completed
from dataclasses import dataclass

from contact_scene import Trace
from validation.cases import Case
from validation.execution.checkpoints import question
from validation.execution.environment import stamp
from validation.execution.processes import processes
from validation.execution.progress import Progress
from validation.execution.store import Store
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
from validation.studies.schemes import Settings

Key = tuple[int, int]  # ladder, level


@dataclass(frozen=True)
class SceneStudy:
    """All ladders of one scene.

    Parameters
    ----------
    reference : str
        What errors are measured against, in words; why there is nothing, where there is nothing.
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
        """Levels without an answer."""
        return [(study, run) for study in self.ladders for run in study.runs if run.failed]


@dataclass(frozen=True)
class Study:
    """Everything the command found; the writers only give it a form."""

    scenes: list[SceneStudy]
    environment: dict[str, object]
    wall_seconds: float


def study(cases: list[Case], workers: int, progress: Progress, store: Store | None = None) -> Study:
    """Run all ladders of the given scenes; levels that ``store`` holds are taken over, times included."""
    store = store or Store()
    try:
        found = [_scene(case, workers, progress, store) for case in cases]
    finally:
        progress.close()
    return Study(found, stamp(), store.seconds)


def _scene(case: Case, workers: int, progress: Progress, store: Store) -> SceneStudy:
    tasks = ladders(case.scene)
    total, done = 1 + sum(len(ladder.levels) for ladder in tasks), 0

    def tell(ladder: Ladder, run: LevelRun) -> None:
        nonlocal done
        done += 1
        said = run.failure or f"{run.wall_seconds:.2f} s"
        level = f"{ladder.scheme} {ladder.kind} {run.level.label}"
        progress(done / total, f"{done}/{total} {case.name} {level}: {said}")

    asked = question("truth", case.scene)
    kept = store.get(asked)
    truth, resolution, reference = kept or _truth(case)
    if kept is None:
        store.put(asked, (truth, resolution, reference))
    done += 1
    progress(done / total, f"{done}/{total} {case.name} {reference}")
    keys = {(i, j): _question(case, ladder, j) for i, ladder in enumerate(tasks) for j in _levels(ladder)}
    runs: dict[Key, LevelRun] = {at: run for at, key in keys.items() if (run := store.get(key)) is not None}
    if runs:
        done += len(runs)
        progress(done / total, f"{done}/{total} {case.name}: {len(runs)} levels from an earlier attempt")

    def keep(at: Key, run: LevelRun) -> None:
        runs[at] = run
        if not run.failed or run.outcome:  # a breakdown is tried again
            store.put(keys[at], run)
        tell(tasks[at[0]], run)

    rest: dict[Key, tuple[Ladder, Level]] = {}
    for i, ladder in enumerate(tasks):
        missing = {(i, j): (ladder, ladder.levels[j]) for j in _levels(ladder) if (i, j) not in runs}
        if not ladder.timed:
            rest |= missing
        elif missing:
            # warm-up: imports, caches, pages of memory
            run_level(case, ladder.scheme, ladder.levels[0], None)
            for at, (_, level) in missing.items():
                keep(at, run_level(case, ladder.scheme, level, truth, REPEATS))
    _together(case, truth, rest, workers, keep)
    size = {} if truth is None else scales(truth, case.scene)
    found = [
        read(ladder, tuple(runs[i, j] for j in range(len(ladder.levels))), size)
        for i, ladder in enumerate(tasks)
    ]
    return SceneStudy(case, reference, _uncertainty(resolution, found), found)


def _together(
    case: Case,
    truth: Trace | None,
    todo: dict[Key, tuple[Ladder, Level]],
    workers: int,
    keep: Callable[[Key, LevelRun], None],
) -> None:
    """Levels that are not timed, through as many processes as there may be."""
    with processes(min(workers, len(todo))) as executor:
        if executor is None:
            for key, (ladder, level) in todo.items():
                keep(key, run_level(case, ladder.scheme, level, _own(truth, level)))
            return
        futures = {
            executor.submit(run_level, case, ladder.scheme, level, _own(truth, level)): key
            for key, (ladder, level) in todo.items()
        }
        for future in as_completed(futures):
            key = futures[future]
            try:
                run = future.result()
            except Exception as error:  # a worker that died takes its level along, not the study
                run = LevelRun(todo[key][1], failure=f"{type(error).__name__}: {error}")
            keep(key, run)


def _levels(ladder: Ladder) -> range:
    return range(len(ladder.levels))


def _question(case: Case, ladder: Ladder, level: int) -> str:
    """What makes two levels the same; one that is timed runs alone."""
    return question("level", case.scene, ladder.scheme, ladder.kind, ladder.levels[level], ladder.timed)


def _own(truth: Trace | None, level: Level) -> Trace | None:
    """The reference of a level; there is none for a scene whose process zone was changed."""
    return truth if level.settings.zone_factor == 1.0 else None


def _truth(case: Case) -> tuple[Trace | None, int, str]:
    """The finest front tracking that reaches its end, its resolution, and what became of the finer ones."""
    said = []
    for resolution in finest(case.scene):
        try:
            trace = solve_level(case, REFERENCE, Level(1.0 / resolution, "", Settings(resolution)))
        except Exception as error:
            said.append(f"{resolution} failed: {type(error).__name__}: {' '.join(str(error).split())}")
            continue
        if trace.outcome.finished:
            return trace, resolution, "; ".join([f"front tracking at resolution {resolution}", *said])
        said.append(f"{resolution} failed: {trace.outcome.kind}: {trace.outcome.reason}")
    return None, 0, "; ".join(["no reference", *said])


def _uncertainty(resolution: int, found: list[Convergence]) -> dict[str, float]:
    """Error of the finest front tracking, from its distance to the finest level of the ladder.

    With second order and a step ``n`` times smaller, ``(n^2 - 1)`` times less than that distance.
    """
    for entry in found:
        done = [run for run in entry.runs if not run.failed and run.level.settings.resolution < resolution]
        if entry.ladder.scheme == REFERENCE and entry.ladder.timed and done:
            finer = resolution / done[-1].level.settings.resolution
            return {name: abs(e) / (finer**2 - 1.0) for name, e in done[-1].errors.items()}
    return {}
