"""Tasks run with a store of answers and with progress: what an earlier attempt has done is taken over."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Executor

from validation.execution.store import Store
from validation.execution.task_execution import completed_tasks
from validation.execution.task_progress import TaskProgress, TellProgress
from validation.execution.tasks import Task, TaskResult


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
        value = None if task.answer is None else store.get(task.key, task.answer)
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
        if not breakdown and result.task.answer is not None:
            store.put(result.task.key, result.value)
        if on_result is not None:
            on_result(result)
        told.finish(index, f"{result.task.label}: {breakdown or f'{result.seconds:.1f} s'}")
    return [results[index] for index in range(len(tasks))]
