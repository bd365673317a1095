"""Runs of solvers as tasks: carried out here or by an executor, and each once."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

from validation import solvers
from validation.cases import Case
from validation.execution.fingerprints import fingerprint
from validation.execution.runs import Run, run
from validation.execution.store import Store
from validation.execution.tasks import Task, TaskResult, run_tasks


def expected_seconds(
    case: Case, solver: str, resolution: int | None = None, max_steps: int | None = None
) -> float:
    """Rough run time (s), to start long runs first.

    Parameters
    ----------
    case, solver, resolution, max_steps
        As of :func:`run_or_raise`.

    Returns
    -------
    float
        1 for a solver that has no forecast.
    """
    method = solvers.SOLVERS.get(solver)
    return 1.0 if method is None else method.expected_cost(case.scene, resolution).within(max_steps).seconds


def run_task(
    case: Case,
    solver: str,
    resolution: int | None = None,
    estimate: bool = False,
    max_steps: int | None = None,
) -> Task:
    """A run as a task.

    Parameters
    ----------
    case, solver, resolution, estimate, max_steps
        As of :func:`run_or_raise`.

    Returns
    -------
    Task
        To be carried out by :func:`~validation.execution.tasks.run_tasks`.
    """
    asked = (case.scene, solver, resolution, case.profile_times, estimate, max_steps)
    return Task(
        fingerprint("run", *asked, *origin_of(solver)),
        f"{case.name} {solver}",
        partial(run, max_steps=max_steps),
        (case, solver, resolution, None, estimate),
        expected_seconds(case, solver, resolution, max_steps),
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


def run_all(
    pairs: Iterable[tuple[Case, str]],
    executor: Executor | None = None,
    store: Store | None = None,
    progress: Callable[[float, str], None] | None = None,
    estimated: Collection[str] = (),
    max_steps: int | None = None,
) -> dict[tuple[str, str], Run]:
    """Run pairs of case and solver, here or through an executor.

    Parameters
    ----------
    pairs : iterable of (Case, str)
    executor, store, progress
        As of :func:`~validation.execution.tasks.run_tasks`.
    estimated : collection of str
        Names of the scenes whose errors are estimated.
    max_steps : int or None
        Of every run; ``None``: by its forecast.

    Returns
    -------
    dict of (str, str) to Run
        By scene and solver, in the order of ``pairs``.
    """
    tasks = [
        run_task(case, solver, estimate=case.name in estimated, max_steps=max_steps) for case, solver in pairs
    ]
    runs = map(run_of, run_tasks(tasks, executor, store, progress))
    return {(result.scene, result.solver): result for result in runs}
