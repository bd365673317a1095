"""Tasks: taken from the store, carried out here or in processes; one that breaks down costs no other."""

from __future__ import annotations

import os
import time
from concurrent.futures import BrokenExecutor, CancelledError, Future, ThreadPoolExecutor
from dataclasses import dataclass

import pytest
from support.worker_tasks import NotThere, spin, square

from validation.runs.pool import Task, TaskEnding, WorkerProcesses, processes, run_tasks
from validation.runs.store import Store


@dataclass(frozen=True)
class Answer:
    breakdown: str


def task(value: float, **more) -> Task:
    return Task(f"{value:g}", f"square of {value:g}", square, (value,), float, **more)


@pytest.mark.parametrize("threads", [None, 2])
def test_answers_are_stored_and_taken_over_breakdowns_are_not(tmp_path, threads):
    tasks = [task(3.0), task(-1.0), task(2.0)]
    executor = None if threads is None else ThreadPoolExecutor(threads)
    first = run_tasks(tasks, executor, Store(tmp_path))
    assert [result.value for result in first] == [9.0, None, 4.0]
    assert (first[1].failure, first[1].ending) == ("ValueError: -1.0 is negative", TaskEnding.RAISED)
    assert "Traceback" in first[1].details
    lines, seen = [], []
    store = Store(tmp_path)
    again = run_tasks(tasks, executor, store, lambda share, text, _: lines.append((share, text)), seen.append)
    assert [result.value for result in again] == [9.0, None, 4.0]
    assert [result.stored for result in again] == [True, False, True]
    assert store.taken_over == 2
    assert lines == [
        (2 / 3, "2/3 taken over from an earlier attempt"),
        (1.0, "3/3 square of -1: ValueError: -1.0 is negative"),
    ]
    assert [result.task for result in seen] == [tasks[0], tasks[2], tasks[1]]


def test_an_answer_that_reports_a_breakdown_is_tried_again(tmp_path):
    reports = [Task(key, key, Answer, (why,), Answer) for key, why in (("a", ""), ("b", "no memory left"))]
    lines = []
    run_tasks(reports, None, Store(tmp_path), lambda share, text, _: lines.append(text))
    assert lines[1] == "2/2 b: no memory left"
    kept = Store(tmp_path)
    assert [kept.get(key, Answer) for key in "ab"] == [Answer(""), None]


def test_several_calls_share_one_progress():
    shares = []
    for before in (0, 1):
        run_tasks([task(2.0)], progress=lambda share, *_: shares.append(share), done_before=before, total=2)
    assert shares == [0.5, 1.0]


def test_a_process_that_dies_or_hangs_costs_its_own_task():
    tasks = [
        Task("", "spins", spin, (), time_limit=0.3),
        Task("", "sleeps", time.sleep, (600.0,), time_limit=0.1),
        Task("", "dies", os._exit, (7,)),
        Task("", "takes its time", time.sleep, (1.0,)),
        *(task(float(n)) for n in range(5)),
    ]
    with processes(2) as pool:
        results = run_tasks(tasks, pool)
    assert [result.ending for result in results[:4]] == ["hung", "hung", "died", "answered"]
    assert [result.failure for result in results[:3]] == [
        "no answer within 0.3 s; killed",
        "no answer within 0.1 s; killed",
        "the process ended with code 7",
    ]
    assert [result.value for result in results[4:]] == [0.0, 1.0, 4.0, 9.0, 16.0]


def test_what_cannot_be_unpickled_fails_with_its_task():
    with processes(1, isolated=True) as pool:
        broken, whole = run_tasks([Task("", "", square, (NotThere(),)), task(2.0)], pool)
    assert broken.failure == "ModuleNotFoundError: No module named 'nowhere'"
    assert whole.value == 4.0


def test_one_worker_means_this_process_unless_isolated():
    with processes(1) as none:
        assert none is None
    with processes(1, isolated=True) as pool:
        assert isinstance(pool, WorkerProcesses)
        (result,) = run_tasks([Task("", "", os.getpid)], pool)
    assert result.value != os.getpid()


def test_a_process_is_replaced_after_its_tasks():
    with processes(1, isolated=True, tasks_per_process=1) as pool:
        one_each = {pool.submit(os.getpid).result() for _ in range(2)}
    assert len(one_each) == 2


def broken(future: Future) -> None:
    future.set_exception(BrokenExecutor("all have ended"))


def test_processes_that_are_shut_down_answer_no_more():
    executor = WorkerProcesses(1)
    (result,) = run_tasks([Task("a", "a", abs, (-3,), time_limit=60.0)], executor)
    assert (result.value, result.failure) == (3, "")
    pending = executor.submit(time.sleep, 60.0)
    executor.shutdown(cancel_futures=True)
    with pytest.raises(CancelledError):
        pending.result()
    with pytest.raises(RuntimeError):
        executor.submit(abs, -3)


@pytest.mark.parametrize(("gone", "said"), [(Future.cancel, "given up"), (broken, "if __name__ == ")])
def test_an_executor_that_gives_up_ends_the_work_and_what_is_done_is_stored(tmp_path, gone, said):
    """As Dask's where its scheduler has gone: what it was given is no failed task, and no other is given."""

    class Executor:
        def submit(self, function, *arguments):
            future = Future()
            future.set_result(function(*arguments)) if not given else gone(future)
            given.append(future)
            return future

    given, store = [], Store(tmp_path)
    with pytest.raises(ConnectionError, match=said):
        run_tasks([task(3.0), task(2.0)], Executor(), store)
    assert store.get("3", float) == 9.0
    assert len(given) == 2
