"""Runs of solvers as tasks: carried out here or by an executor, and each once."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

from validation import solvers
from validation.cases import Case
from validation.runs.pool import Task, TaskResult, TellProgress, run_tasks
from validation.runs.provenance import fingerprint
from validation.runs.run import Run, run
from validation.runs.store import Store


def run_task(
    case: Case,
    solver: str,
    resolution: int | None = None,
    estimate: bool = False,
    max_steps: int | None = None,
) -> Task:
    """A run of a solver as a task; arguments as of :func:`~validation.runs.run.run_or_raise`."""
    asked = (case.scene, solver, resolution, case.profile_times, estimate, max_steps)
    return Task(
        fingerprint("run", *asked, *origin_of(solver)),
        f"{case.name} {solver}",
        partial(run, estimate=estimate, max_steps=max_steps),
        (case, solver, resolution),
        Run,
    )


def origin_of(solver: str) -> tuple[str, ...]:
    """Version of a solver that is no part of this program."""
    origin = solvers.SOLVERS.origin(solver)
    return (origin,) if origin else ()


def run_of(result: TaskResult) -> Run:
    """The run that a task of :func:`run_task` gave, or its failure where a process died with it."""
    case, solver = result.task.arguments[:2]
    if result.value is None:
        return Run(case.name, solver, failure=result.failure, details=result.details)
    return replace(result.value, scene=case.name)  # a stored one may come from a scene of another name


def quick_resolution(case: Case, solver: str) -> int | None:
    """Resolution in the quick suite; ``None`` for a solver that is not known here."""
    method = solvers.SOLVERS.get(solver)
    return None if method is None else method.quick_resolution(case.scene)


def run_all(
    pairs: Iterable[tuple[Case, str]],
    executor: Executor | None = None,
    store: Store | None = None,
    progress: TellProgress | None = None,
    estimated: Collection[str] = (),
    max_steps: int | None = None,
    quick: bool = False,
) -> dict[tuple[str, str], Run]:
    """Run pairs of case and solver; the runs by scene and solver, in the order of ``pairs``.

    ``estimated`` are the names of the scenes whose errors are estimated; ``quick`` runs have the resolution
    of the quick suite, others each solver's default.
    """
    tasks = [
        run_task(
            case, name, quick_resolution(case, name) if quick else None, case.name in estimated, max_steps
        )
        for case, name in pairs
    ]
    runs = map(run_of, run_tasks(tasks, executor, store, progress))
    return {(result.scene, result.solver): result for result in runs}
