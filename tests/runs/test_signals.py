"""Ctrl-C: what waits for it, whom it does not reach."""

from __future__ import annotations

import os
import signal
import threading

import pytest

from validation.runs.pool import LOCAL_CLUSTER, own_engine
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
