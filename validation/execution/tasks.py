"""Independent tasks: taken from a store where it has their answers, else carried out here or by an executor.

Any ``concurrent.futures`` executor will do: :class:`~validation.execution.processes.WorkerProcesses`, Dask's
``Client.get_executor()``, an MPI pool. Only the first enforces time limits. However many tasks there are, an
executor holds a bounded number of them at a time.
"""

from __future__ import annotations

import signal
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Executor, Future
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from functools import partial
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Any

from validation.execution.processes import WorkerProcesses
from validation.execution.store import Store
from validation.execution.task_progress import TaskProgress, TellProgress
from validation.execution.told_shares import ShareTeller, ToldShares

OUTSTANDING = 512
"""Tasks that an executor holds at a time: more than the workers of a large cluster, so that none waits for
its next one, and few enough that neither their arguments nor their futures count in memory."""
SHARES_EVERY = 1.0
"""Seconds after which the shares of running tasks are looked at again."""


class TaskEnding(StrEnum):
    """How a task ended."""

    ANSWERED = "answered"
    RAISED = "raised"
    DIED = "died"
    TIMED_OUT = "hung"


@dataclass(frozen=True)
class Task:
    """A function call that depends on no other task.

    Parameters
    ----------
    key : str
        Fingerprint of what is computed (see ``fingerprints``): two tasks with one key have one answer.
    label : str
        For progress.
    function, arguments : callable, tuple
        Picklable where an executor has processes. A value with an attribute ``breakdown`` that is not empty
        counts as a failure: it is not stored, so that the next attempt tries again.
    expected_seconds : float
        A guess; long tasks are submitted first.
    time_limit : float or None
        Processor time in seconds after which the task is given up; ``None``: never.
    tells_share : bool
        Whether the function takes a keyword ``tell_share``, to be called with the share of itself that is
        done, 0 to 1, or ``None``.
    """

    key: str
    label: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = ()
    expected_seconds: float = 1.0
    time_limit: float | None = None
    tells_share: bool = False


@dataclass(frozen=True)
class TaskResult:
    """What came of a task.

    Parameters
    ----------
    task : Task
    value : object
        What the function returned; ``None`` if it did not return.
    failure, details : str
        Why there is no answer, in one line, and the traceback; empty if there is one.
    seconds : float
        Wall time of the call; 0 if its answer was stored before.
    stored : bool
        Whether the answer comes from the store.
    ending : TaskEnding
    """

    task: Task
    value: Any = None
    failure: str = ""
    details: str = ""
    seconds: float = 0.0
    stored: bool = False
    ending: TaskEnding = TaskEnding.ANSWERED


def run_tasks(
    tasks: Iterable[Task],
    executor: Executor | None = None,
    store: Store | None = None,
    progress: TellProgress | None = None,
    on_result: Callable[[TaskResult], None] | None = None,
    *,
    done_before: int = 0,
    total: int | None = None,
) -> list[TaskResult]:
    """Carry out tasks; a task that breaks down costs no other.

    Parameters
    ----------
    tasks : iterable of Task
    executor : Executor or None
        ``None``: one after the other in this process, in the given order.
    store : Store or None
        Holds answers of an earlier attempt and receives new ones, breakdowns excepted.
    progress : callable or None
        Called with the share of the work that is done, 0 to 1, a line of text for every task that has ended,
        and the time left (see :class:`~validation.execution.task_progress.TaskProgress`).
    on_result : callable or None
        Called with each result as soon as it is there, one call at a time, in this thread.
    done_before, total : int
        Tasks done in earlier calls, and of all calls together, where one progress covers several calls.

    Returns
    -------
    list of TaskResult
        In the order of ``tasks``.
    """
    store, tasks = store or Store(), list(tasks)
    results: dict[int, TaskResult] = {}
    told = TaskProgress([task.expected_seconds for task in tasks], progress, done_before, total)
    for index, task in enumerate(tasks):
        value = store.get(task.key)
        if value is not None:
            results[index] = TaskResult(task, value, stored=True)
            told.take_over(index)
            if on_result is not None:
                on_result(results[index])
    if results:
        told.tell("taken over from an earlier attempt")
    missing = [(index, task) for index, task in enumerate(tasks) if index not in results]
    if executor is not None:
        missing.sort(key=lambda pair: -pair[1].expected_seconds)
    on_shares = None if progress is None else told.update
    for index, result in completed_tasks(missing, executor, on_shares=on_shares):
        results[index] = result
        breakdown = result.failure or getattr(result.value, "breakdown", "")
        if not breakdown:
            store.put(result.task.key, result.value)
        if on_result is not None:
            on_result(result)
        told.finish(index, f"{result.task.label}: {breakdown or f'{result.seconds:.1f} s'}")
    return [results[index] for index in range(len(tasks))]


