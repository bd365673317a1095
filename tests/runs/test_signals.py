"""Ctrl-C: what waits for it, whom it does not reach."""

from __future__ import annotations

import os
import signal
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from validation.runs.pool import LOCAL_CLUSTER, Engine, Task, completed_tasks, own_engine
from validation.runs.process import deferred, interrupting, interrupts_blocked

DASK = "the optional extra `dask` is not installed"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_deferred_signal_interrupts_after_its_block(number):
    def interrupted():
        with interrupting():
            with deferred():
                signal.raise_signal(number)
                reached.append("end of the block")
            reached.append("after it")

    reached = []
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert reached == ["end of the block"]


def test_a_deferred_signal_is_not_lost_by_an_error():
    def interrupted():
        with interrupting(), deferred():
            signal.raise_signal(signal.SIGINT)
            raise ValueError

    with pytest.raises(KeyboardInterrupt):
        interrupted()


class Interrupted:
    """Its destructor is running when the signal comes, as Dask's futures' may be: Python goes on after it."""

    def __del__(self):
        signal.raise_signal(signal.SIGINT)


@pytest.mark.parametrize("threads", [0, 1])
def test_a_signal_in_a_destructor_interrupts_before_the_next_task(threads, monkeypatch):
    """Without a word of Python's about the exception that it ignores there."""

    def interrupted():
        with ThreadPoolExecutor(1) as pool, interrupting():
            for number, _ in completed_tasks(tasks, Engine(pool if threads else None, 1)):
                ended.append(number)
                if number == 3:
                    Interrupted()

    tasks, ended, ignored = enumerate(Task(str(i), "", int) for i in range(9)), [], []
    monkeypatch.setattr(sys, "unraisablehook", ignored.append)
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert ended == [0, 1, 2, 3]
    assert not ignored


def test_without_a_signal_a_block_only_runs():
    before = signal.getsignal(signal.SIGINT)
    with interrupting(), deferred():
        pass
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="threads have no masks of signals here")
def test_threads_begun_where_interrupts_are_blocked_are_not_interrupted():
    def note():
        masks.append(signal.pthread_sigmask(signal.SIG_BLOCK, set()))

    masks = []
    with interrupts_blocked():
        first = threading.Thread(target=note)
        first.start()
    first.join()
    note()
    assert [signal.SIGINT in mask for mask in masks] == [True, False]


def test_interrupted_while_it_starts_a_cluster_is_closed(monkeypatch):
    distributed = pytest.importorskip("distributed", reason=DASK)
    done = []

    class Cluster:
        def __init__(self, **options):
            signal.raise_signal(signal.SIGINT)
            done.append("started")

        def __enter__(self):
            return self

        def __exit__(self, *error):
            done.append("closed")

    monkeypatch.setattr(distributed, "LocalCluster", Cluster)
    with pytest.raises(KeyboardInterrupt), interrupting(), own_engine(1, LOCAL_CLUSTER):
        done.append("used")
    assert done == ["started", "closed"]


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="threads have no masks of signals here")
def test_workers_of_an_own_cluster_leave_an_interrupt_to_their_parent(capfd):
    pytest.importorskip("distributed", reason=DASK)
    with own_engine(1, LOCAL_CLUSTER) as engine:
        worker = engine.executor.submit(os.getpid).result(60.0)
        os.kill(worker, signal.SIGINT)
        assert engine.executor.submit(os.getpid, pure=False).result(20.0) == worker
    assert capfd.readouterr().err == ""
