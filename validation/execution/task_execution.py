"""Tasks carried out here or by an executor; one that breaks down costs no other.

Any ``concurrent.futures`` executor will do: :class:`~validation.execution.processes.WorkerProcesses`, Dask's
``Client.get_executor()``, an MPI pool. Only the first enforces time limits and lets tasks tell their shares.
However many tasks there are, an executor holds a bounded number of them at a time.
"""

from __future__ import annotations

import signal
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import islice
from queue import Empty, SimpleQueue
from typing import Any

from validation.execution.processes import WorkerProcesses
from validation.execution.tasks import Task, TaskEnding, TaskResult, one_line
from validation.execution.told_shares import ShareTeller, ToldShares

OUTSTANDING = 512
"""Tasks that an executor holds at a time: more than the workers of a large cluster, so that none waits for
its next one, and few enough that neither their arguments nor their futures count in memory."""
GUARD = 'a script that has processes work for it stands under `if __name__ == "__main__":`'
"""Why all processes end as they begin: each imports the script, which starts its work anew."""
SHARES_EVERY = 1.0
"""Seconds after which the shares of running tasks are looked at again."""


class ExecutorGone(ConnectionError):
    """An executor has given up tasks that it was given: it will carry out no other."""


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

    Raises
    ------
    ExecutorGone
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


def _collected(task: Task, future: Future[Any]) -> TaskResult:
    """The result of a task that an executor has done with; its process may have ended."""
    try:
        return TaskResult(task, *future.result())
    except CancelledError:
        raise ExecutorGone("the executor has given up what it was given") from None
    except BrokenExecutor as error:
        raise ExecutorGone(f"{one_line(error)}: {GUARD}") from None
    except Exception as error:
        exit_code = getattr(error, "exitcode", None)
        if isinstance(error, TimeoutError) or exit_code == -getattr(signal, "SIGPROF", 0):
            failure, ending = f"no answer within {task.time_limit:g} s; killed", TaskEnding.TIMED_OUT
        elif exit_code is not None:
            failure, ending = f"the process ended with code {exit_code}", TaskEnding.DIED
        else:
            failure, ending = one_line(error), TaskEnding.DIED
        return TaskResult(task, failure=failure, ending=ending)
