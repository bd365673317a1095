"""Freed memory is kept: what a step frees, the next one takes, without asking the system for every page."""

from __future__ import annotations

import platform
import subprocess
import sys

import pytest

PROGRAM = """
import resource

import numpy as np

from validation.execution.memory import keep_freed

keep_freed()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(100):
    arrays = [np.ones(40_000) for _ in range(10)]
    del arrays
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""
AT_ONCE = 10 * 40_000 * 8 // 4096  # pages of all arrays of a round


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="tells the allocator of glibc what to do")
def test_arrays_made_again_and_again_cost_no_new_pages() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 10 * AT_ONCE
