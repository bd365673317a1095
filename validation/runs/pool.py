"""Independent tasks, each a function call: carried out here, in processes of this machine, by Dask, or by any
``concurrent.futures`` executor; one that breaks down costs no other.

What an earlier attempt has answered is taken over from a :class:`~validation.runs.store.Store`. However many
tasks there are, an executor holds a bounded number of them at a time. Short ones travel in batches that last
as long as its overhead asks for. Only :class:`WorkerProcesses` enforces time limits.
"""

from __future__ import annotations

import logging
import math
import multiprocessing
import os
import pickle
import signal
import threading
import time
import traceback
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import partial
from itertools import islice
from multiprocessing import resource_tracker
from multiprocessing.connection import wait
from queue import SimpleQueue
from typing import Any
from weakref import WeakSet

import pebble

from contact_scene.errors import SceneError, one_line
from validation import solvers
from validation.cases import Case
from validation.runs.process import deferred, interrupts_blocked, keep_freed, raise_swallowed
from validation.runs.progress import time_left
from validation.runs.provenance import fingerprint, version
from validation.runs.run import Run, run
from validation.runs.store import Store

OUTSTANDING = 512
"""Tasks that an executor holds at a time: more than the workers of a large cluster, so that none waits for
its next one, and few enough that neither their arguments nor their futures count in memory."""
PER_WORKER = 4
"""The same for each worker of our own: none is idle while a result travels and the next batch is made."""
GUARD = 'a script that has processes work for it stands under `if __name__ == "__main__":`'
"""Why all processes end as they begin: each imports the script, which starts its work anew."""
WALL_PER_PROCESSOR_SECOND = 10.0
"""Wall time after which a task is given up, over its limit of processor time: a task that sleeps uses none,
and on a machine with ten times as many busy processes as cores no other task reaches it."""
LOCAL_CLUSTER = "local"
"""In place of the address of a Dask scheduler: a cluster of this command's own, on this machine."""
BATCH_SECONDS = 0.25
"""Time of a batch of short tasks: more than a hundred times what a task costs the processes (measured by
``python -m benchmarks.sweep_price``); what a kill can lose of tasks that are done, for each worker."""
DASK_SECONDS = 1.0
"""The same by Dask, whose scheduler, client and worker spend 5 to 12 ms on a task: a hundredth, and a
twentieth in the shorter batches at the end."""
TAIL, SHORTEST = 2, 4
"""The tasks left are divided into so many batches for each place of an executor, so that all workers end
together, but into none shorter than that part of a full one."""
CONNECT_SECONDS = 20.0
"""Seconds to wait for a Dask scheduler: what a cluster on its way up may take; Dask's own limit is 30."""
TellProgress = Callable[[float, str, str], None]
"""Called with the share of the tasks that have ended, 0 to 1, a line of text, and the time left in words
(empty where too little is known)."""


class TaskEnding(StrEnum):
    """How a task ended."""

    ANSWERED = "answered"
    RAISED = "raised"
    DIED = "died"
    TIMED_OUT = "hung"


@dataclass(frozen=True)
class Task:
    """A function call that depends on no other task.

    ``key`` is the fingerprint of what is computed: two tasks with one key have one answer. ``answer`` is
    the kind by which a stored answer is read (see ``store``); ``None``: it is not stored. A value with an
    attribute ``breakdown`` that is not empty counts as a failure, and the next attempt tries again.
    ``time_limit`` is processor time (s) after which the task is given up.
    """

    key: str
    label: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = ()
    answer: Any = None
    time_limit: float | None = None


@dataclass(frozen=True)
class TaskResult:
    """What came of a task: its value, or why there is none (a line, a traceback), and its wall time (s)."""

    task: Task
    value: Any = None
    failure: str = ""
    details: str = ""
    seconds: float = 0.0
    stored: bool = False
    ending: TaskEnding = TaskEnding.ANSWERED


class ExecutorGone(ConnectionError):
    """An executor has given up tasks that it was given: it will carry out no other."""


class OtherVersion(RuntimeError):
    """A worker has other sources of this program than the process that asks it."""


