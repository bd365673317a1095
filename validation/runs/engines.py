"""Where many runs are carried out: in this process, in processes of this machine, by Dask, by an executor."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker

from contact_scene.errors import SceneError
from validation.runs.pool import OUTSTANDING, ExecutorGone, processes
from validation.runs.process import deferred, interrupts_blocked

LOCAL_CLUSTER = "local"
"""In place of the address of a Dask scheduler: a cluster of this command's own, on this machine."""
PER_WORKER = 4
"""Batches that wait or run for each worker, so that none is idle while a result travels and the next batch is
made; a few, since batches are sized by the cost of the runs that are done."""
BATCH_SECONDS = 0.25
"""Processor time of a batch: more than a hundred times what a task costs the processes; what a kill can lose
of runs that are done, for each worker."""
DASK_SECONDS = 1.0
"""The same by Dask, whose scheduler, client and worker spend 5 to 12 ms on a task: a hundredth, and a
twentieth in the shorter batches at the end."""
CONNECT_SECONDS = 20.0
"""Seconds to wait for a Dask scheduler: what a cluster on its way up may take; Dask's own limit is 30."""
LOCAL_SETTINGS = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.tick.cycle": "5s",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.worker.memory.monitor-interval": "2s",
    "distributed.scheduler.active-memory-manager.start": False,
}
"""Dask's settings for a cluster of this command's own, which nobody watches and whose results are small. Its
profiler, clocks and monitors take 5 % of two cores by default, and less than 1 % with these."""


@dataclass(frozen=True)
class Engine:
    """An executor (``None``: this process), the batches it holds at a time, and how long one lasts (s)."""

    executor: Executor | None = None
    outstanding: int = 1
    batch_seconds: float = BATCH_SECONDS


@contextmanager
def own_engine(jobs: int, address: str | None = None) -> Iterator[Engine]:
    """Processes of this machine, or workers of a Dask cluster: at an ``address`` or, ``LOCAL_CLUSTER``, of
    its own.

    Raises ``SceneError`` if Dask is not installed or the address does not answer, ``ConnectionError`` if
    the scheduler ends while tasks are out.
    """
    if address is None:
        with processes(jobs) as pool:
            yield Engine(pool, 1 if pool is None else PER_WORKER * jobs)
        return
    try:
        import dask
        import distributed
    except ImportError:
        allowed = "Dask.distributed: pip install 'crosscontact[dask]'"
        raise SceneError("--dask", "distributed is not installed", allowed) from None
    for logger in ("distributed", "distributed.client"):  # a lost worker is no error: its runs go on
        logging.getLogger(logger).setLevel(logging.CRITICAL)
    with ExitStack() as opened:
        own = address == LOCAL_CLUSTER
        if own:
            opened.enter_context(dask.config.set(LOCAL_SETTINGS))
            resource_tracker.ensure_running()  # begun later, it would unblock interrupts for the workers
            with deferred(), interrupts_blocked():  # Ctrl-C reaches all of a terminal: workers leave it to us
                cluster = distributed.LocalCluster(
                    n_workers=jobs,
                    threads_per_worker=1,
                    dashboard_address=":0",
                    silence_logs=logging.CRITICAL,
                )
                scheduler: object = opened.enter_context(cluster)
        else:
            scheduler = address
        try:
            client = opened.enter_context(distributed.Client(scheduler, timeout=CONNECT_SECONDS))
        except (OSError, ValueError) as error:
            problem = f"no scheduler answers at {address}: {error}"
            raise SceneError("--dask", problem, f"tcp://HOST:8786, or {LOCAL_CLUSTER}") from None
        workers = len(client.nthreads())
        executor = opened.enter_context(client.get_executor())
        try:
            yield Engine(
                executor, PER_WORKER * workers if own else max(PER_WORKER * workers, 64), DASK_SECONDS
            )
        except ExecutorGone:
            raise ConnectionError(f"the scheduler at {client.scheduler.address} is gone") from None
        except BaseException:
            executor.shutdown(wait=False)  # cancels
            raise


def engine_of(executor: Executor) -> Engine:
    """A user's executor."""
    if not isinstance(executor, Executor):
        allowed = "an executor of concurrent.futures"
        raise SceneError("executor", f"got {type(executor).__name__}", allowed)
    return Engine(executor, OUTSTANDING)
