"""Worker processes of these tests are forked from one that has loaded the packages.

What is tested is what the matrix makes of how its runs end; that spawned processes, which load them each,
carry out tasks, die and are killed is tested with the tasks themselves.
"""

from __future__ import annotations

import multiprocessing

import pytest

LOADED = ["validation.stability.runner", "validation.solvers", "validation.measure.observables"]


@pytest.fixture(autouse=True)
def _forked_workers(monkeypatch):
    """``get_context("spawn")`` is the fork server; where the system has none, nothing changes."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return
    server = multiprocessing.get_context("forkserver")
    server.set_forkserver_preload(LOADED)
    monkeypatch.setattr(multiprocessing, "get_context", lambda method=None: server)
