"""Freed memory is kept, and the most that a process held is its own, not that of its parent."""

from __future__ import annotations

import platform
import subprocess
import sys

import numpy as np
import pytest

from validation.runs.process import STATUS, peak_memory

PROGRAM = """
import resource

import numpy as np

from validation.runs.process import keep_freed

keep_freed()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
for _ in range(100):
    arrays = [np.ones(40_000) for _ in range(10)]
    del arrays
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""
OWN_PEAK = "from validation.runs.process import peak_memory; print(peak_memory())"
AT_ONCE = 10 * 40_000 * 8 // 4096  # pages of all arrays of a round


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="tells the allocator of glibc what to do")
def test_arrays_made_again_and_again_cost_no_new_pages() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 10 * AT_ONCE


@pytest.mark.skipif(not STATUS.exists(), reason="only Linux says what a process held")
def test_peak_memory_is_that_of_one_process() -> None:
    before = peak_memory()
    held = np.ones(25_000_000)
    assert before is not None
    assert peak_memory() > held.nbytes
    done = subprocess.run([sys.executable, "-c", OWN_PEAK], capture_output=True, text=True, check=True)
    assert 0 < int(done.stdout) < held.nbytes
