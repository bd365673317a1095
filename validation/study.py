"""A study of scenes: every ladder of every scheme, timed where time is the question.

What is timed runs alone, in this process, after a warm-up run of its scheme; the other ladders then share the
cores. Everything is measured against the finest front tracking.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import as_completed
from dataclasses import dataclass

from scene import Trace
from validation.cases import Case
from validation.convergence import REPEATS, Convergence, LevelRun, read, run_level, scales, solve_level
from validation.environment import stamp
from validation.ladders import Ladder, Level, finest, ladders
from validation.pool import processes
from validation.progress import Progress
from validation.schemes import Settings
from validation.solvers import REFERENCE

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


def study(cases: list[Case], workers: int, progress: Progress) -> Study:
    """Run all ladders of the given scenes."""
    begin = time.perf_counter()
    try:
        found = [_scene(case, workers, progress) for case in cases]
    finally:
        progress.close()
    return Study(found, stamp(), time.perf_counter() - begin)


def _scene(case: Case, workers: int, progress: Progress) -> SceneStudy:
    tasks = ladders(case.scene)
    total, done = 1 + sum(len(ladder.levels) for ladder in tasks), 0

    def tell(ladder: Ladder, run: LevelRun) -> None:
        nonlocal done
        done += 1
        said = run.failure or f"{run.wall_seconds:.2f} s"
        level = f"{ladder.scheme} {ladder.kind} {run.level.label}"
        progress(done / total, f"{done}/{total} {case.name} {level}: {said}")

    truth, resolution, reference = _truth(case)
    done += 1
    progress(done / total, f"{done}/{total} {case.name} {reference}")
    runs: dict[Key, LevelRun] = {}
    rest: dict[Key, tuple[Ladder, Level]] = {}
    for i, ladder in enumerate(tasks):
        if not ladder.timed:
            rest |= {(i, j): (ladder, level) for j, level in enumerate(ladder.levels)}
            continue
        run_level(case, ladder.scheme, ladder.levels[0], None)  # warm-up: imports, caches, pages of memory
        for j, level in enumerate(ladder.levels):
            runs[i, j] = run_level(case, ladder.scheme, level, truth, REPEATS)
            tell(ladder, runs[i, j])
    runs |= _together(case, truth, rest, workers, tell)
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
    tell: Callable[[Ladder, LevelRun], None],
) -> dict[Key, LevelRun]:
    """Levels that are not timed, through as many processes as there may be."""
    runs: dict[Key, LevelRun] = {}
    with processes(min(workers, len(todo))) as executor:
        if executor is None:
            for key, (ladder, level) in todo.items():
                runs[key] = run_level(case, ladder.scheme, level, _own(truth, level))
                tell(ladder, runs[key])
            return runs
        futures = {
            executor.submit(run_level, case, ladder.scheme, level, _own(truth, level)): key
            for key, (ladder, level) in todo.items()
        }
        for future in as_completed(futures):
            key = futures[future]
            ladder, level = todo[key]
            try:
                runs[key] = future.result()
            except Exception as error:  # a worker that died takes its level along, not the study
                runs[key] = LevelRun(level, failure=f"{type(error).__name__}: {error}")
            tell(ladder, runs[key])
    return runs


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
