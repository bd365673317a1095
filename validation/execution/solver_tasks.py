"""Runs of solvers as tasks: carried out here or by an executor, and each once."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

from validation import solvers
from validation.cases import Case
from validation.execution.fingerprints import fingerprint
from validation.execution.run_tasks import run_tasks
from validation.execution.runs import Run, run
from validation.execution.step_share import StepShare
from validation.execution.store import Store
from validation.execution.task_progress import TellProgress
from validation.execution.tasks import Task, TaskResult
from validation.solvers.cost import ESTIMATE_SHARE, relative_time


def expected_seconds(
    case: Case, solver: str, resolution: int | None = None, max_steps: int | None = None
) -> float:
    """Rough run time (s), to start long runs first.

    Parameters
    ----------
    case, solver, resolution, max_steps
        As of :func:`~validation.execution.runs.run_or_raise`.

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
        As of :func:`~validation.execution.runs.run_or_raise`.

    Returns
    -------
    Task
        To be carried out by :func:`~validation.execution.run_tasks.run_tasks`.
    """
    asked = (case.scene, solver, resolution, case.profile_times, estimate, max_steps)
    seconds = expected_seconds(case, solver, resolution, max_steps)
    return Task(
        fingerprint("run", *asked, *origin_of(solver)),
        f"{case.name} {solver}",
        partial(run_telling_share, max_steps=max_steps),
        (case, solver, resolution, estimate),
        Run,
        seconds * relative_time(estimate),
        tells_share=True,
    )


def run_telling_share(
    case: Case,
    solver: str,
    resolution: int | None = None,
    estimate: bool = False,
    *,
    max_steps: int | None = None,
    tell_share: Callable[[float], None] | None = None,
) -> Run:
    """A run that tells what share of it is done, and of the second one from which its errors are estimated.

    Parameters
    ----------
    case, solver, resolution, estimate, max_steps
        As of :func:`~validation.execution.runs.run_or_raise`.
    tell_share : callable or None
        Called after every step with the share, 0 to 1; not for a solver without a forecast, nor in the second
        run of one that estimates its errors itself.

    Returns
    -------
    Run
    """
    first = second = None
    method = solvers.SOLVERS.get(solver)
    if tell_share is not None and method is not None:
        steps = method.expected_cost(case.scene, resolution).within(max_steps).steps
        first_ends = 1.0 / relative_time(estimate)
        first = _part_of_task(StepShare(steps), 0.0, first_ends, tell_share)
        second = _part_of_task(StepShare(ESTIMATE_SHARE * steps), first_ends, 1.0, tell_share)
    return run(case, solver, resolution, first, estimate, max_steps=max_steps, estimate_progress=second)


def _part_of_task(
    share: StepShare, begin: float, end: float, tell: Callable[[float], None]
) -> Callable[[float], None]:
    """What a solver calls after every step of a run that is a part of a task.

    Parameters
    ----------
    share : StepShare
        Of the run.
    begin, end : float
        Shares of the task between which the run is, 0 to 1.
    tell : callable
        Called with the share of the task.

    Returns
    -------
    callable
    """
    return lambda loading: tell(begin + (end - begin) * share(loading))


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
    """Run pairs of case and solver, here or through an executor.

    Parameters
    ----------
    pairs : iterable of (Case, str)
    executor, store, progress
        As of :func:`~validation.execution.run_tasks.run_tasks`.
    estimated : collection of str
        Names of the scenes whose errors are estimated.
    max_steps : int or None
        Of every run; ``None``: by its forecast.
    quick : bool
        Whether they have the resolution of the quick suite, not each solver's default.

    Returns
    -------
    dict of (str, str) to Run
        By scene and solver, in the order of ``pairs``.
    """
    tasks = [
        run_task(
            case, name, quick_resolution(case, name) if quick else None, case.name in estimated, max_steps
        )
        for case, name in pairs
    ]
    runs = map(run_of, run_tasks(tasks, executor, store, progress))
    return {(result.scene, result.solver): result for result in runs}
