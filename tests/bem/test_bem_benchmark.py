"""Seconds and memory of one cycle; numbers to look at, and the bounds that were asked for."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support.bem_runs import front
from support.paper_scenes import cycle

from bem_solver import Options, solve
from validation.measure.observables import observe
from validation.reference import tracking

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
@pytest.mark.parametrize("rate", [0.002, 0.02, 0.1])
def test_price_of_four_digits_and_of_six(rate, record_property):
    """Least processor time (s) of pull-off force and loop integral to 1e-4 (1e-6 by front tracking)."""
    exact = observe(front(cycle(rate), 40))
    for name, required, levels, run in (
        ("bem", 1e-4, (6, 8, 12, 16), lambda n: solve(cycle(rate), Options(n))),
        ("reference", 1e-6, (6, 8, 10, 12, 16), lambda n: tracking.solve(cycle(rate), tracking.Options(n))),
    ):
        for resolution in levels:
            seconds, error = [], 0.0
            for _ in range(3):
                began = time.process_time()
                trace = run(resolution)
                seconds.append(time.process_time() - began)
            ours = observe(trace)
            error = max(
                abs(ours.pull_off_force / exact.pull_off_force - 1.0),
                abs(ours.loop_energy / exact.loop_energy - 1.0),
            )
            evaluations = trace.counters.closure_evaluations
            print(f"V = {rate}, {name} at {resolution}: {min(seconds):.3f} s, {evaluations}, {error:.1e}")
            if error < required:
                break
        record_property(f"{name}, seconds", min(seconds))
        assert error < required


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
