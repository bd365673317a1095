"""Seconds and memory of one cycle; numbers to look at, and the bounds that were asked for."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.paper_scenes import cycle

from bem_solver import solve

CODE = """
import resource, sys
sys.path.insert(0, "tests")
from support.paper_scenes import cycle
from bem_solver import solve
solve(cycle(0.02))
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""


def processor_time(rate):
    """Of one core; other processes on the machine count less than on the wall clock."""
    began = time.process_time()
    assert len(solve(cycle(rate))) > 100
    return time.process_time() - began


@pytest.mark.benchmark
@pytest.mark.parametrize("rate", [0.002, 0.02, 0.1])
def test_one_cycle_takes_a_second(rate, record_property):
    seconds = min(processor_time(rate) for _ in range(3))
    record_property("seconds", seconds)
    print(f"V = {rate}: {seconds:.3f} s")
    assert seconds <= 1.0


@pytest.mark.benchmark
def test_one_cycle_stays_below_400_megabytes():
    """Of a process that does nothing else, imports included."""
    pytest.importorskip("resource")
    root = Path(__file__).parents[2]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", CODE],
        cwd=root,
        env=environment,
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    megabytes = float(done.stdout)
    print(f"peak {megabytes:.0f} MB")
    assert 10.0 < megabytes <= 400.0
