"""Settings of every test: floating-point errors raise, random examples are the same in every run.

Tests run in parallel, one process a core; in each the linear algebra takes one thread, unless the environment
names another number.
"""

from __future__ import annotations

import gc
import os
import signal

os.environ.update(  # read as NumPy loads
    {f"{name}_NUM_THREADS": os.environ.get(f"{name}_NUM_THREADS", "1") for name in ("OMP", "OPENBLAS", "MKL")}
)

import numpy as np
import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

settings.register_profile(
    "ci", derandomize=True, deadline=None, database=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("explore", parent=settings.get_profile("ci"), derandomize=False, max_examples=2000)
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # as in the background of a shell
    signal.signal(signal.SIGINT, signal.default_int_handler)
# Hypothesis mixes in the constants of whatever modules of the project are imported by then: the examples of a
# test would depend on the tests that ran before it.
providers.is_local_module_file = lambda path: False
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci"))
gc.disable()  # until the tests are collected: next to nothing of what imports make is ever garbage


def pytest_collection_finish():
    """What collection made stays until the end: the garbage collector need not visit it again and again.

    Together with rarer collections this saves an eighth of the processor time of the tests.
    """
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 50, 50)
    gc.enable()


@pytest.fixture(autouse=True)
def _floating_point_errors_raise():
    """Division by zero, overflow and invalid operations are errors; underflow to zero is not."""
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield
