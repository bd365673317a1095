"""Worker processes for independent tasks, through the standard ``Executor`` interface.

A process that dies, or is killed because its task exceeds its time limit, costs this one task.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterator, MutableSequence
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from multiprocessing import resource_tracker
from multiprocessing.connection import wait
from typing import Any
from weakref import WeakSet

import pebble

from validation.execution.memory import keep_freed
from validation.execution.signals import interrupts_blocked
from validation.execution.told_shares import ToldShares, connect

WALL_PER_PROCESSOR_SECOND = 10.0
"""Wall time after which a task is given up, over its limit of processor time: a task that sleeps uses none,
and on a machine with ten times as many busy processes as cores no other task reaches it."""


class WorkerProcesses(Executor):
    """Spawned processes that leave an interrupt to their parent and end with it, even if it is killed.

    Attributes
    ----------
    shares : ToldShares
        Where tasks tell what share of them is done.
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
        # Started later, where interrupts are blocked, it would unblock them for the processes that follow.
        resource_tracker.ensure_running()
        context = multiprocessing.get_context("spawn")
        self.shares = ToldShares(context)
        self._pool = pebble.ProcessPool(
            count,
            tasks_per_process,
            initializer=_begin_worker,
            initargs=(self.shares.memory,),
            context=context,
        )
        self._futures: WeakSet[Future[Any]] = WeakSet()

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> Future[Any]:
        """As of any executor.

        Parameters
        ----------
        function : callable
            Picklable.
        *arguments, **named
            Of the call.

        Returns
        -------
        Future
        """
        return self._schedule(None, function, arguments, named)

    def submit_limited(self, seconds: float, function: Callable[..., Any], /, *arguments: Any) -> Future[Any]:
        """The same, given up after some processor time, which a busy machine does not change.

        Parameters
        ----------
        seconds : float
            Processor time (s).
        function : callable
            Picklable.
        *arguments
            Of the call.

        Returns
        -------
        Future
        """
        return self._schedule(seconds, function, arguments, {})

    def _schedule(
        self, seconds: float | None, function: Callable[..., Any], arguments: tuple[Any, ...], named: Any
    ) -> Future[Any]:
        # Bytes: what cannot be unpickled in a process then fails with its task, not with the process.
        call = pickle.dumps((function, arguments, named))
        timeout = None if seconds is None else self._wall_per_processor_second * seconds
        with interrupts_blocked():  # inherited by the threads begun here, and by every process they start
            future = self._pool.schedule(_carry_out, (call, seconds), timeout=timeout)
        self._futures.add(future)
        return future

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


@contextmanager
def processes(
    workers: int,
    isolated: bool = False,
    wall_per_processor_second: float = WALL_PER_PROCESSOR_SECOND,
    tasks_per_process: int = 0,
) -> Iterator[WorkerProcesses | None]:
    """As many processes; none for one worker, unless its tasks must be ``isolated`` from this process.

    Parameters
    ----------
    workers : int
        Processes at a time.
    isolated : bool
        Whether one worker is a process of its own as well.
    wall_per_processor_second : float
        Wall time after which a task is given up, over its limit of processor time.
    tasks_per_process : int
        Tasks after which a process is replaced by a fresh one; 0: never.

    Yields
    ------
    WorkerProcesses or None
    """
    if workers <= 1 and not isolated:
        yield None
        return
    pool = WorkerProcesses(max(workers, 1), wall_per_processor_second, tasks_per_process)
    try:
        yield pool
    except BaseException:
        pool.shutdown(cancel_futures=True)
        raise
    pool.shutdown()


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


def _begin_worker(shares: MutableSequence[float]) -> None:
    """Set up a worker process: allocator, where shares are told, end with the parent."""
    keep_freed()
    connect(shares)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_exit_after, args=(parent.sentinel,), daemon=True).start()


def _exit_after(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)
