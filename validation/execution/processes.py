"""Processes for independent runs, through the standard ``Executor`` interface."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import wait
from typing import TYPE_CHECKING

from validation.execution.memory import keep_freed

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def processes(workers: int) -> Iterator[Executor | None]:
    """Processes that leave an interrupt to their parent, which then stops them; none for one worker.

    They end with their parent, even if it is killed.
    """
    if workers <= 1:
        yield None
        return
    pool = ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"), initializer=begin)
    with _interrupts_held_back():  # inherited by what is started here, for good
        for _ in range(workers):
            pool.submit(int)
    try:
        yield pool
    except BaseException:
        for process in list((pool._processes or {}).values()):
            process.terminate()
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def begin() -> None:
    """How a process that works for another begins."""
    keep_freed()
    _end_with_parent()


def _end_with_parent() -> None:
    """Leave at once when the parent is gone: nobody waits for an answer."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_leave_after, args=(parent.sentinel,), daemon=True).start()


def _leave_after(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)


@contextmanager
def _interrupts_held_back() -> Iterator[None]:
    if not hasattr(signal, "pthread_sigmask"):  # not a Unix
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
