"""Workers, schedulers and whole sweeps that end in the middle: nothing is lost, the same bytes as without."""

from __future__ import annotations

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

import pytest

from validation.runs.pool import BATCH_SECONDS, Engine
from validation.sweeps.dataset import to_dataset, write_results
from validation.sweeps.plan import read_plan
from validation.sweeps.run_plan import carry_out, store_of

ROOT = Path(__file__).parents[2]
PLAN = """
scene = "scene.toml"
resolution = 4
estimate = false
drawn = []
[[coordinates]]
key = "indenter.radius"
linspace = [1.0, 2.0, 6]
[[coordinates]]
name = "depth"
key = "loading.steps.0.to"
linspace = [0.011, 0.02, 20]
"""
RUNS = 6 * 20
"""Of the plan: so many that a signal comes before the last, on any machine."""
SCENE = """
[material]
modulus = 1.0
poisson = 0.5
[indenter]
shape = "sphere"
radius = 1.0
[loading]
start = "relaxed"
penetration = 0.01
[[loading.steps]]
kind = "ramp"
to = 0.02
rate = 0.01
"""


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plan")
    (folder / "scene.toml").write_text(SCENE)
    file = folder / "plan.toml"
    file.write_text(PLAN)
    return file


@pytest.fixture(scope="module")
def whole(plan, tmp_path_factory):
    """Folder and data set of the sweep that nothing interrupts, carried out in this process."""
    folder, task = tmp_path_factory.mktemp("whole"), read_plan(str(plan))
    with store_of(folder) as store:
        runs = carry_out(task, store)
        write_results(task, runs, folder)
        return folder, to_dataset(task, runs)


def command(plan, out, jobs=2):
    asked = ["--out", str(out), "--jobs", str(jobs)]
    return [sys.executable, "-m", "crosscontact", "sweep", str(plan), *asked]


def stored(file):
    with closing(sqlite3.connect(file)) as connection:
        return dict(connection.execute("SELECT fingerprint, seconds FROM answers").fetchall())


def wait_for_runs(out, process):
    log, deadline = out / "runs.sqlite-wal", time.monotonic() + 120.0
    while not (log.exists() and log.stat().st_size > 30_000):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.002)


@pytest.mark.slow
def test_a_dask_cluster_that_loses_a_worker_gives_the_same(plan, whole):
    distributed = pytest.importorskip("distributed", reason="the optional extra `dask` is not installed")
    task, killed = read_plan(str(plan)), []
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
        client.get_executor() as executor,
        store_of() as store,
    ):

        def kill_one(share, text):
            if share > 0.3 and not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        runs = carry_out(task, store, Engine(executor, 16, BATCH_SECONDS / 5.0), kill_one)
        there = to_dataset(task, runs)
    assert killed
    assert not runs.failed
    assert there.identical(whole[1])


@pytest.mark.slow
def test_a_scheduler_that_is_killed_ends_the_sweep_and_its_runs_are_kept(plan, tmp_path):
    pytest.importorskip("distributed", reason="the optional extra `dask` is not installed")
    out, file, begun = tmp_path / "out", tmp_path / "scheduler.json", []
    for role in (["scheduler", "--port", "0", "--dashboard-address", ":0"], ["worker", "--nthreads", "1"]):
        asked = [sys.executable, "-m", "dask", *role, "--scheduler-file", str(file)]
        begun.append(subprocess.Popen(asked, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        deadline = time.monotonic() + 60.0
        while not file.exists():
            assert time.monotonic() < deadline
            time.sleep(0.05)
    try:
        address = json.loads(file.read_text())["address"]
        asked = [*command(plan, out), "--dask", address]
        sweep = subprocess.Popen(asked, cwd=ROOT, stderr=subprocess.PIPE, text=True)
        wait_for_runs(out, sweep)
        begun[0].kill()
        _, said = sweep.communicate(timeout=60.0)
    finally:
        for process in begun:
            process.kill()
            process.wait()
    assert sweep.returncode == 1
    assert [line for line in said.splitlines() if not line.startswith("sweep ")] == [
        f"crosscontact: kept in {out}: the same command goes on",
        f"crosscontact: error: the scheduler at {address} is gone",
    ]
    assert 0 < len(stored(out / "runs.sqlite")) < RUNS


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "killpg"), reason="no process groups here")
def test_an_interrupted_dask_sweep_says_two_lines_and_goes_on(plan, whole, tmp_path):
    """Ctrl-C on a terminal reaches the workers, too."""
    pytest.importorskip("distributed", reason="the optional extra `dask` is not installed")
    out, (folder, _) = tmp_path / "out", whole
    asked = [*command(plan, out), "--dask", "local"]
    process = subprocess.Popen(asked, cwd=ROOT, stderr=subprocess.PIPE, text=True, start_new_session=True)
    wait_for_runs(out, process)
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate()
    assert process.returncode == 1
    told = [line for line in said.splitlines() if not line.startswith("sweep ")]  # without progress
    assert told == [
        f"crosscontact: kept in {out}: the same command goes on",
        "crosscontact: interrupted",
    ]
    before = stored(out / "runs.sqlite")
    assert 0 < len(before) < RUNS
    again = subprocess.run(asked, cwd=ROOT, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    assert stored(out / "runs.sqlite").items() >= before.items()
    assert (out / "sweep.nc").read_bytes() == (folder / "sweep.nc").read_bytes()


@pytest.mark.slow
def test_a_script_without_the_guard_is_told_of_it(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import crosscontact as cc\n"
        'values = {"loading.steps.0.rate": [0.1, 1.0]}\n'
        'cc.sweep("retraction-fast", values, resolution=4, estimate_errors=False, jobs=2)\n'
    )
    ended = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120)
    assert ended.returncode == 1
    assert ended.stderr.count("Traceback") == 1  # of this process alone
    assert 'under `if __name__ == "__main__":`' in ended.stderr.splitlines()[-1]