@dataclass(frozen=True)
class Engine:
    """An executor (``None``: this process), the batches of tasks it holds at a time, and how long one lasts
    (s; 0: every task travels alone)."""

    executor: Executor | None = None
    outstanding: int = OUTSTANDING
    batch_seconds: float = 0.0

    def batch_size(self, seconds: float, done: int, left: int) -> int:
        """Tasks of the next batch, where ``done`` ones took so many seconds and others are left."""
        if done == 0:  # what a task takes is not known yet
            return 1
        by_cost = round(self.batch_seconds / max(seconds / done, 1e-6))
        tail = math.ceil(left / (TAIL * self.outstanding))
        return max(1, min(by_cost, max(tail, by_cost // SHORTEST)))


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
    """Carry out tasks, in this process without an executor, and return their results in their order.

    ``store`` holds answers of an earlier attempt and receives new ones, breakdowns excepted. ``on_result`` is
    called in this thread with each result as soon as it is there. Where one progress covers several calls,
    ``done_before`` tasks were done in earlier ones, of ``total``.
    """
    store, tasks, results = store or Store(), list(tasks), {}
    for index, task in enumerate(tasks):
        value = None if task.answer is None else store.get(task.key, task.answer)
        if value is not None:
            results[index] = TaskResult(task, value, stored=True)
            if on_result is not None:
                on_result(results[index])
    taken_over, began = len(results), time.monotonic()

    def tell(text: str) -> None:
        if progress is None:
            return
        ended, of_all = done_before + len(results), len(tasks) if total is None else total
        pace = (len(results) - taken_over) / ((len(tasks) - taken_over) or 1)
        left = time_left(pace, began) if total is None else ""
        progress(ended / of_all, f"{ended}/{of_all} {text}{', ' if left else ''}{left}", left)

    if results:
        tell("taken over from an earlier attempt")
    missing = [(index, task) for index, task in enumerate(tasks) if index not in results]
    for index, result in completed_tasks(missing, Engine(executor)):
        results[index] = result
        breakdown = result.failure or getattr(result.value, "breakdown", "")
        if not breakdown and result.task.answer is not None:
            store.put(result.task.key, result.value)
        if on_result is not None:
            on_result(result)
        tell(f"{result.task.label}: {breakdown or f'{result.seconds:.1f} s'}")
    return [results[index] for index in range(len(tasks))]


def completed_tasks(
    numbered: Iterable[tuple[int, Task]], engine: Engine = Engine(), total: int = 0
) -> Iterator[tuple[int, TaskResult]]:
    """Yield results as they come, each with the number of its task.

    A task is taken from ``numbered`` when there is room for it among the batches that the engine holds.
    ``total`` counts them, for batches that end together. Of a batch whose process has ended each task is
    tried again by itself. Raises :class:`ExecutorGone`, ``SceneError`` where a worker has another version.
    """
    if engine.executor is None:
        for number, task in numbered:
            raise_swallowed()
            yield number, TaskResult(task, *execute(task.function, task.arguments))
        return
    done: SimpleQueue[Future[Any]] = SimpleQueue()
    submitted: dict[Future[Any], Batch] = {}
    coming, again = iter(numbered), list[tuple[int, Task]]()
    seconds, ended, taken = 0.0, 0, 0
    try:
        while True:
            while len(submitted) < engine.outstanding:
                size = engine.batch_size(seconds, ended, total - taken)
                batch = [again.pop()] if again else list(islice(coming, size))
                if not batch:
                    break
                taken += len(batch)
                future = _submit(engine.executor, batch)
                submitted[future] = batch
                future.add_done_callback(done.put)
            if not submitted:
                return
            raise_swallowed()
            future = done.get()
            batch = submitted.pop(future)
            results = _collected(batch, future)
            if len(batch) > 1 and results[0].ending is TaskEnding.DIED:
                again += batch
                taken -= len(batch)
                continue
            seconds, ended = seconds + sum(one.seconds for one in results), ended + len(results)
            yield from ((number, one) for (number, _), one in zip(batch, results, strict=True))
    finally:
        for future in submitted:  # the reader of the results has gone
            future.cancel()


Batch = list[tuple[int, Task]]
Executed = tuple[Any, str, str, float, bool, TaskEnding]
"""The fields of a result after its task."""


def execute(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Executed:
    """Call the function where the task is carried out."""
    began = time.perf_counter()
    try:
        value, failure, details, ending = function(*arguments), "", "", TaskEnding.ANSWERED
    except Exception as error:
        value, failure, details, ending = None, one_line(error), traceback.format_exc(), TaskEnding.RAISED
    return value, failure, details, time.perf_counter() - began, False, ending


def execute_all(calls: Sequence[tuple[Any, tuple[Any, ...]]], sources: str = "") -> list[Executed]:
    """Carry out tasks one after the other, in a worker; ``sources``: ``version()`` where they were made.

    Raises :class:`OtherVersion` if this process has other sources than are stated: its answers would be kept
    under a wrong fingerprint.
    """
    if sources not in ("", version()):
        raise OtherVersion("a worker has another version of crosscontact, NumPy, SciPy or Python")
    return [execute(*call) for call in calls]


def _submit(executor: Executor, batch: Batch) -> Future[Any]:
    calls = [(task.function, task.arguments) for _, task in batch]
    if isinstance(executor, WorkerProcesses):  # of this installation
        return executor.schedule(batch[0][1].time_limit, execute_all, calls)
    return executor.submit(execute_all, calls, version())


def _collected(batch: Batch, future: Future[Any]) -> list[TaskResult]:
    """The results of tasks that an executor has done with; their process may have ended."""
    tasks = [task for _, task in batch]
    try:
        return [TaskResult(task, *found) for task, found in zip(tasks, future.result(), strict=True)]
    except CancelledError:
        raise ExecutorGone("the executor has given up what it was given") from None
    except BrokenExecutor as error:
        raise ExecutorGone(f"{one_line(error)}: {GUARD}") from None
    except OtherVersion as error:
        raise SceneError("executor", str(error), "the same installation on every worker") from None
    except Exception as error:
        exit_code, ending = getattr(error, "exitcode", None), TaskEnding.DIED
        if isinstance(error, TimeoutError) or exit_code == -getattr(signal, "SIGPROF", 0):
            failure, ending = f"no answer within {tasks[0].time_limit:g} s; killed", TaskEnding.TIMED_OUT
        else:
            failure = one_line(error) if exit_code is None else f"the process ended with code {exit_code}"
        return [TaskResult(task, failure=failure, ending=ending) for task in tasks]


def run_task(
    case: Case,
    solver: str,
    resolution: int | None = None,
    estimate: bool = False,
    max_steps: int | None = None,
    time_limit: float | None = None,
) -> Task:
    """A run of a solver as a task; arguments as of :func:`~validation.runs.run.run_or_raise`."""
    asked = (case.scene, solver, resolution, case.profile_times, estimate, max_steps)
    return Task(
        fingerprint("run", *asked, *origin_of(solver)),
        f"{case.name} {solver}",
        partial(run, estimate=estimate, max_steps=max_steps),
        (case, solver, resolution),
        Run,
        time_limit,
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


class WorkerProcesses(Executor):
    """Spawned processes that leave an interrupt to their parent and end with it, even if it is killed.

    A process that dies, or is killed because its task exceeds its time limit, costs this one task; one is
    replaced after ``tasks_per_process`` tasks (0: never).
    """

    def __init__(
        self,
        count: int,
        wall_per_processor_second: float = WALL_PER_PROCESSOR_SECOND,
        tasks_per_process: int = 0,
    ) -> None:
        if getattr(multiprocessing.current_process(), "_inheriting", False):
            os._exit(1)  # this process imports a script that has no guard: its parent says so (``GUARD``)
        self._wall_per_processor_second = wall_per_processor_second
        resource_tracker.ensure_running()  # begun where interrupts are blocked, it would unblock them again
        context = multiprocessing.get_context("spawn")
        self._pool = pebble.ProcessPool(count, tasks_per_process, initializer=_begin_worker, context=context)
        self._futures: WeakSet[Future[Any]] = WeakSet()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Future[Any]:
        return self.schedule(None, function, *arguments, **named)

    def schedule(
        self, seconds: float | None, function: Callable[..., Any], /, *arguments: Any, **named: Any
    ) -> Future[Any]:
        """Submit a call that is given up after some processor time (s), which a busy machine does not
        change."""
        # Bytes: what cannot be unpickled in a process then fails with its task, not with the process.
        call = pickle.dumps((function, arguments, named))
        timeout = None if seconds is None else self._wall_per_processor_second * seconds
        with interrupts_blocked():  # inherited by the threads begun here, and by every process they start
            future = self._pool.schedule(_carry_out, (call, seconds), timeout=timeout)
        self._futures.add(future)
        return future

    def __exit__(self, kind: type[BaseException] | None, *error: object) -> None:
        self.shutdown(cancel_futures=kind is not None)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Wait for the tasks, or kill the processes and cancel what is pending."""
        if not cancel_futures:
            self._pool.close()
            if not wait:
                return
        else:
            self._pool.stop()
            for future in list(self._futures):
                future.cancel()
        self._pool.join()


def _carry_out(call: bytes, seconds: float | None) -> Any:
    """Runs in a worker: the system ends the process when the processor time is used up (SIGPROF)."""
    limited = seconds is not None and hasattr(signal, "setitimer")
    if limited:
        signal.setitimer(signal.ITIMER_PROF, seconds or 0.0)
    try:
        function, arguments, named = pickle.loads(call)
        return function(*arguments, **named)
    finally:
        if limited:
            signal.setitimer(signal.ITIMER_PROF, 0.0)


def _begin_worker() -> None:
    """Set up a worker process: allocator, end with the parent."""
    keep_freed()
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_exit_after, args=(parent.sentinel,), daemon=True).start()


def _exit_after(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)


def processes(
    workers: int, isolated: bool = False, **how: Any
) -> AbstractContextManager[WorkerProcesses | None]:
    """As many processes; none for one worker, unless its tasks must be ``isolated`` from this process."""
    if workers <= 1 and not isolated:
        return nullcontext()
    return WorkerProcesses(max(workers, 1), **how)


def engine_of(executor: Executor) -> Engine:
    """A user's executor."""
    if not isinstance(executor, Executor):
        allowed = "an executor of concurrent.futures"
        raise SceneError("executor", f"got {type(executor).__name__}", allowed)
    return Engine(executor, OUTSTANDING, BATCH_SECONDS)


@contextmanager
def own_engine(jobs: int, address: str | None = None) -> Iterator[Engine]:
    """Processes of this machine, or workers of a Dask cluster: at an ``address`` or, ``LOCAL_CLUSTER``, of
    its own.

    Raises ``SceneError`` if Dask is not installed or the address does not answer, ``ConnectionError`` if
    the scheduler ends while tasks are out.
    """
    if address is None:
        with processes(jobs) as pool:
            yield Engine(pool, PER_WORKER * jobs, BATCH_SECONDS)
        return
    try:
        import distributed
    except ImportError:
        allowed = "Dask.distributed: pip install 'crosscontact[dask]'"
        raise SceneError("--dask", "distributed is not installed", allowed) from None
    # A lost worker is no error: its runs go on; a lost scheduler is told in one line.
    for logger in ("distributed", "distributed.client", "tornado.application"):
        logging.getLogger(logger).setLevel(logging.CRITICAL)
    with ExitStack() as opened:
        scheduler: object = address
        if address == LOCAL_CLUSTER:
            resource_tracker.ensure_running()  # begun later, it would unblock interrupts for the workers
            with deferred(), interrupts_blocked():  # Ctrl-C reaches all of a terminal: workers leave it to us
                cluster = distributed.LocalCluster(
                    n_workers=jobs,
                    threads_per_worker=1,
                    dashboard_address=":0",
                    silence_logs=logging.CRITICAL,
                )
                scheduler = opened.enter_context(cluster)
        try:
            client = opened.enter_context(distributed.Client(scheduler, timeout=CONNECT_SECONDS))
        except (OSError, ValueError) as error:
            problem = f"no scheduler answers at {address}: {error}"
            raise SceneError("--dask", problem, f"tcp://HOST:8786, or {LOCAL_CLUSTER}") from None
        executor = opened.enter_context(client.get_executor())
        least = 0 if address == LOCAL_CLUSTER else 64
        try:
            yield Engine(executor, max(PER_WORKER * len(client.nthreads()), least), DASK_SECONDS)
        except ExecutorGone:
            raise ConnectionError(f"the scheduler at {client.scheduler.address} is gone") from None
        except BaseException:
            executor.shutdown(wait=False)  # cancels
            raise
