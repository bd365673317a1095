"""Job queues that are asked whether a job is done, as an executor of ``concurrent.futures``.

`submitit <https://github.com/facebookincubator/submitit>`_ has such jobs on SLURM: its ``submit`` gives an
object with ``done()`` and ``result()``, which nobody tells when the job ends.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import Any, Protocol

INTERVAL = 2.0
"""Seconds between two looks at all jobs: a queue answers no faster, and batches there take minutes."""


class QueuedJob(Protocol):
    """A job in a queue."""

    def done(self) -> bool:
        """Whether it has ended, in whatever way."""

    def result(self) -> Any:
        """What it gave; raises what it raised."""

    def cancel(self) -> Any:
        """Take it from the queue."""


class JobQueue(Protocol):
    """Takes jobs, such as ``submitit.AutoExecutor``."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> QueuedJob:
        """Put a call into the queue.

        Parameters
        ----------
        function : callable
            Picklable.
        *arguments, **named
            Of the call.

        Returns
        -------
        QueuedJob
        """


class PolledJobs(Executor):
    """The jobs of a queue as futures; a thread looks at them in turn.

    Parameters
    ----------
    queue : JobQueue
    interval : float
        Seconds between two looks.
    """

    def __init__(self, queue: JobQueue, interval: float = INTERVAL) -> None:
        self._queue, self._interval = queue, interval
        self._jobs: dict[Future[Any], QueuedJob] = {}
        self._lock = threading.Lock()
        self._closed = threading.Event()
        self._poll = threading.Thread(target=self._keep_looking, daemon=True)
        self._poll.start()

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
            Of what the job gives.
        """
        future: Future[Any] = Future()
        with self._lock:
            self._jobs[future] = self._queue.submit(function, *arguments, **named)
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Stop looking; jobs that have not ended are taken from the queue if that is asked for."""
        self._closed.set()
        if wait:
            self._poll.join()
        if cancel_futures:
            for job in self._jobs.values():
                job.cancel()

    def _keep_looking(self) -> None:
        while not self._closed.wait(self._interval):
            with self._lock:
                jobs = list(self._jobs.items())
            for future, job in jobs:
                if future.cancelled():
                    job.cancel()
                elif job.done():
                    _pass_on(job, future)
                else:
                    continue
                with self._lock:
                    del self._jobs[future]


def _pass_on(job: QueuedJob, future: Future[Any]) -> None:
    if not future.set_running_or_notify_cancel():
        return
    try:
        future.set_result(job.result())
    except Exception as error:
        future.set_exception(error)
