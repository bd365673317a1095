"""Tasks: taken from the store, carried out here or in processes; one that breaks down costs no other."""

from __future__ import annotations

import itertools
import os
import time
from concurrent.futures import BrokenExecutor, Future, ThreadPoolExecutor
from dataclasses import dataclass

import pytest
from support.spring_solver import FunctionSolver, small_scene, spring
from support.worker_tasks import NotThere, silent, spin, square, wait_half_way

from validation.cases import load
from validation.execution import told_shares
from validation.execution.processes import WorkerProcesses, processes
from validation.execution.run_tasks import run_tasks
from validation.execution.solver_tasks import run_telling_share
from validation.execution.store import Store
from validation.execution.tasks import Task, TaskEnding
from validation.solvers import SOLVERS


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
    assert [file.name for file in (tmp_path / ".unfinished").glob("[!.]*")] == ["a"]


def test_several_calls_share_one_progress():
    shares = []
    for before in (0, 1):
        run_tasks([task(2.0)], progress=lambda share, *_: shares.append(share), done_before=before, total=2)
    assert shares == [0.5, 1.0]


def test_long_tasks_are_submitted_first_and_given_back_in_order():
    executor = ThreadPoolExecutor(1)
    counter = itertools.count()
    tasks = [Task("", "", lambda: next(counter), (), expected_seconds=s) for s in (1.0, 3.0, 2.0)]
    assert [result.value for result in run_tasks(tasks, executor)] == [2, 0, 1]
    assert [result.value for result in run_tasks(tasks)] == [3, 4, 5]  # here: in the given order


def test_a_process_that_dies_or_hangs_costs_its_own_task():
    tasks = [
        Task("", "spins", spin, (), time_limit=0.3, expected_seconds=9.0),
        Task("", "sleeps", time.sleep, (600.0,), time_limit=0.1, expected_seconds=9.0),
        Task("", "dies", os._exit, (7,), expected_seconds=8.0),
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


def test_a_running_task_tells_its_share_from_its_process(tmp_path, monkeypatch):
    monkeypatch.setattr("validation.execution.task_execution.SHARES_EVERY", 0.01)
    seen, told = tmp_path / "seen", []

    def progress(share, text, left):
        told.append((share, text))
        if share == 0.5:
            seen.touch()

    asked = Task("", "long", wait_half_way, (seen,), expected_seconds=9.0, tells_share=True)
    with processes(1, isolated=True) as pool:
        (result,) = run_tasks([asked], pool, progress=progress)
        free = len(pool.shares._free)
    assert result.value
    assert 0.5 in {share for share, text in told if not text}
    assert (told[-1][0], free) == (1.0, told_shares.SLOTS)


def test_more_tasks_than_places_for_shares_are_carried_out(monkeypatch):
    monkeypatch.setattr(told_shares, "SLOTS", 1)
    asked = [Task("", "", silent, (n,), tells_share=True) for n in range(3)]
    with processes(1, isolated=True) as pool:
        assert [result.value for result in run_tasks(asked, pool, progress=lambda *_: None)] == [0, 1, 2]


@pytest.mark.parametrize(
    ("solver", "estimate", "ends"),
    [("bem", False, [1.0]), ("bem", True, [2 / 3, 1.0]), ("reference", True, [2 / 3])],
)
def test_a_run_and_the_second_one_for_its_errors_tell_their_shares(
    tmp_path, monkeypatch, solver, estimate, ends
):
    """The second run of the reference, which estimates its errors itself, tells nothing."""
    answer, runs = spring(), []

    def run(scene, resolution, *, progress, **others):
        runs.append(shares := [])
        for step in range(1, 11):
            progress(0.1 * step)
            shares.append(told[-1])
        return answer(scene, resolution, progress=None, **others)

    monkeypatch.setitem(SOLVERS, solver, FunctionSolver(run, solver))
    told: list[float] = []
    result = run_telling_share(load(small_scene(tmp_path)), solver, None, estimate, tell_share=told.append)
    assert result.finished
    assert [shares[-1] for shares in runs] == pytest.approx(ends)
    assert told == sorted(told)


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
        run_tasks([task(3.0, expected_seconds=9.0), task(2.0)], Executor(), store)
    assert store.get("3", float) == 9.0
    assert len(given) == 2