def completed_tasks(
    numbered: Iterable[tuple[int, Task]],
    executor: Executor | None = None,
    outstanding: int = OUTSTANDING,
    on_shares: Callable[[Mapping[int, float]], None] | None = None,
) -> Iterator[tuple[int, TaskResult]]:
    """Results as they come, each with the number of its task.

    Parameters
    ----------
    numbered : iterable of (int, Task)
        May be a generator: a task is taken from it when there is room for it, so that what is known by then
        can shape it.
    executor : Executor or None
        ``None``: one after the other in this process.
    outstanding : int
        Most tasks that the executor holds at a time.
    on_shares : callable or None
        Called with the shares of running tasks that are done, by number, where tasks tell them: those carried
        out here or by :class:`~validation.execution.processes.WorkerProcesses`.

    Yields
    ------
    (int, TaskResult)
    """
    if executor is None:
        for number, task in numbered:
            tell = None if on_shares is None else partial(_tell_one, on_shares, number)
            yield number, TaskResult(task, *execute(_telling(task, tell), task.arguments))
        return
    done: SimpleQueue[Future[Any]] = SimpleQueue()
    submitted: dict[Future[Any], _Submitted] = {}
    shares = executor.shares if isinstance(executor, WorkerProcesses) and on_shares is not None else None
    coming = iter(numbered)
    try:
        while True:
            for number, task in islice(coming, outstanding - len(submitted)):
                teller = shares.teller() if shares is not None and task.tells_share else None
                future = _submit(executor, task, _telling(task, teller))
                submitted[future] = _Submitted(number, task, teller)
                future.add_done_callback(done.put)
            if not submitted:
                return
            future = _next_done(done, submitted, shares, on_shares)
            ended = submitted.pop(future)
            if shares is not None and ended.teller is not None:
                shares.release(ended.teller)
            yield ended.number, _collected(ended.task, future)
    finally:
        for future in submitted:  # the reader of the results has gone
            future.cancel()


@dataclass(frozen=True)
class _Submitted:
    """A task that an executor holds."""

    number: int
    task: Task
    teller: ShareTeller | None


def _next_done(
    done: SimpleQueue[Future[Any]],
    submitted: Mapping[Future[Any], _Submitted],
    shares: ToldShares | None,
    on_shares: Callable[[Mapping[int, float]], None] | None,
) -> Future[Any]:
    """The task that ends next; until then what the running ones tell is passed on.

    Parameters
    ----------
    done : SimpleQueue
    submitted : mapping
    shares : ToldShares or None
    on_shares : callable or None
        As of :func:`completed_tasks`.

    Returns
    -------
    Future
    """
    while shares is not None and on_shares is not None:
        with suppress(Empty):
            return done.get(timeout=SHARES_EVERY)
        tellers = {one.number: one.teller for one in submitted.values() if one.teller is not None}
        on_shares({number: shares.share(teller) for number, teller in tellers.items()})
    return done.get()


def _tell_one(on_shares: Callable[[Mapping[int, float]], None], number: int, share: float) -> None:
    on_shares({number: share})


def _telling(task: Task, tell: Callable[[float], None] | None) -> Callable[..., Any]:
    """The task's function, told where to tell its share."""
    return partial(task.function, tell_share=tell) if task.tells_share and tell is not None else task.function


def _submit(executor: Executor, task: Task, function: Callable[..., Any]) -> Future[Any]:
    if task.time_limit is not None and isinstance(executor, WorkerProcesses):
        return executor.submit_limited(task.time_limit, execute, function, task.arguments)
    return executor.submit(execute, function, task.arguments)


def execute(
    function: Callable[..., Any], arguments: tuple[Any, ...]
) -> tuple[Any, str, str, float, bool, TaskEnding]:
    """Call the function where the task is carried out: the fields of a result after its task."""
    began = time.perf_counter()
    try:
        value, failure, details, ending = function(*arguments), "", "", TaskEnding.ANSWERED
    except Exception as error:
        value, failure, details, ending = None, one_line(error), traceback.format_exc(), TaskEnding.RAISED
    return value, failure, details, time.perf_counter() - began, False, ending


def one_line(error: Exception) -> str:
    """An exception in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}".rstrip(": ")


def _collected(task: Task, future: Future[Any]) -> TaskResult:
    """The result of a task that an executor has done with; its process may have ended."""
    try:
        return TaskResult(task, *future.result())
    except Exception as error:
        exit_code = getattr(error, "exitcode", None)
        if isinstance(error, TimeoutError) or exit_code == -getattr(signal, "SIGPROF", 0):
            failure, ending = f"no answer within {task.time_limit:g} s; killed", TaskEnding.TIMED_OUT
        elif exit_code is not None:
            failure, ending = f"the process ended with code {exit_code}", TaskEnding.DIED
        else:
            failure, ending = one_line(error), TaskEnding.DIED
        return TaskResult(task, failure=failure, ending=ending)
