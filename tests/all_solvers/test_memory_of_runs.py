"""What a finished run leaves in memory."""

from __future__ import annotations

import gc
import tracemalloc

import pytest

from validation import cases, solvers

LEAST = 2**21
"""Bytes that may wait for the garbage collection, which seldom looks at old objects."""


@pytest.mark.parametrize(
    "scene", ["elastic-relaxed", pytest.param("pdms-retraction-100nm", marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("solver", solvers.SOLVERS)
def test_a_finished_run_is_freed_without_the_garbage_collection(solver, scene):
    case, method = cases.load(scene), solvers.solver(solver)
    method.load()
    method.solve(case.scene, 4, max_steps=3)  # what is looked up once a process
    gc.collect()
    tracemalloc.start()
    gc.disable()
    try:
        method.solve(case.scene, 4, max_steps=30)
        left, _ = tracemalloc.get_traced_memory()
        gc.collect()
        waited = left - tracemalloc.get_traced_memory()[0]
    finally:
        gc.enable()
        tracemalloc.stop()
    assert waited < LEAST
