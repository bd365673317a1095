"""Worker processes of these tests are forked from one that has loaded the packages."""

from __future__ import annotations

import multiprocessing

import pytest


@pytest.fixture(autouse=True)
def _forked_workers(monkeypatch):
    if "forkserver" in multiprocessing.get_all_start_methods():
        server = multiprocessing.get_context("forkserver")
        server.set_forkserver_preload(["validation.stability.matrix", "validation.measure.observables"])
        monkeypatch.setattr(multiprocessing, "get_context", lambda method=None: server)
