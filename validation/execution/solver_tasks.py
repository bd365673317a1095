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
from validation.execution.store import Store
from validation.execution.task_progress import TellProgress
from validation.execution.tasks import Task, TaskResult

ESTIMATE_SHARE = 0.5
"""Time of the coarser run from which errors are estimated, relative to the run."""


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
    return Task(
        fingerprint("run", *asked, *origin_of(solver)),
        f"{case.name} {solver}",
        partial(run_telling_share, max_steps=max_steps),
        (case, solver, resolution, estimate),
        Run,
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
    if tell_share is not None:
        ends = 1.0 / (1.0 + ESTIMATE_SHARE * estimate)
        first, second = _part_of_task(0.0, ends, tell_share), _part_of_task(ends, 1.0, tell_share)
    return run(case, solver, resolution, first, estimate, max_steps=max_steps, estimate_progress=second)


def _part_of_task(begin: float, end: float, tell: Callable[[float], None]) -> Callable[[float], None]:
    """What a solver calls with the share of the loading of a run that is a part of a task."""
    return lambda loading: tell(begin + (end - begin) * loading)


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
        Of every run; ``None``: the solver's own bound.
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
